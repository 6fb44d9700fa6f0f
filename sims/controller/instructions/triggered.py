"""Moves on whose way something happens: TriggL and its kin, MoveLDO and its kin."""

from collections.abc import Callable
from typing import Any

from sims.controller.instructions.common import instruction, not_supported
from sims.controller.instructions.moves import Planner, circular, drive, joint, linear
from sims.controller.instructions.triggers import Trigger, happening_of, signal_of, told
from sims.controller.queue import Happening
from sims.rapid.builtin import Legal, TaskContext
from sims.rapid.errors import RapidError

__all__: list[str] = []

MOST_TRIGGERS = 8
MORE = " ".join(f"\\VAR triggdata T{k}" for k in range(2, MOST_TRIGGERS + 1))
HOW = (
    f"speeddata Speed \\num T, VAR triggdata Trigg_1 {MORE}, zonedata Zone \\stoppointdata Inpos, "
    "PERS tooldata Tool \\PERS wobjdata WObj \\switch Corr \\PERS loaddata TLoad"
)
SWITCHED = (
    "speeddata Speed \\num T, zonedata Zone \\stoppointdata Inpos, PERS tooldata Tool "
    "\\PERS wobjdata WObj, {kind} Signal, num Value \\switch Corr \\PERS loaddata TLoad"
)
SYNCED = (
    "speeddata Speed \\num T, zonedata Zone \\stoppointdata Inpos, PERS tooldata Tool "
    "\\PERS wobjdata WObj, string ProcName \\switch Corr \\PERS loaddata TLoad"
)


def _happenings(task: TaskContext, given: dict[str, Any]) -> list[Happening]:
    found = []
    for key in ("trigg_1", *(f"t{k}" for k in range(2, MOST_TRIGGERS + 1))):
        if given.get(key) is None:
            continue
        trigger = given[key].get()
        if not isinstance(trigger, Trigger):
            raise RapidError(
                "ERR_ARGVALERR",
                f"{given[key].name} holds no trigger: use TriggIO or TriggInt first",
            )
        found.append(happening_of(trigger, task))
    return found


@instruction(f"PROC TriggL(\\switch Conc, robtarget ToPoint \\identno ID, {HOW})", Legal.MOTION)
async def trigg_l(task: TaskContext, **given: Any) -> None:
    """Straight, with triggers."""
    await drive(task, linear(given["topoint"]), given, _happenings(task, given))


@instruction(f"PROC TriggJ(\\switch Conc, robtarget ToPoint \\identno ID, {HOW})", Legal.MOTION)
async def trigg_j(task: TaskContext, **given: Any) -> None:
    """In joint space, with triggers."""
    await drive(task, joint(given["topoint"]), given, _happenings(task, given))


@instruction(
    f"PROC TriggC(\\switch Conc, robtarget CirPoint, robtarget ToPoint \\identno ID, {HOW})",
    Legal.MOTION,
)
async def trigg_c(task: TaskContext, **given: Any) -> None:
    """On a circle, with triggers."""
    planner = circular(given["cirpoint"], given["topoint"])
    await drive(task, planner, given, _happenings(task, given))


def _switched(
    name: str, points: str, kind: str, planner: Callable[[dict[str, Any]], Planner]
) -> None:
    how = SWITCHED.format(kind=kind)

    @instruction(f"PROC {name}({points} \\identno ID, {how})", Legal.MOTION)
    async def move(task: TaskContext, **given: Any) -> None:
        """Set an output where the corner is half round, or the arm stands."""
        signal, value = signal_of(given["signal"]), float(given["value"])
        happening = Happening(lambda: told(task, lambda: signal.set(value)), is_at_corner=True)
        await drive(task, planner(given), given, [happening])


for _end, _kind in (("DO", "signaldo"), ("GO", "signalgo"), ("AO", "signalao")):
    _switched(f"MoveL{_end}", "robtarget ToPoint", _kind, lambda given: linear(given["topoint"]))
    _switched(f"MoveJ{_end}", "robtarget ToPoint", _kind, lambda given: joint(given["topoint"]))
    _switched(
        f"MoveC{_end}",
        "robtarget CirPoint, robtarget ToPoint",
        _kind,
        lambda given: circular(given["cirpoint"], given["topoint"]),
    )


def _refused(name: str, points: str) -> None:
    @instruction(f"PROC {name}({points} \\identno ID, {SYNCED})", Legal.MOTION)
    def refuse(task: TaskContext, **_: Any) -> None:
        del task
        raise not_supported(f"{name}: a procedure at the corner")


for _name, _points in (
    ("MoveLSync", "robtarget ToPoint"),
    ("MoveJSync", "robtarget ToPoint"),
    ("MoveCSync", "robtarget CirPoint, robtarget ToPoint"),
):
    _refused(_name, _points)
