"""How fast a move may go, and how its corner is cut."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Pace", "Zone"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Zone:
    """How far from a target the next move may begin: the tool's way, or its turn in place."""

    distance_m: float = 0.0
    angle_rad: float = 0.0


@dataclass(frozen=True, eq=False)
class Pace:
    """The limits of a move: of the tool, of the joints, and of the way itself (``way_radps``).

    Accelerations of the tool hold on lines and circles only.
    """

    tcp_mps: float
    turn_radps: float
    joint_radps: Array
    joint_radps2: Array
    tcp_mps2: float
    tcp_brake_mps2: float
    turn_radps2: float
    way_radps: float = np.inf
