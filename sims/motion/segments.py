"""One move as joint set-points on the tick grid."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from ruckig import InputParameter, Result, Ruckig, Trajectory
from scipy.interpolate import CubicSpline

from drivers.arms import ArmModel, Kinematics
from hal import (
    Arc,
    CircularTarget,
    JointTarget,
    LinearTarget,
    Tool,
    rotation_from_rotvec,
    rotvec_from_rotation,
)
from hal.errors import UnreachableError

__all__ = ["Segment", "circular_segment", "joint_segment", "linear_segment"]

Joints = NDArray[np.float64]

PATH_STEP_M = 0.002
PATH_STEP_RAD = 0.01
LARGEST_STEP_RAD = 0.35
STILL = 1e-12


@dataclass(frozen=True, eq=False)
class Segment:
    """Set-points one tick apart, shape (n, 6): the first is the start, the last the target.

    From row ``braking`` on the segment only slows down.
    """

    joints_rad: Joints
    braking: int


def _timed(
    distances: NDArray[np.float64],
    speeds: NDArray[np.float64],
    accelerations: NDArray[np.float64],
    jerks: NDArray[np.float64],
    tick_s: float,
) -> tuple[NDArray[np.float64], int]:
    """Time-optimal synchronised motion from rest to rest, sampled a tick apart."""
    size = len(distances)
    wanted = InputParameter(size)
    wanted.current_position = [0.0] * size
    wanted.target_position = distances.tolist()
    wanted.max_velocity = speeds.tolist()
    wanted.max_acceleration = accelerations.tolist()
    wanted.max_jerk = jerks.tolist()
    trajectory = Trajectory(size)
    result = Ruckig(size).calculate(wanted, trajectory)
    if result not in (Result.Working, Result.Finished):
        raise UnreachableError(f"no trajectory over {distances.tolist()}: {result}")
    ticks = max(1, int(np.ceil(trajectory.duration / tick_s - 1e-9)))
    rows = [trajectory.at_time(min(k * tick_s, trajectory.duration)) for k in range(ticks + 1)]
    positions = np.array([row[0] for row in rows])
    positions[-1] = distances
    velocity = np.abs(np.array([row[1] for row in rows])).max(axis=1)
    # The last row at which the fastest axis does not yet slow down.
    braking = int(len(velocity) - 1 - np.argmax(velocity[::-1] >= velocity.max() * (1 - 1e-6)))
    return positions, braking


def joint_segment(
    kinematics: Kinematics, start_rad: Joints, target: JointTarget, tick_s: float
) -> Segment:
    """Along the straight joint line, so that a line checked for collisions is the line driven.

    All joints begin and end together; the one that needs longest sets the time. Speeds are
    scaled by ``target.speed``, accelerations are not.
    """
    arm = kinematics.arm
    distances = np.array(target.joints_rad) - start_rad
    least = np.maximum(np.abs(distances), STILL)
    if np.abs(distances).max() < STILL:
        return Segment(np.array([start_rad, np.array(target.joints_rad)]), 0)
    accelerations = np.array(arm.accelerations_radps2) / least
    share, braking = _timed(
        np.ones(1),
        np.array([(np.array(arm.limits.speed_radps) * target.speed / least).min()]),
        np.array([accelerations.min()]),
        np.array([(accelerations / arm.jerk_time_s).min()]),
        tick_s,
    )
    joints = start_rad + share * distances
    joints[-1] = target.joints_rad
    return Segment(joints, braking)


def linear_segment(
    kinematics: Kinematics, start_rad: Joints, target: LinearTarget, tool: Tool, tick_s: float
) -> Segment:
    """The tool centre point runs straight and turns evenly, on the branch the arm is in.

    Where joints would be too fast the whole segment is slowed.

    Raises
    ------
    UnreachableError
        A point on the line is out of reach or beyond the joint ranges, or the branch ends.
    """
    T_start = kinematics.forward(start_rad) @ tool.T_flange_tcp.matrix
    goal_m = target.T_base_tcp.matrix[:3, 3]
    way_m = goal_m - T_start[:3, 3]
    length_m = float(np.linalg.norm(way_m))

    def place(share: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(T_start[:3, 3] + share[:, None] * way_m)

    return _cartesian(kinematics, start_rad, T_start, (place, length_m), target, tool, tick_s)


def circular_segment(
    kinematics: Kinematics, start_rad: Joints, target: CircularTarget, tool: Tool, tick_s: float
) -> Segment:
    """The tool centre point runs on an arc and turns evenly; otherwise as ``linear_segment``.

    Raises
    ------
    UnreachableError
        As ``linear_segment``, or no circle goes through the points.
    """
    T_start = kinematics.forward(start_rad) @ tool.T_flange_tcp.matrix
    try:
        arc = Arc.through(
            T_start[:3, 3], target.T_base_via.translation_m, target.T_base_tcp.translation_m
        )
    except ValueError as error:
        raise UnreachableError(str(error)) from error
    way = (arc.at, arc.length_m)
    return _cartesian(kinematics, start_rad, T_start, way, target, tool, tick_s)


def _cartesian(
    kinematics: Kinematics,
    start_rad: Joints,
    T_start: NDArray[np.float64],
    way: tuple[Callable[[NDArray[np.float64]], NDArray[np.float64]], float],
    target: LinearTarget | CircularTarget,
    tool: Tool,
    tick_s: float,
) -> Segment:
    place, length_m = way
    T_tcp_flange = tool.T_flange_tcp.inverse().matrix
    turn = rotvec_from_rotation(T_start[:3, :3].T @ target.T_base_tcp.matrix[:3, :3])
    angle_rad = float(np.linalg.norm(turn))
    if length_m < STILL and angle_rad < STILL:
        return Segment(np.array([start_rad, start_rad]), 0)
    steps = int(np.ceil(max(length_m / PATH_STEP_M, angle_rad / PATH_STEP_RAD, 4)))
    share = np.linspace(0.0, 1.0, steps + 1)
    poses = np.tile(np.eye(4), (steps + 1, 1, 1))
    poses[:, :3, 3] = place(share)
    poses[:, :3, :3] = [T_start[:3, :3] @ rotation_from_rotvec(turn * u) for u in share]
    line = _follow_branch(kinematics, poses @ T_tcp_flange, start_rad, share)
    return _time_line(kinematics.arm, line, share, (length_m, angle_rad), target.speed_mps, tick_s)


def _follow_branch(
    kinematics: Kinematics,
    T_base_flange: NDArray[np.float64],
    start_rad: Joints,
    share: NDArray[np.float64],
) -> Joints:
    solutions = kinematics.inverse_all(T_base_flange).joints_rad
    line = np.empty((len(share), 6))
    line[0] = start_rad
    for k in range(1, len(share)):
        choices = kinematics.wrapped(solutions[k], line[k - 1])
        steps = np.abs(choices - line[k - 1]).max(axis=1)
        if np.isnan(steps).all():
            raise UnreachableError(f"the line leaves the arm's reach at {share[k]:.0%} of its way")
        best = int(np.nanargmin(steps))
        if steps[best] > LARGEST_STEP_RAD:
            raise UnreachableError(
                f"the line would turn a joint by {steps[best]:.2f} rad at once at {share[k]:.0%} "
                "of its way: a singularity or the end of the branch"
            )
        line[k] = choices[best]
    return line


def _time_line(
    arm: ArmModel,
    line: Joints,
    share: NDArray[np.float64],
    way: tuple[float, float],
    speed_mps: float,
    tick_s: float,
) -> Segment:
    length_m, angle_rad = (max(part, STILL) for part in way)
    # Rates of the share of the way, 0 to 1, as the tool's limits have them.
    speed = min(speed_mps / length_m, arm.path_turn_speed_radps / angle_rad)
    acceleration = min(
        arm.path_acceleration_mps2 / length_m, arm.path_turn_acceleration_radps2 / angle_rad
    )
    smooth = CubicSpline(share, line)
    joints, braking = line, 0
    for _ in range(4):
        shares, braking = _timed(
            np.ones(1),
            np.array([speed]),
            np.array([acceleration]),
            np.array([acceleration / arm.jerk_time_s]),
            tick_s,
        )
        joints = np.asarray(smooth(shares[:, 0]))
        velocity = np.diff(joints, axis=0) / tick_s
        change = np.diff(velocity, axis=0) / tick_s
        too_fast = float((np.abs(velocity).max(axis=0) / arm.limits.speed_radps).max())
        too_hard = float((np.abs(change).max(axis=0) / arm.accelerations_radps2).max())
        slower = max(too_fast, np.sqrt(too_hard))
        if slower <= 1.0:
            break
        speed, acceleration = speed / slower / 1.02, acceleration / slower**2 / 1.04
    joints[0], joints[-1] = line[0], line[-1]
    return Segment(joints, braking)
