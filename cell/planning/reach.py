"""From tool poses to joints: all branches at once, the nearest one, a line on one branch."""

import numpy as np
from numpy.typing import NDArray

from drivers.arms import Kinematics

__all__ = ["Reach", "line_poses"]

MAX_STEP_RAD = 0.3
MAX_CHANGE_RAD = 2.8
LIMIT_MARGIN_RAD = 0.02


class Reach:
    """Inverse kinematics of the tool centre point."""

    def __init__(self, kinematics: Kinematics, T_flange_tcp: NDArray[np.float64]) -> None:
        self._kinematics = kinematics
        self._T_tcp_flange = np.linalg.inv(T_flange_tcp)

    def solutions(
        self, T_base_tcp: NDArray[np.float64], reference_rad: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """(N, 4, 4) to (N, 8, 6), whole turns chosen nearest to the reference."""
        found = self._kinematics.inverse_all(T_base_tcp @ self._T_tcp_flange)
        joints = self._kinematics.wrapped(found.joints_rad, reference_rad)
        joints[~(found.limit_margin_rad > LIMIT_MARGIN_RAD)] = np.nan
        return joints

    def nearest(
        self, T_base_tcp: NDArray[np.float64], reference_rad: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """(N, 4, 4) to (N, 6): the branch with the least change; NaN if none is near."""
        joints = self.solutions(T_base_tcp, reference_rad)
        change = np.abs(joints - reference_rad).max(axis=2)
        change = np.where(np.isnan(change), np.inf, change)
        best = change.argmin(axis=1)
        rows = np.arange(len(best))
        chosen = joints[rows, best]
        chosen[change[rows, best] > MAX_CHANGE_RAD] = np.nan
        return np.asarray(chosen)

    def follow(
        self, T_base_tcp: NDArray[np.float64], start_rad: NDArray[np.float64]
    ) -> NDArray[np.float64] | None:
        """(K, 4, 4) along a path to (K, 6) on the branch of ``start_rad``; ``None`` if it ends."""
        solutions = self.solutions(T_base_tcp, start_rad)
        path = np.empty((len(solutions), 6))
        here = start_rad
        for k, branches in enumerate(solutions):
            step = np.abs(branches - here).max(axis=1)
            step = np.where(np.isnan(step), np.inf, step)
            best = int(step.argmin())
            if step[best] > MAX_STEP_RAD:
                return None
            here = path[k] = branches[best]
        return path


def line_poses(
    T_start: NDArray[np.float64], direction: NDArray[np.float64], length_m: float, step_m: float
) -> NDArray[np.float64]:
    """Poses shifted along ``direction`` from ``T_start``: (K, 4, 4), the first is the start."""
    count = max(3, int(np.ceil(length_m / step_m)) + 1)
    poses = np.repeat(T_start[None], count, axis=0)
    poses[:, :3, 3] += direction * np.linspace(0, length_m, count)[:, None]
    return poses
