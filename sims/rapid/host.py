"""What a RAPID program finds around it: signals, network, pendant, event log, files.

``sims.controller`` implements these; ``sims.rapid`` only uses them.
"""

from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Any, Protocol

__all__ = [
    "EventKind",
    "EventLog",
    "Host",
    "Listener",
    "Network",
    "Pendant",
    "Signal",
    "SignalKind",
    "Stream",
]

Cancel = Callable[[], None]


class SignalKind(StrEnum):
    """As EIO.cfg names them."""

    DI = "DI"
    DO = "DO"
    AI = "AI"
    AO = "AO"
    GI = "GI"
    GO = "GO"


class Signal(Protocol):
    """One signal. Digital values are 0.0 and 1.0; groups are whole numbers."""

    name: str
    kind: SignalKind

    @property
    def value(self) -> float:
        """Now."""

    def set(self, value: float) -> None:
        """Write an output; ``RapidError`` (ERR_ARGVALERR, ERR_SIGSUPSEARCH...) when refused."""

    def watch(self, changed: Callable[[float], None]) -> Cancel:
        """Call back with the new value at every change, until cancelled."""


class Stream(Protocol):
    """A connected byte stream."""

    peer: str

    async def receive(self, most: int) -> bytes:
        """At least one byte, at most ``most``; ``b""`` at the end. Cancelling loses nothing."""

    async def send(self, data: bytes) -> None:
        """All of it. Raises ``ConnectionError``."""

    def pending(self) -> int:
        """How many received bytes wait."""

    def close(self) -> None:
        """Both ways; harmless when closed."""


class Listener(Protocol):
    """A bound and listening socket."""

    port: int

    async def accept(self) -> Stream:
        """The next client. Cancelling loses none."""

    def close(self) -> None:
        """Stop listening; streams live on."""


class Network(Protocol):
    """Real or in memory."""

    async def listen(self, address: str, port: int) -> Listener:
        """Raises ``OSError`` (EADDRINUSE, EADDRNOTAVAIL)."""

    async def connect(self, address: str, port: int) -> Stream:
        """Raises ``OSError``."""


class EventKind(StrEnum):
    """Severity in the event log."""

    STATE = "state"
    WARNING = "warning"
    ERROR = "error"


class EventLog(Protocol):
    """The controller's event log. ``domain`` is 1 operational .. 9 (RAPID programs write 8)."""

    def write(
        self,
        kind: EventKind,
        domain: int,
        number: int,
        title: str,
        cause: Sequence[str] = (),
    ) -> None:
        """Add an entry."""

    def watch(self, written: Callable[[Any], None]) -> Cancel:
        """Call back with every new entry (``kind domain number title cause``)."""


class Pendant(Protocol):
    """The teach pendant's operator window."""

    def write(self, text: str) -> None:
        """``TPWrite``."""

    def erase(self) -> None:
        """``TPErase``."""

    async def ask(self, question: str, keys: Sequence[str]) -> int:
        """Function keys: the number (from 1) of the one pressed."""

    async def ask_number(self, question: str) -> float:
        """``TPReadNum``."""


class Host(Protocol):
    """Everything together. ``signals`` is by lower-case name.

    ``info`` answers GetSysInfo by lower-case switch name (``serialno swversion robottype
    ctrlid lanip ctrllang systemname``). ``home`` is the folder behind ``HOME:`` and ``/``, None:
    no disk. ``epoch_s`` is the wall-clock time (POSIX seconds) at loop time 0, for CDate and
    CTime. ``task_names`` and ``is_executing`` are for TaskRunRob and its kin.
    """

    home: Path | None
    info: Mapping[str, str]
    epoch_s: float
    statement_ns: int

    @property
    def signals(self) -> Mapping[str, Signal]:
        """By lower-case name."""

    @property
    def log(self) -> EventLog:
        """The event log."""

    @property
    def pendant(self) -> Pendant:
        """The operator window."""

    @property
    def network(self) -> Network:
        """What sockets are made on."""

    @property
    def op_mode(self) -> str:
        """``OP_AUTO``, ``OP_MAN_PROG``, ``OP_MAN_TEST`` or ``OP_UNDEF``."""

    @property
    def run_mode(self) -> str:
        """``RUN_CONT_CYCLE`` or ``RUN_UNDEF``."""

    def cfg(self, path: str, attribute: str) -> str | float | bool:
        """ReadCfgData. Raises ``KeyError``."""
