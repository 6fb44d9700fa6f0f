"""Interrupts of one task: which there are, what they wait for, and those that have happened."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sims.rapid.data import Reference
from sims.rapid.errors import RapidError
from sims.rapid.symbols import Routine

__all__ = ["Interrupt", "Interrupts"]

MAX_QUEUED = 100
MAX_CONNECTED = 70
CALLED = -1  # no interrupt has this number, nor does a variable that was not connected

Cancel = Callable[[], None]


@dataclass(slots=True)
class Interrupt:
    """A connected interrupt number. ``order`` ends what the interrupt waits for."""

    number: int
    trap: Routine
    order: Cancel | None = None
    is_asleep: bool = False
    is_single: bool = False
    data: Any = None


class Interrupts:
    """The interrupts of a task. ``happened`` is called when one may be served."""

    def __init__(self, happened: Callable[[], None], overflowed: Callable[[int], None]) -> None:
        self._happened = happened
        self._overflowed = overflowed
        self._known: dict[int, Interrupt] = {}
        self._queue: deque[tuple[int, Any]] = deque()
        self._last = 0
        self.is_disabled = False
        self.in_trap = False
        self.data: Any = None

    # Instructions.

    def connect(self, variable: Reference, trap: Routine) -> None:
        """``CONNECT variable WITH trap``. ERR_ALRDYCNT, ERR_INOMAX."""
        if int(variable.get()) in self._known:
            raise RapidError("ERR_ALRDYCNT", f"{variable.name} is connected: IDelete it first")
        if len(self._known) >= MAX_CONNECTED:
            raise RapidError("ERR_INOMAX", f"{MAX_CONNECTED} interrupts are connected already")
        self._last += 1
        self._known[self._last] = Interrupt(self._last, trap)
        variable.set(float(self._last))

    def order(self, number: float, begin: Callable[[], Cancel], *, is_single: bool = False) -> None:
        """Let an interrupt wait for something; ``begin`` watches it. ERR_UNKINO."""
        interrupt = self._find(number)
        if interrupt.order is not None:
            raise RapidError("ERR_ALRDYCNT", "the interrupt waits for something already")
        interrupt.is_single = is_single
        interrupt.order = begin()

    def delete(self, number: float) -> None:
        """``IDelete``; an unknown one is no matter."""
        interrupt = self._known.pop(int(number), None)
        if interrupt is not None and interrupt.order is not None:
            interrupt.order()
        self._queue = deque(entry for entry in self._queue if entry[0] != int(number))

    def sleep(self, number: float) -> None:
        """``ISleep``. ERR_UNKINO, ERR_INOISSAFE."""
        self._find(number).is_asleep = True

    def watch(self, number: float) -> None:
        """``IWatch``. ERR_UNKINO."""
        self._find(number).is_asleep = False

    def disable(self) -> None:
        """``IDisable``: what happens is queued."""
        self.is_disabled = True

    def enable(self) -> None:
        """``IEnable``."""
        self.is_disabled = False
        self._tell()

    def clear(self) -> None:
        """Forget everything, as a restart of the program does."""
        for interrupt in self._known.values():
            if interrupt.order is not None:
                interrupt.order()
        self._known.clear()
        self._queue.clear()
        self.is_disabled = self.in_trap = False

    # Happenings.

    def fire(self, number: int, data: Any = None) -> None:
        """An interrupt happens; ``data`` is what GetTrapData reads."""
        interrupt = self._known.get(number)
        if interrupt is None or interrupt.is_asleep:
            return
        if interrupt.is_single and interrupt.order is not None:
            interrupt.order()
            interrupt.order = None
        if len(self._queue) >= MAX_QUEUED:
            self._overflowed(number)
            return
        self._queue.append((number, data))
        self._tell()

    def call(self, routine: Routine) -> None:
        """Carry a procedure out as a trap, as soon as one may run; INTNO is 0 in it."""
        if len(self._queue) >= MAX_QUEUED:
            self._overflowed(CALLED)
            return
        self._queue.append((CALLED, routine))
        self._tell()

    def is_known(self, number: float) -> bool:
        """Whether the number is connected."""
        return int(number) in self._known

    @property
    def is_due(self) -> bool:
        """Whether a trap can run now."""
        return bool(self._queue) and not self.is_disabled and not self.in_trap

    def take(self) -> Interrupt:
        """Begin the trap of the oldest one."""
        number, self.data = self._queue.popleft()
        self.in_trap = True
        if number == CALLED:
            return Interrupt(0, self.data)
        return self._known[number]

    def end_trap(self) -> None:
        """A trap is left."""
        self.in_trap = False
        self._tell()

    def _tell(self) -> None:
        if self.is_due:
            self._happened()

    def _find(self, number: float) -> Interrupt:
        interrupt = self._known.get(int(number))
        if interrupt is None:
            raise RapidError("ERR_UNKINO", "the interrupt number is not connected: CONNECT it")
        return interrupt
