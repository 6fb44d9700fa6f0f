"""Moves on whose way something happens: TriggL and its kin, MoveLDO and its kin."""

from collections.abc import Callable
from typing import Any

from sims.controller.instructions.common import instruction
from sims.controller.instructions.moves import (
    Planner,
    absolute,
    circular,
    drive,
    joint,
    linear,
)
from sims.controller.instructions.triggers import (
    Trigger,
    happening_of,
    output_at,
    signal_of,
    told,
)
from sims.controller.queue import Happening
from sims.rapid.ast import RoutineKind
from sims.rapid.builtin import Legal, TaskContext
from sims.rapid.errors import RapidError
from sims.rapid.symbols import Routine
from sims.rapid.task import task_of

__all__: list[str] = []

MOST_TRIGGERS = 8
MOST_OUTPUTS = 50
TO = "robtarget ToPoint"
VIA_TO = "robtarget CirPoint, robtarget ToPoint"
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


@instruction(
    f"PROC TriggAbsJ(\\switch Conc, jointtarget ToJointPos \\identno ID \\switch NoEOffs, {HOW})",
    Legal.MOTION,
)
async def trigg_abs_j(task: TaskContext, **given: Any) -> None:
    """To axis positions, with triggers."""
    await drive(task, absolute(given["tojointpos"]), given, _happenings(task, given))


OUTPUTS = (
    "speeddata Speed \\num T \\VAR triggios TriggData1{*} \\VAR triggstrgo TriggData2{*} "
    "\\VAR triggiosdnum TriggData3{*}, zonedata Zone \\stoppointdata Inpos, "
    "PERS tooldata Tool \\PERS wobjdata WObj \\switch Corr \\PERS loaddata TLoad"
)


def _outputs(task: TaskContext, given: dict[str, Any]) -> list[Happening]:
    """What the records that are ``used`` ask for. ERR_ARGVALERR."""
    kinds = (given.get(f"triggdata{k}") for k in (1, 2, 3))
    records = [record for kind in kinds if kind is not None for record in kind.get() if record[0]]
    if len(records) > MOST_OUTPUTS:
        raise RapidError("ERR_ARGVALERR", f"more than {MOST_OUTPUTS} outputs on one move")
    return [happening_of(output_at(task, record), task) for record in records]


@instruction(f"PROC TriggLIOs(\\switch Conc, {TO} \\identno ID, {OUTPUTS})", Legal.MOTION)
async def trigg_l_ios(task: TaskContext, **given: Any) -> None:
    """Straight, with outputs on the way that stand in arrays."""
    await drive(task, linear(given["topoint"]), given, _outputs(task, given))


@instruction(f"PROC TriggJIOs(\\switch Conc, {TO} \\identno ID, {OUTPUTS})", Legal.MOTION)
async def trigg_j_ios(task: TaskContext, **given: Any) -> None:
    """In joint space, with outputs on the way that stand in arrays."""
    await drive(task, joint(given["topoint"]), given, _outputs(task, given))


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
    _switched(f"MoveL{_end}", TO, _kind, lambda given: linear(given["topoint"]))
    _switched(f"MoveJ{_end}", TO, _kind, lambda given: joint(given["topoint"]))
    _switched(
        f"MoveC{_end}",
        VIA_TO,
        _kind,
        lambda given: circular(given["cirpoint"], given["topoint"]),
    )


def _synced(name: str, points: str, planner: Callable[[dict[str, Any]], Planner]) -> None:
    @instruction(f"PROC {name}({points} \\identno ID, {SYNCED})", Legal.MOTION)
    async def move(task: TaskContext, **given: Any) -> None:
        """Call a procedure, as a trap, where the corner is half round or the arm stands."""
        routine = _procedure(task, given["procname"])
        interrupts = task_of(task).machine.interrupts
        happening = Happening(lambda: interrupts.call(routine), is_at_corner=True)
        await drive(task, planner(given), given, [happening])


def _procedure(task: TaskContext, name: str) -> Routine:
    found = task_of(task).machine.frame.routine.module.find_routine(name.lower())
    if not isinstance(found, Routine) or found.decl.kind is not RoutineKind.PROC or found.params:
        raise RapidError("ERR_REFUNKPRC", f"there is no procedure {name} without parameters")
    return found


for _name, _points, _planner in (
    ("MoveLSync", TO, lambda given: linear(given["topoint"])),
    ("MoveJSync", TO, lambda given: joint(given["topoint"])),
    ("MoveCSync", VIA_TO, lambda given: circular(given["cirpoint"], given["topoint"])),
):
    _synced(_name, _points, _planner)
