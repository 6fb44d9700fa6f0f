"""MoveJ, MoveL, MoveC, MoveAbsJ: planned when reached, driven while the program goes on."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hal.errors import UnreachableError
from sims.controller.confdata import confdata_of, is_in
from sims.controller.frames import frame_of, from_robax
from sims.controller.instructions.common import (
    CONF_NUMBER,
    EDGE_NUMBER,
    Mechanics,
    Setup,
    instruction,
    joints_for,
    mechanics_of,
    not_supported,
    refusal,
    value_of,
)
from sims.controller.queue import Happening, Move
from sims.controller.settings import Speed
from sims.motion import Leg, Zone, circular_leg, joint_leg, linear_leg
from sims.rapid.builtin import Legal, TaskContext
from sims.rapid.errors import RapidError

__all__ = ["Planner", "absolute", "circular", "drive", "joint", "linear", "queued"]

Array = NDArray[np.float64]
Planner = Callable[[Mechanics, Array, Setup], Leg]

MM = 1e-3
LEAST_MPS = 1e-5
HOW = (
    "speeddata Speed \\num V | \\num T, zonedata Zone \\num Z \\stoppointdata Inpos, "
    "PERS tooldata Tool \\PERS wobjdata WObj"
)
MORE = "\\switch Corr \\PERS loaddata TLoad"


def linear(target: Sequence[Any]) -> Planner:
    """Straight to a robtarget."""

    def plan(mechanics: Mechanics, start: Array, setup: Setup) -> Leg:
        T_object_tcp = frame_of(target)
        try:
            leg = linear_leg(
                mechanics.unit.kinematics,
                start,
                setup.tcp_in_base(T_object_tcp),
                setup.T_flange_tcp,
                keeps_wrist=mechanics.settings.wrist_interpolation,
            )
        except UnreachableError as error:
            raise refusal(mechanics, setup.flange_in_base(T_object_tcp), error) from error
        _check_linear_conf(mechanics, leg, target[2])
        return leg

    return plan


def circular(via: Sequence[Any], target: Sequence[Any]) -> Planner:
    """On a circle through one robtarget to another."""

    def plan(mechanics: Mechanics, start: Array, setup: Setup) -> Leg:
        T_object_tcp = frame_of(target)
        settings = mechanics.settings
        try:
            leg = circular_leg(
                mechanics.unit.kinematics,
                start,
                setup.tcp_in_base(frame_of(via)),
                setup.tcp_in_base(T_object_tcp),
                setup.T_flange_tcp,
                keeps_wrist=settings.wrist_interpolation,
                turns_through_via=settings.circle_mode == "cirpointori",
            )
        except UnreachableError as error:
            raise refusal(mechanics, setup.flange_in_base(T_object_tcp), error) from error
        _check_linear_conf(mechanics, leg, target[2])
        return leg

    return plan


def joint(target: Sequence[Any]) -> Planner:
    """In joint space to a robtarget."""

    def plan(mechanics: Mechanics, start: Array, setup: Setup) -> Leg:
        T_base_flange = setup.flange_in_base(frame_of(target))
        goal = joints_for(
            mechanics,
            T_base_flange,
            target[2],
            start,
            is_free=not mechanics.settings.checks_conf_joint,
        )
        return joint_leg(mechanics.unit.kinematics, start, goal, setup.T_flange_tcp)

    return plan


def absolute(target: Sequence[Any]) -> Planner:
    """To a jointtarget."""

    def plan(mechanics: Mechanics, start: Array, setup: Setup) -> Leg:
        goal = from_robax(target[0])
        kinematics = mechanics.unit.kinematics
        outside = ~((goal >= kinematics.lower_rad - 1e-6) & (goal <= kinematics.upper_rad + 1e-6))
        if outside.any():
            axis = int(np.argmax(outside)) + 1
            raise RapidError(
                "ERR_ROBLIMIT",
                f"joint {axis}: {np.degrees(goal[axis - 1]):.2f} deg is out of range",
                number=EDGE_NUMBER,
            )
        goal = np.clip(goal, kinematics.lower_rad, kinematics.upper_rad)
        return joint_leg(kinematics, start, goal, setup.T_flange_tcp)

    return plan


def _check_linear_conf(mechanics: Mechanics, leg: Leg, conf: Sequence[float]) -> None:
    if not mechanics.settings.checks_conf_linear or is_in(leg.end_rad, conf):
        return
    reached = [round(c) for c in confdata_of(mechanics.unit.arm, leg.end_rad)]
    raise RapidError(
        "ERR_PATH_STOP",
        f"the line ends in the configuration {reached}, programmed is "
        f"[{', '.join(f'{c:g}' for c in conf)}]: teach it again, or use ConfL \\Off",
        number=CONF_NUMBER,
    )


def _speed(given: dict[str, Any]) -> Speed:
    v_tcp, v_ori, *_ = given["speed"]
    v_tcp = v_tcp if given.get("v") is None else given["v"]
    if not (v_tcp > 0 and v_ori > 0):
        raise RapidError("ERR_ARGVALERR", f"a speed of {v_tcp:g} mm/s, {v_ori:g} deg/s")
    duration_s = given.get("t")
    if duration_s is not None and not duration_s > 0:
        raise RapidError("ERR_ARGVALERR", f"a duration of {duration_s:g} s")
    return Speed(max(v_tcp * MM, LEAST_MPS), float(np.radians(v_ori)), duration_s)


def _zone(given: dict[str, Any]) -> Zone | None:
    if "zone" not in given:
        return None
    is_fine, pzone_tcp, _, _, zone_ori, *_ = given["zone"]
    if is_fine or given.get("inpos") is not None:
        return None
    distance = pzone_tcp if given.get("z") is None else given["z"]
    return Zone(max(0.0, distance) * MM, float(np.radians(max(0.0, zone_ori))))


async def drive(
    task: TaskContext,
    planner: Planner,
    given: dict[str, Any],
    happenings: Sequence[Happening] = (),
) -> None:
    """Plan and queue a move; wait until the program may go on. Raises as ``queued``."""
    unit = mechanics_of(task).unit
    move = await queued(task, planner, given, happenings)
    if move.zone is None and not given.get("conc"):
        await unit.ended(move)
    else:
        await unit.room()


async def queued(
    task: TaskContext,
    planner: Planner,
    given: dict[str, Any],
    happenings: Sequence[Happening] = (),
) -> Move:
    """Plan a move and queue it.

    Raises
    ------
    RapidError
        ERR_ROBLIMIT, ERR_OUTSIDE_REACH, ERR_PATH_STOP: nothing was queued; ERR_MOTIONSUP: the
        arm ran into something.
    """
    mechanics = mechanics_of(task)
    unit, settings = mechanics.unit, mechanics.settings
    setup = Setup.of(given["tool"].get(), value_of(given.get("wobj")))
    speed, zone = _speed(given), _zone(given)
    unit.check()
    while unit.is_dropping:
        await unit.standing()
    mechanics.active = setup
    mechanics.name("tooldata", given["tool"])
    mechanics.name("wobjdata", given.get("wobj"))
    leg = planner(mechanics, unit.planned_end_rad, mechanics.displaced(setup))
    move = Move(leg, settings.pace(unit.arm, speed, leg), zone, happenings)
    unit.ramp_share = settings.ramp_share
    return unit.add(move, setup.T_flange_tcp)


@instruction(
    f"PROC MoveL(\\switch Conc, robtarget ToPoint \\identno ID, {HOW} {MORE})", Legal.MOTION
)
async def move_l(task: TaskContext, **given: Any) -> None:
    """Straight."""
    await drive(task, linear(given["topoint"]), given)


@instruction(
    f"PROC MoveJ(\\switch Conc, robtarget ToPoint \\identno ID, {HOW} {MORE})", Legal.MOTION
)
async def move_j(task: TaskContext, **given: Any) -> None:
    """In joint space."""
    await drive(task, joint(given["topoint"]), given)


@instruction(
    f"PROC MoveC(\\switch Conc, robtarget CirPoint, robtarget ToPoint \\identno ID, {HOW} {MORE})",
    Legal.MOTION,
)
async def move_c(task: TaskContext, **given: Any) -> None:
    """On a circle."""
    await drive(task, circular(given["cirpoint"], given["topoint"]), given)


@instruction(
    "PROC MoveAbsJ(\\switch Conc, jointtarget ToJointPos \\identno ID \\switch NoEOffs, "
    f"{HOW} {MORE})",
    Legal.MOTION,
)
async def move_abs_j(task: TaskContext, **given: Any) -> None:
    """To axis positions."""
    await drive(task, absolute(given["tojointpos"]), given)


@instruction(
    "PROC MoveExtJ(\\switch Conc, jointtarget ToJointPos \\identno ID \\switch NotEOffs "
    "\\switch UseEOffs, speeddata Speed \\num T, zonedata Zone \\stoppointdata Inpos)",
    Legal.MOTION,
)
def move_ext_j(task: TaskContext, **_: Any) -> None:
    """Refused: there are no external axes."""
    del task
    raise not_supported("MoveExtJ: a unit of external axes")
