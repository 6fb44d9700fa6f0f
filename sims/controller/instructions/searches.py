"""SearchL and SearchC: drive, and note where a signal or a persistent bool changed."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from sims.controller.confdata import confdata_of
from sims.controller.frames import extax_unused, pose_of
from sims.controller.instructions.common import Setup, instruction, mechanics_of, value_of
from sims.controller.instructions.moves import Planner, circular, linear, queued
from sims.controller.queue import Happening
from sims.controller.unit import MechanicalUnit
from sims.rapid.builtin import Legal, Ref, TaskContext
from sims.rapid.data import Cell, Element, Pers
from sims.rapid.errors import RapidError
from sims.rapid.host import SignalKind

__all__: list[str] = []

Array = NDArray[np.float64]

STOPS = ("stop", "pstop", "sstop")
HOW = (
    "\\switch Stop | \\switch PStop | \\switch SStop | \\switch Sup, REF anytype Signal "
    "\\switch Flanks | \\switch PosFlank | \\switch NegFlank | \\switch HighLevel "
    "| \\switch LowLevel, INOUT robtarget SearchPoint"
)
REST = (
    "robtarget ToPoint \\identno ID, speeddata Speed \\num V | \\num T, "
    "PERS tooldata Tool \\PERS wobjdata WObj \\switch Corr \\PERS loaddata TLoad"
)


class _Search:
    """Watches from the beginning of a move; ``found_rad`` are the joints at the first hit.

    A hit with ``stops`` makes the arm brake and forget the rest of the move. ``refusal`` says
    that the signal was there before the search had begun.
    """

    def __init__(self, unit: MechanicalUnit, signal: Ref, given: dict[str, Any]) -> None:
        self._unit = unit
        self._signal = signal
        self._root = _root(signal)
        self._stops = any(given[name] for name in STOPS)
        self._wanted = next(
            (name for name in ("flanks", "negflank", "highlevel", "lowlevel") if given[name]),
            "posflank",
        )
        self._is_supervised = not any(
            given[name] for name in ("flanks", "posflank", "negflank", "highlevel", "lowlevel")
        )
        self._last = False
        self._cancel: Callable[[], None] | None = None
        self.found_rad: Array | None = None
        self.hits = 0
        self.refusal: RapidError | None = None

    def begin(self) -> None:
        """Watch from now on."""
        now = self._last = self._is_high()
        if now and self._is_supervised:
            is_pers = isinstance(self._root, Pers)
            error = "ERR_PERSSUPSEARCH" if is_pers else "ERR_SIGSUPSEARCH"
            self.refusal = RapidError(error, "it is high already where the search begins")
            self._unit.drop()
            return
        if (self._wanted == "highlevel" and now) or (self._wanted == "lowlevel" and not now):
            self._hit()
        self._cancel = self._watch()

    def end(self) -> None:
        """Watch no more."""
        if self._cancel is not None:
            self._cancel()
            self._cancel = None

    def _watch(self) -> Callable[[], None]:
        if isinstance(self._root, Pers):
            return self._root.watch(self._changed)
        return cast(Callable[[], None], self._signal.get().watch(lambda _: self._changed()))

    def _is_high(self) -> bool:
        value = self._signal.get()
        return bool(value.value if hasattr(value, "watch") else value)

    def _changed(self) -> None:
        now = self._is_high()
        if now == self._last:
            return
        self._last = now
        if self._wanted == "flanks" or now == (self._wanted in ("posflank", "highlevel")):
            self._hit()

    def _hit(self) -> None:
        self.hits += 1
        if self.found_rad is None:
            self.found_rad = np.array(self._unit.measured_rad)
            if self._stops:
                self.end()
                self._unit.drop()


async def _search(task: TaskContext, planner: Planner, given: dict[str, Any]) -> None:
    r"""Drive to the end, or to the hit.

    Raises
    ------
    RapidError
        ERR_WHLSEARCH: nothing was found, or with ``\Sup`` more than once; ERR_SIGSUPSEARCH,
        ERR_PERSSUPSEARCH: it was there from the beginning; those of a move.
    """
    mechanics = mechanics_of(task)
    unit = mechanics.unit
    signal: Ref = given["signal"]
    _check(signal)
    search = _Search(unit, signal, given)
    try:
        move = await queued(task, planner, given, [Happening(search.begin, is_from_start=True)])
        setup = mechanics.setup(given["tool"].get(), value_of(given.get("wobj")))
        await unit.ended(move)
        await unit.standing()
    finally:
        search.end()
    if search.refusal is not None:
        raise search.refusal
    if search.found_rad is None:
        raise RapidError("ERR_WHLSEARCH", f"{signal.name or 'the signal'} did not change")
    given["searchpoint"].set(_target(unit, setup, search.found_rad))
    if given["sup"] and search.hits > 1:
        raise RapidError("ERR_WHLSEARCH", f"{search.hits} hits on one search")


def _root(signal: Ref) -> Cell:
    return cast(Cell | Element, signal).root


def _check(signal: Ref) -> None:
    value = signal.get()
    if isinstance(value, bool) and isinstance(_root(signal), Pers):
        return
    if not hasattr(value, "kind") or value.kind != SignalKind.DI:
        raise RapidError(
            "ERR_ARGVALERR", "a search wants a digital input or a PERS bool", is_fatal=True
        )


def _target(unit: MechanicalUnit, setup: Setup, joints_rad: Array) -> list[Any]:
    place = setup.tcp_in_object(unit.kinematics.forward(joints_rad))
    return [*pose_of(place), confdata_of(unit.arm, joints_rad), extax_unused()]


@instruction(f"PROC SearchL({HOW}, {REST})", Legal.MOTION)
async def search_l(task: TaskContext, **given: Any) -> None:
    """Straight."""
    await _search(task, linear(given["topoint"]), given)


@instruction(f"PROC SearchC({HOW}, robtarget CirPoint, {REST})", Legal.MOTION)
async def search_c(task: TaskContext, **given: Any) -> None:
    """On a circle."""
    await _search(task, circular(given["cirpoint"], given["topoint"]), given)
