"""Motion supervision: the servo pulls harder than the motion explains."""

import numpy as np

from drivers.arms import ArmModel
from sims.world import World

__all__ = ["Supervision"]

PULL_SHARE = 0.25


class Supervision:
    """Compares each axis's servo pull with a share of its torque."""

    def __init__(self, world: World, arm: ArmModel) -> None:
        self._arm = world.arm
        gains = np.array([axis.position_gain for axis in arm.axes])
        torques = np.array([axis.torque_nm for axis in arm.axes])
        self._most_rad = PULL_SHARE * torques / gains

    def collided_axis(self, tune_share: float) -> int | None:
        """The axis (from 1) that is held back; None: all run freely."""
        lag = np.abs(self._arm.measured_rad - self._arm.target_rad) / self._most_rad
        worst = int(lag.argmax())
        return worst + 1 if lag[worst] > tune_share else None
