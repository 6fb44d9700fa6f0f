"""Where the arm is, and what poses and joints mean to each other."""

from typing import Any

import numpy as np

from sims.controller.confdata import confdata_of
from sims.controller.frames import (
    extax_unused,
    frame_of,
    from_robax,
    pose_of,
    to_robax,
)
from sims.controller.instructions.common import (
    Setup,
    joints_for,
    mechanics_of,
    not_supported,
    value_of,
)
from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.errors import RapidError

__all__: list[str] = []


def _setup(task: TaskContext, tool: Ref | None, wobj: Ref | None) -> Setup:
    mechanics = mechanics_of(task)
    active = mechanics.active
    given = Setup.of(value_of(tool), value_of(wobj))
    chosen = Setup(
        active.T_flange_tcp if tool is None else given.T_flange_tcp,
        active.T_base_object if wobj is None else given.T_base_object,
    )
    return mechanics.displaced(chosen)


@builtin(
    "FUNC robtarget CRobT(\\VAR taskid TaskRef | \\string TaskName \\PERS tooldata Tool "
    "\\PERS wobjdata WObj)"
)
def c_rob_t(
    task: TaskContext,
    *,
    taskref: Ref | None = None,
    taskname: str | None = None,
    tool: Ref | None = None,
    wobj: Ref | None = None,
) -> list[Any]:
    """Where the tool is, by the resolvers."""
    del taskref, taskname
    unit = mechanics_of(task).unit
    joints = unit.measured_rad
    place = _setup(task, tool, wobj).tcp_in_object(unit.kinematics.forward(joints))
    return [*pose_of(place), confdata_of(unit.arm, joints), extax_unused()]


@builtin("FUNC pos CPos(\\PERS tooldata Tool \\PERS wobjdata WObj)")
def c_pos(task: TaskContext, *, tool: Ref | None = None, wobj: Ref | None = None) -> list[float]:
    """Where the tool centre point is."""
    unit = mechanics_of(task).unit
    place = _setup(task, tool, wobj).tcp_in_object(unit.kinematics.forward(unit.measured_rad))
    return pose_of(place)[0]


@builtin("FUNC jointtarget CJointT(\\VAR taskid TaskRef | \\string TaskName)")
def c_joint_t(
    task: TaskContext, *, taskref: Ref | None = None, taskname: str | None = None
) -> list[Any]:
    """Where the axes are, by the resolvers."""
    del taskref, taskname
    return [to_robax(mechanics_of(task).unit.measured_rad), extax_unused()]


@builtin(
    "FUNC robtarget CalcRobT(jointtarget Joint_target, PERS tooldata Tool \\PERS wobjdata WObj)"
)
def calc_rob_t(
    task: TaskContext, *, joint_target: list[Any], tool: Ref, wobj: Ref | None = None
) -> list[Any]:
    """Joints to a robtarget."""
    mechanics = mechanics_of(task)
    unit = mechanics.unit
    joints = from_robax(joint_target[0])
    if not np.isfinite(joints).all():
        raise RapidError("ERR_ARGVALERR", "the joints are not numbers")
    setup = mechanics.setup(tool.get(), value_of(wobj))
    place = setup.tcp_in_object(unit.kinematics.forward(joints))
    return [*pose_of(place), confdata_of(unit.arm, joints), extax_unused()]


@builtin(
    "FUNC jointtarget CalcJointT(\\switch UseCurWObjPos, robtarget Rob_target, "
    "PERS tooldata Tool \\PERS wobjdata WObj \\VAR errnum ErrorNumber)"
)
def calc_joint_t(
    task: TaskContext,
    *,
    rob_target: list[Any],
    tool: Ref,
    usecurwobjpos: bool = False,
    wobj: Ref | None = None,
    errornumber: Ref | None = None,
) -> list[Any]:
    r"""A robtarget to joints, with its configuration if ConfJ is on, else the nearest.

    With ``\ErrorNumber`` a failure is stored there instead of raised.
    """
    if usecurwobjpos:
        raise not_supported("CalcJointT \\UseCurWObjPos")
    mechanics = mechanics_of(task)
    near = mechanics.unit.planned_end_rad
    setup = mechanics.setup(tool.get(), value_of(wobj))
    T_base_flange = setup.flange_in_base(frame_of(rob_target))
    try:
        joints = joints_for(
            mechanics,
            T_base_flange,
            rob_target[2],
            near,
            is_free=not mechanics.settings.checks_conf_joint,
        )
    except RapidError as error:
        number = task.find(error.name) if errornumber is not None else None
        if errornumber is None or number is None:
            raise
        errornumber.set(number.get())
        joints = near
    return [to_robax(joints), extax_unused()]
