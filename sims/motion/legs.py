"""Legs planned: straight in joint space, straight and on circles in space."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from drivers.arms import Kinematics
from hal import rotvec_from_rotation
from hal.errors import UnreachableError
from sims.motion.leg import STILL_M, STILL_RAD, Leg, leg_through, standing_leg

__all__ = [
    "CircleError",
    "SingularityError",
    "circular_leg",
    "joint_leg",
    "linear_leg",
]

Array = NDArray[np.float64]

STEP_M = 0.005
STEP_RAD = 0.03
JOINT_STEP_RAD = 0.06
LEAST_STEPS = 6
MOST_STEPS = 4096
WAY_ERROR_M = 5e-6
LARGEST_STEP_RAD = 0.6
LEAST_ARC_M = 1e-4


class SingularityError(UnreachableError):
    """The way leads so near to a singularity that joints would have to jump."""


class CircleError(UnreachableError):
    """No circle goes through the three points."""


def joint_leg(kinematics: Kinematics, start_rad: Array, goal_rad: Array, tool: Array) -> Leg:
    """Straight in joint space. ``tool`` is ``T_flange_tcp``, (4, 4)."""
    start, goal = np.array(start_rad, float), np.array(goal_rad, float)
    steps = int(np.ceil(np.abs(goal - start).max() / JOINT_STEP_RAD))
    share = np.linspace(0.0, 1.0, max(LEAST_STEPS, min(steps, MOST_STEPS)) + 1)
    joints = start + share[:, None] * (goal - start)
    joints[-1] = goal
    return leg_through(kinematics, joints, tool, is_cartesian=False)


def linear_leg(
    kinematics: Kinematics, start_rad: Array, goal: Array, tool: Array, *, keeps_wrist: bool = False
) -> Leg:
    """The tool centre point runs straight to ``goal`` (``T_base_tcp``) and turns evenly.

    With ``keeps_wrist`` the wrist axes run straight instead of the tool turning evenly, and the
    arm passes through its wrist singularity.

    Raises
    ------
    UnreachableError
        A point of the line is out of reach or beyond the joint ranges.
    SingularityError
        The joints would jump.
    """
    T_start = kinematics.forward(start_rad) @ tool
    turn = rotvec_from_rotation(T_start[:3, :3].T @ goal[:3, :3])
    way_m = float(np.linalg.norm(goal[:3, 3] - T_start[:3, 3]))

    def pose(share: Array) -> Array:
        poses = np.tile(np.eye(4), (len(share), 1, 1))
        poses[:, :3, 3] = T_start[:3, 3] + share[:, None] * (goal[:3, 3] - T_start[:3, 3])
        poses[:, :3, :3] = T_start[:3, :3] @ _turned(turn, share)
        return poses

    angle_rad = float(np.linalg.norm(turn))
    if way_m < STILL_M and angle_rad < STILL_RAD:
        return standing_leg(kinematics, start_rad, tool)
    return _cartesian(kinematics, start_rad, pose, (way_m, angle_rad), tool, keeps_wrist)


def circular_leg(
    kinematics: Kinematics,
    start_rad: Array,
    via: Array,
    goal: Array,
    tool: Array,
    *,
    keeps_wrist: bool = False,
    turns_through_via: bool = False,
) -> Leg:
    """Along the circle through the start, ``via`` and ``goal``; turns evenly from end to end.

    With ``turns_through_via`` the tool has the orientation of ``via`` there, and turns evenly
    before and after it.

    Raises
    ------
    CircleError
        The points lie on a line or too near to each other.
    UnreachableError, SingularityError
        As ``linear_leg``.
    """
    T_start = kinematics.forward(start_rad) @ tool
    centre, across, up, angle = _circle(T_start[:3, 3], via[:3, 3], goal[:3, 3])
    at, turned = [0.0, 1.0], [T_start[:3, :3], goal[:3, :3]]
    if turns_through_via:
        to_via = via[:3, 3] - centre
        at.insert(1, float(np.arctan2(to_via @ up, to_via @ across)) % (2 * np.pi) / angle)
        turned.insert(1, via[:3, :3])
    turns = Slerp(at, Rotation.from_matrix(np.array(turned)))

    def pose(share: Array) -> Array:
        poses = np.tile(np.eye(4), (len(share), 1, 1))
        cos, sin = np.cos(angle * share)[:, None], np.sin(angle * share)[:, None]
        poses[:, :3, 3] = centre + cos * across + sin * up
        poses[:, :3, :3] = turns(share).as_matrix()
        return poses

    way_m = angle * float(np.linalg.norm(across))
    turn = sum(float(np.linalg.norm(rotvec_from_rotation(a.T @ b))) for a, b in pairwise(turned))
    size = (way_m, max(turn, angle))
    return _cartesian(kinematics, start_rad, pose, size, tool, keeps_wrist)


def _circle(start: Array, via: Array, goal: Array) -> tuple[Array, Array, Array, float]:
    """Centre, radius vector to the start, the one a quarter turn on, and the whole angle."""
    a, b = via - start, goal - start
    normal = np.cross(a, b)
    area = float(np.linalg.norm(normal))
    sides = [float(np.linalg.norm(v)) for v in (a, b, goal - via)]
    if min(sides) < LEAST_ARC_M:
        raise CircleError(f"two of the three points are only {min(sides) * 1e3:.3f} mm apart")
    if area < 1e-3 * max(sides) ** 2 * 0.1:
        raise CircleError("the three points lie on a line: the radius would be without bounds")
    towards = np.cross(normal, a) * (b @ b) + np.cross(b, normal) * (a @ a)
    centre = start + towards / (2 * area**2)
    across = start - centre
    axis = normal / area
    up = np.cross(axis, across)
    last = goal - centre
    angle = float(np.arctan2(last @ up, last @ across)) % (2 * np.pi)
    return centre, across, up, angle


def _cartesian(
    kinematics: Kinematics,
    start_rad: Array,
    pose: Callable[[Array], Array],
    size: tuple[float, float],
    tool: Array,
    keeps_wrist: bool,
) -> Leg:
    steps = int(np.ceil(max(size[0] / STEP_M, size[1] / STEP_RAD, LEAST_STEPS)))
    T_tcp_flange = np.linalg.inv(tool)
    while True:
        share = np.linspace(0.0, 1.0, min(steps, MOST_STEPS) + 1)
        follow = _through_wrist if keeps_wrist else _along_branch
        joints = follow(kinematics, pose(share) @ T_tcp_flange, np.array(start_rad, float), share)
        leg = leg_through(kinematics, joints, tool, is_cartesian=True)
        middle = (share[1:] + share[:-1]) / 2
        between = leg.joints_rad((leg.knots[1:] + leg.knots[:-1]) / 2)
        if len(leg.knots) != len(share) or keeps_wrist:
            return leg
        # How far the joints' spline leaves the way; not how far it has got along it.
        is_there = (kinematics.forward(between) @ tool)[:, :3, 3] - pose(middle)[:, :3, 3]
        along = np.diff(leg.tcp_m, axis=0)
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
        away = is_there - (is_there * along).sum(axis=1)[:, None] * along
        if np.linalg.norm(away, axis=1).max() < WAY_ERROR_M or steps >= MOST_STEPS:
            return leg
        steps *= 2


def _turned(turn: Array, share: Array) -> Array:
    return np.asarray(Rotation.from_rotvec(share[:, None] * turn).as_matrix())


def _along_branch(
    kinematics: Kinematics, T_base_flange: Array, start_rad: Array, share: Array
) -> Array:
    """Joints of the branch the arm is in, continuous from the start."""
    found = kinematics.inverse_all(T_base_flange).joints_rad
    first = kinematics.wrapped(found[0], start_rad)
    away = np.abs(first - start_rad).max(axis=1)
    if np.isnan(away).all():
        raise UnreachableError("the start of the way is outside the joint ranges")
    line = np.unwrap(found[:, int(np.nanargmin(away))], axis=0)
    line += np.round((start_rad - line[0]) / (2 * np.pi)) * (2 * np.pi)
    line[0] = start_rad
    _check(kinematics, line, share)
    return line


def _through_wrist(
    kinematics: Kinematics, T_base_flange: Array, start_rad: Array, share: Array
) -> Array:
    """Axes 4 to 6 straight; axes 1 to 3 keep the wrist centre's way as nearly as they can."""
    goal = kinematics.nearest(T_base_flange[-1], start_rad)
    if np.isnan(goal).any():
        raise UnreachableError("the end of the line is out of reach")
    found = kinematics.inverse_all(T_base_flange).joints_rad[:, :, :3]
    first = np.abs(found[0] - start_rad[:3]).max(axis=1)
    if np.isnan(first).all():
        raise UnreachableError("the start of the line is outside the joint ranges")
    line = np.empty((len(share), 6))
    for k in range(len(share)):
        away = np.abs(found[k] - (line[k - 1, :3] if k else start_rad[:3])).max(axis=1)
        if np.isnan(away).all():
            raise UnreachableError(f"the line leaves the arm's reach at {share[k]:.0%} of its way")
        line[k, :3] = found[k, int(np.nanargmin(away))]
    line[:, 3:] = start_rad[3:] + share[:, None] * (goal[3:] - start_rad[3:])
    line[0], line[-1] = start_rad, goal
    _check(kinematics, line, share)
    return line


