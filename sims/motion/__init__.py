"""What a robot controller plans: moves, blended, as set-points per tick.

``Program`` is planned before it begins; a ``Way`` grows while a ``WayPlayer`` plays it.
"""

from sims.motion.corners import Piece
from sims.motion.leg import Leg, standing_leg
from sims.motion.legs import (
    CircleError,
    SingularityError,
    circular_leg,
    joint_leg,
    linear_leg,
)
from sims.motion.pace import Pace, Zone
from sims.motion.player import WayPlayer
from sims.motion.program import Program, plan_program
from sims.motion.segments import Segment, joint_segment, linear_segment
from sims.motion.way import Way

__all__ = [
    "CircleError",
    "Leg",
    "Pace",
    "Piece",
    "Program",
    "Segment",
    "SingularityError",
    "Way",
    "WayPlayer",
    "Zone",
    "circular_leg",
    "joint_leg",
    "joint_segment",
    "linear_leg",
    "linear_segment",
    "plan_program",
    "standing_leg",
]
