"""A look at the way before anything is sent: joints at each target, and where a line ends."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivers.arms import ArmModel, Kinematics
from hal import (
    Arc,
    CircularTarget,
    JointTarget,
    LinearTarget,
    Target,
    Transform,
    rotation_from_rotvec,
    rotvec_from_rotation,
)
from hal.errors import UnreachableError

__all__ = ["Reach", "confdata"]

STEP_M = 0.01
STEP_RAD = 0.05
LARGEST_STEP_RAD = 0.6
QUADRANT = np.pi / 2
EDGE_RAD = 1e-6

Joints = NDArray[np.float64]


@dataclass(frozen=True)
class Reach:
    """Follows targets on the branch the arm is in.

    The controller looks again, at the targets; it cannot afford to look at the whole way.
    """

    kinematics: Kinematics
    T_tcp_flange: Transform

    def follow(self, start_rad: Sequence[float], targets: Sequence[Target]) -> list[Joints]:
        """Return the joints at each target.

        Raises
        ------
        UnreachableError
            A point on the way is out of reach or beyond the joint ranges, or the branch ends.
        """
        at = np.array(start_rad, float)
        reached = []
        for number, target in enumerate(targets, 1):
            if isinstance(target, JointTarget):
                at = np.array(target.joints_rad)
            else:
                at = self._along(at, target, number)
            reached.append(at)
        return reached

    def _along(
        self, start_rad: Joints, target: LinearTarget | CircularTarget, number: int
    ) -> Joints:
        T_start = self.kinematics.forward(start_rad) @ self.T_tcp_flange.inverse().matrix
        poses = _way(T_start, target, number)
        solutions = self.kinematics.inverse_all(poses @ self.T_tcp_flange.matrix).joints_rad
        at = start_rad
        for k in range(1, len(poses)):
            choices = self.kinematics.wrapped(solutions[k], at)
            steps = np.abs(choices - at).max(axis=1)
            share = k / (len(poses) - 1)
            if np.isnan(steps).all():
                raise UnreachableError(
                    f"target {number}: the line leaves the arm's reach at {share:.0%} of its way"
                )
            best = int(np.nanargmin(steps))
            if steps[best] > LARGEST_STEP_RAD:
                raise UnreachableError(
                    f"target {number}: at {share:.0%} of the line a joint would have to turn by "
                    f"{steps[best]:.2f} rad at once: a singularity or the end of the branch"
                )
            at = choices[best]
        return at


def _way(
    T_start: NDArray[np.float64], target: LinearTarget | CircularTarget, number: int
) -> NDArray[np.float64]:
    T_goal = target.T_base_tcp.matrix
    if isinstance(target, LinearTarget):
        way_m = T_goal[:3, 3] - T_start[:3, 3]
        length_m = float(np.linalg.norm(way_m))
        return even(
            T_start, T_goal, lambda share: T_start[:3, 3] + share[:, None] * way_m, length_m
        )
    try:
        arc = Arc.through(T_start[:3, 3], target.T_base_via.translation_m, T_goal[:3, 3])
    except ValueError as error:
        raise UnreachableError(f"target {number}: {error}") from error
    return even(T_start, T_goal, arc.at, arc.length_m)


def even(
    T_start: NDArray[np.float64],
    T_goal: NDArray[np.float64],
    place: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    length_m: float,
) -> NDArray[np.float64]:
    """Poses from start to goal, shape (n, 4, 4), evenly moved along ``place`` and turned."""
    turn = rotvec_from_rotation(T_start[:3, :3].T @ T_goal[:3, :3])
    angle_rad = float(np.linalg.norm(turn))
    steps = max(1, math.ceil(length_m / STEP_M), math.ceil(angle_rad / STEP_RAD))
    share = np.linspace(0.0, 1.0, steps + 1)
    poses = np.tile(np.eye(4), (steps + 1, 1, 1))
    poses[:, :3, 3] = place(share)
    poses[:, :3, :3] = [T_start[:3, :3] @ rotation_from_rotvec(turn * u) for u in share]
    return poses


def confdata(arm: ArmModel, joints_rad: Joints) -> tuple[int, int, int, int]:
    """Return cf1, cf4, cf6, cfx as RAPID counts them.

    cfx: 4 for the wrist centre behind axis 1, 2 for behind the lower arm, 1 for axis 5 negative.
    """
    quadrants = np.floor((joints_rad[[0, 3, 5]] + EDGE_RAD) / QUADRANT).astype(int)
    cf1, cf4, cf6 = (int(q) for q in quadrants)
    opw = arm.opw
    lean = math.atan2(-opw.a2_m, opw.c3_m)
    elbow = float(joints_rad[2]) + math.pi / 2 - lean
    shoulder = float(joints_rad[1])
    forearm_m = math.hypot(opw.a2_m, opw.c3_m)
    out_m = opw.a1_m + opw.c2_m * math.sin(shoulder) + forearm_m * math.sin(shoulder + elbow)
    return cf1, cf4, cf6, 4 * (out_m < 0) + 2 * (math.sin(elbow) < 0) + bool(joints_rad[4] < 0)
