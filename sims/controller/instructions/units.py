"""Which mechanical units there are: one robot, always active."""

from typing import Any

from sims.controller.instructions.common import instruction, mechanics_of
from sims.rapid.builtin import Legal, Ref, TaskContext, builtin
from sims.rapid.errors import RapidError

__all__: list[str] = []

UNITS = ("ROB_1",)


def _name_of(given: Any) -> str:
    value = given.get() if hasattr(given, "get") else given
    if value is None and hasattr(given, "name"):
        return str(given.name)
    return str(value)


def _check(given: Any) -> None:
    name = _name_of(given)
    if name.upper() not in UNITS:
        raise RapidError("ERR_ARGVALERR", f"there is no mechanical unit {name}")


@builtin("PROC ActUnit(VAR mecunit MechUnit)", Legal.MOTION)
def act_unit(task: TaskContext, *, mechunit: Ref) -> None:
    """The robot is active already."""
    del task
    _check(mechunit)


@builtin("PROC DeactUnit(VAR mecunit MechUnit)", Legal.MOTION)
def deact_unit(task: TaskContext, *, mechunit: Ref) -> None:
    """Refused: a robot cannot be deactivated."""
    del task
    _check(mechunit)
    raise RapidError("ERR_ARGVALERR", "the robot cannot be deactivated")


@builtin("FUNC bool IsMechUnitActive(VAR mecunit MechUnit)")
def is_mech_unit_active(task: TaskContext, *, mechunit: Ref) -> bool:
    """Whether a unit is active."""
    del task
    return _name_of(mechunit).upper() in UNITS


@builtin("FUNC string GetMecUnitName(VAR mecunit MechUnit)")
def get_mec_unit_name(task: TaskContext, *, mechunit: Ref) -> str:
    """The name of a unit."""
    del task
    return _name_of(mechunit)


@builtin("FUNC string RobName()")
def rob_name(task: TaskContext) -> str:
    """The robot of this task; the empty string in a task without motion."""
    return mechanics_of(task).unit.name if task.has_motion else ""


@builtin("FUNC num MotionPlannerNo()")
def motion_planner_no(task: TaskContext) -> float:
    """There is one motion planner."""
    del task
    return 1.0


@instruction(
    "FUNC bool GetNextMechUnit(INOUT num ListNumber, INOUT string UnitName \\INOUT num MecRef "
    "\\INOUT bool TCPRob \\INOUT num NoOfAxes \\INOUT num MecTaskNo \\INOUT num MotPlanNo "
    "\\INOUT bool Active \\INOUT bool DriveModule \\INOUT bool OKToDeact)"
)
def get_next_mech_unit(task: TaskContext, *, listnumber: Ref, unitname: Ref, **given: Any) -> bool:
    """Step through the units; the list number begins at 0 and comes back for the next call."""
    del task
    index = int(listnumber.get())
    if not 0 <= index < len(UNITS):
        return False
    unitname.set(UNITS[index])
    listnumber.set(float(index + 1))
    answers: dict[str, Any] = {
        "mecref": 0.0,
        "tcprob": True,
        "noofaxes": 6.0,
        "mectaskno": 1.0,
        "motplanno": 1.0,
        "active": True,
        "drivemodule": True,
        "oktodeact": False,
    }
    for key, answer in answers.items():
        if given.get(key) is not None:
            given[key].set(answer)
    return True
