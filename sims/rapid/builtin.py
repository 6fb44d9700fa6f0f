"""Instructions and functions that the language brings along, and how one is added.

A built-in is a Python function under a declaration in RAPID's own words:

    @builtin("PROC SocketListen(VAR socketdev Socket)")
    async def socket_listen(task: TaskContext, *, socket: Ref) -> None: ...

Calling convention
    The task comes first, parameters follow as keywords: the RAPID name in lower case (with an
    underscore after it where Python needs one: ``str_``). ``IN`` parameters are values, the
    others (``VAR PERS INOUT REF``) are a ``Ref``. An absent optional is None, an absent switch
    False.
    ``async def`` may wait; plain ``def`` is faster. Errors are ``RapidError``.

Values
    num and dnum: float (the machine rounds num to binary32 when it stores); bool; string: str of
    at most 80 characters; records and arrays: nested lists in component order, copied by the
    machine where they are passed by value. ``clock socketdev rawbytes iodev ...`` hold a Python
    object in their variable. A signal argument is a ``host.Signal``. ``anytype`` takes all.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Protocol, TypeVar

from sims.rapid.host import Host

__all__ = [
    "BUILTINS",
    "OPAQUE",
    "Builtin",
    "Legal",
    "Ref",
    "TaskContext",
    "TaskKind",
    "builtin",
    "opaque",
]

F = TypeVar("F", bound=Callable[..., Any])


class TaskKind(StrEnum):
    """A task's type in SYS.cfg."""

    NORMAL = "NORMAL"
    STATIC = "STATIC"
    SEMISTATIC = "SEMISTATIC"


class Legal(StrEnum):
    """In which tasks an instruction may stand."""

    ANYWHERE = "anywhere"
    MOTION = "only in a motion task"
    NORMAL = "only in a NORMAL task"
    BACKGROUND = "only in a task without motion"
    TRAP = "only in a trap"
    HANDLER = "only in an error handler"


class Ref(Protocol):
    """A data object, or an element or component of one.

    ``type`` is the declared name in lower case, ``base`` the same with aliases resolved.
    """

    name: str
    type: str
    base: str
    rank: int

    def get(self) -> Any:
        """The value now; lists are the object's own, not copies."""

    def set(self, value: Any) -> None:
        """Store, checked and rounded as the type has it; a PERS tells those who watch."""


class TaskContext(Protocol):
    """What a built-in may ask of the task that runs it."""

    name: str
    kind: TaskKind
    has_motion: bool
    host: Host

    def find(self, name: str) -> Ref | None:
        """Look data up by name, as the task's program would."""

    def fire(self, intnum: int) -> None:
        """Let an interrupt happen; it is served between statements."""

    def fatal(self, number: int, message: str) -> None:
        """Stop the task with an entry in the event log."""


@dataclass(frozen=True)
class Builtin:
    """``declaration`` is RAPID; ``call`` the Python function."""

    declaration: str
    call: Callable[..., Any]
    legal: Legal


BUILTINS: list[Builtin] = []


def builtin(declaration: str, legal: Legal = Legal.ANYWHERE) -> Callable[[F], F]:
    """Add an instruction or a function; see the module."""

    def add(call: F) -> F:
        BUILTINS.append(Builtin(declaration, call, legal))
        return call

    return add


OPAQUE: dict[str, Callable[[], Any] | None] = {}


def opaque(type_name: str, make: Callable[[], Any] | None = None) -> None:
    """Add a type that RAPID cannot look into, such as ``clock``.

    A new variable of it holds what ``make`` returns, or None.
    """
    OPAQUE[type_name.lower()] = make