def _check(kinematics: Kinematics, line: Array, share: Array) -> None:
    missing = np.flatnonzero(np.isnan(line).any(axis=1))
    sound = line[: missing[0]] if len(missing) else line
    jumps = np.abs(np.diff(sound, axis=0)).max(axis=1) if len(sound) > 1 else np.zeros(0)
    wild = np.flatnonzero(jumps > LARGEST_STEP_RAD)
    if len(wild):
        k = int(wild[0])
        joint = int(np.abs(line[k + 1] - line[k]).argmax()) + 1
        raise SingularityError(
            f"close to a singularity at {share[k + 1]:.0%} of the way: joint {joint} would turn "
            f"{np.degrees(jumps[k]):.0f} deg at once"
        )
    if len(missing):
        at = share[missing[0]]
        raise UnreachableError(f"the way leaves the arm's reach or joint ranges at {at:.0%}")
    beyond = (line < kinematics.lower_rad - 1e-9) | (line > kinematics.upper_rad + 1e-9)
    if beyond.any():
        k, joint = (int(v) for v in np.argwhere(beyond)[0])
        raise UnreachableError(
            f"joint {joint + 1} would leave its range at {share[k]:.0%} of the way "
            f"({np.degrees(line[k, joint]):.1f} deg)"
        )
