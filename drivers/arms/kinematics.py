"""Closed-form kinematics of an arm with a spherical wrist, many poses at a time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from py_opw_kinematics import KinematicModel
from py_opw_kinematics import Robot as OpwRobot
from scipy.spatial.transform import RigidTransform

from drivers.arms.model import ArmModel

__all__ = ["InverseSolutions", "Kinematics"]

TURN_RAD = 2 * np.pi


@dataclass(frozen=True, eq=False)
class InverseSolutions:
    """All eight branches for each of N flange poses, a branch always in the same slot.

    ``joints_rad`` has shape (N, 8, 6), NaN where the branch does not exist or no whole turn
    brings it inside the joint ranges. ``limit_margin_rad`` has shape (N, 8): distance of the
    joint nearest to an end of its range, NaN where there is no solution.
    """

    joints_rad: NDArray[np.float64]
    limit_margin_rad: NDArray[np.float64]


class Kinematics:
    """Forward and inverse kinematics between joints and the flange in frame ``base``."""

    def __init__(self, arm: ArmModel) -> None:
        opw = arm.opw
        self.arm = arm
        self.lower_rad = np.array(arm.limits.lower_rad)
        self.upper_rad = np.array(arm.limits.upper_rad)
        model = KinematicModel(
            a1=opw.a1_m,
            a2=opw.a2_m,
            b=opw.b_m,
            c1=opw.c1_m,
            c2=opw.c2_m,
            c3=opw.c3_m,
            c4=opw.c4_m,
            offsets=opw.offsets_rad,
            flip_axes=(False,) * 6,
        )
        self._robot = OpwRobot(model, degrees=False)

    def forward(self, joints_rad: ArrayLike) -> NDArray[np.float64]:
        """Return the flange pose ``T_base_flange``, (4, 4), or (N, 4, 4) for (N, 6) joints."""
        joints = np.asarray(joints_rad, float)
        if joints.ndim == 1:
            return np.asarray(self._robot.forward(tuple(joints)).as_matrix())
        if len(joints) == 0:
            return np.empty((0, 4, 4))
        return np.asarray(self._robot.batch_forward(joints).as_matrix())

    def inverse_all(self, T_base_flange: ArrayLike) -> InverseSolutions:
        """Return every joint solution for poses of shape (N, 4, 4); one (4, 4) is N = 1."""
        poses = np.asarray(T_base_flange, float).reshape(-1, 4, 4)
        if len(poses) == 0:
            return InverseSolutions(np.empty((0, 8, 6)), np.empty((0, 8)))
        found = self._robot.reach(RigidTransform.from_matrix(poses)).joints
        centre = (self.lower_rad + self.upper_rad) / 2
        joints = centre + (found - centre + np.pi) % TURN_RAD - np.pi
        margin = np.minimum(joints - self.lower_rad, self.upper_rad - joints).min(axis=-1)
        outside = ~(margin >= 0)
        joints[outside] = np.nan
        margin[outside] = np.nan
        return InverseSolutions(joints, margin)

    def wrapped(self, joints_rad: ArrayLike, reference_rad: ArrayLike) -> NDArray[np.float64]:
        """Move each joint by whole turns to its copy nearest to the reference, inside its range.

        Parameters
        ----------
        joints_rad
            Shape (..., 6); NaN stays NaN.
        reference_rad
            Shape (6,) or (..., 6).
        """
        joints = np.asarray(joints_rad, float)
        turns = np.round((np.asarray(reference_rad, float) - joints) / TURN_RAD)
        # The nearest copy may lie outside the range; then the next one inward is nearest.
        most = np.floor((self.upper_rad - joints) / TURN_RAD + 1e-12)
        least = np.ceil((self.lower_rad - joints) / TURN_RAD - 1e-12)
        return np.asarray(joints + TURN_RAD * np.clip(turns, least, most))

    def nearest(self, T_base_flange: ArrayLike, reference_rad: ArrayLike) -> NDArray[np.float64]:
        """Return the solution, shape (6,), whose largest joint step from the reference is least.

        All NaN if the pose is out of reach.
        """
        joints = self.wrapped(self.inverse_all(T_base_flange).joints_rad[0], reference_rad)
        step = np.abs(joints - np.asarray(reference_rad, float)).max(axis=-1)
        if np.isnan(step).all():
            return np.full(6, np.nan)
        return np.asarray(joints[int(np.nanargmin(step))])
