"""Legs joined to one way: cut where they are blended, with a corner between them.

In a corner the end of one leg fades out while the next one fades in: both run as joints, the
first ever slower towards the corner point, the second ever faster away from it. The way is
smooth to its second derivative and stays within the zone.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivers.arms import Kinematics
from sims.motion.leg import Leg, leg_through
from sims.motion.pace import Pace

__all__ = ["Piece", "corner_between"]

Array = NDArray[np.float64]

CORNER_KNOTS = 17
LEAST_CORNER_RAD = 1e-5


@dataclass(frozen=True, eq=False)
class Piece:
    """A stretch of a leg, from ``begin`` to ``end`` on it; ``at`` is where it begins on the way.

    ``pace`` holds on it; on a corner ``next_pace`` from the middle on. ``kept`` is for what follows
    from the rest.
    """

    leg: Leg
    at: float
    begin: float
    end: float
    pace: Pace
    next_pace: Pace | None = None
    kept: dict[float, Any] = field(default_factory=dict, repr=False)

    @property
    def length(self) -> float:
        """Of the stretch."""
        return self.end - self.begin

    @property
    def until(self) -> float:
        """Where it ends on the way."""
        return self.at + self.length

    def ended_at(self, end: float) -> "Piece":
        """Cut its end off."""
        return replace(self, end=end, kept={})


def corner_between(
    kinematics: Kinematics,
    tool: Array,
    before: tuple[Leg, float],
    after: tuple[Leg, float],
) -> Leg | None:
    """The corner from a length on one leg to a length on the next.

    None where the corner would leave the joint ranges, or is too small to be one.
    """
    first, entry = before
    second, leaving = after
    if first.length - entry < LEAST_CORNER_RAD or leaving < LEAST_CORNER_RAD:
        return None
    share = np.linspace(0.0, 1.0, CORNER_KNOTS)
    fading = 2 * share - 2 * share**3 + share**4
    rising = (1 - fading)[::-1]
    corner = first.end_rad
    joints = (
        first.joints_rad(entry + fading * (first.length - entry))
        + second.joints_rad(rising * leaving)
        - corner
    )
    if ((joints < kinematics.lower_rad) | (joints > kinematics.upper_rad)).any():
        return None
    return leg_through(
        kinematics, joints, tool, is_cartesian=first.is_cartesian and second.is_cartesian
    )
