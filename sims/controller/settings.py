"""What motion instructions before a move have set: all back to normal at PP to main."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from drivers.arms import ArmModel
from sims.motion import Leg, Pace

__all__ = ["MotionSettings", "Speed"]

Array = NDArray[np.float64]

MM = 1e-3


@dataclass(frozen=True)
class Speed:
    """What a move asks for; ``duration_s`` replaces the speeds where it is given."""

    tcp_mps: float
    turn_radps: float
    duration_s: float | None = None


@dataclass
class MotionSettings:
    r"""Shares are 1.0 for 100 %. ``wrist_interpolation`` is SingArea ``\Wrist``.

    ``T_object_shown`` is the program displacement: it takes programmed places to the work object.
    """

    checks_conf_linear: bool = True
    checks_conf_joint: bool = True
    wrist_interpolation: bool = False
    speed_share: float = 1.0
    most_mps: float = 5.0
    acceleration_share: float = 1.0
    ramp_share: float = 1.0
    path_mps2: float | None = None
    path_brake_mps2: float | None = None
    circle_mode: str = "pathframe"
    supervises: bool = True
    supervision_share: float = 1.0
    warns_of_corners: bool = True
    is_soft: bool = field(default=False)
    T_object_shown: Array = field(default_factory=lambda: np.eye(4))

    def pace(self, arm: ArmModel, speed: Speed, leg: Leg) -> Pace:
        """The limits of a move along ``leg``."""
        accelerations = np.array(arm.accelerations_radps2) * self.acceleration_share
        tcp_mps = min(speed.tcp_mps * self.speed_share, self.most_mps)
        turn_radps = speed.turn_radps * self.speed_share
        way_radps = np.inf
        if speed.duration_s is not None:
            duration_s = max(speed.duration_s, 1e-3)
            tcp_mps, turn_radps = np.inf, np.inf
            if leg.is_cartesian and leg.way_m > 1e-6:
                tcp_mps = leg.way_m / duration_s
            elif leg.is_cartesian:
                turn_radps = leg.turn_rad / duration_s
            else:
                way_radps = leg.length / duration_s
        usual = arm.path_acceleration_mps2 * self.acceleration_share
        return Pace(
            tcp_mps=tcp_mps,
            turn_radps=turn_radps,
            joint_radps=np.array(arm.limits.speed_radps),
            joint_radps2=accelerations,
            tcp_mps2=min(usual, self.path_mps2 or usual),
            tcp_brake_mps2=min(usual, self.path_brake_mps2 or usual),
            turn_radps2=arm.path_turn_acceleration_radps2 * self.acceleration_share,
            way_radps=way_radps,
        )
