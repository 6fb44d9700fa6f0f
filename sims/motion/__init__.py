"""What a robot controller plans: joint and linear moves, blended, as set-points per tick."""

from sims.motion.program import Program, plan_program
from sims.motion.segments import Segment, joint_segment, linear_segment

__all__ = ["Program", "Segment", "joint_segment", "linear_segment", "plan_program"]
