"""From part poses to tool poses."""

from cell.grasp.candidates import GraspCandidates, GraspKind
from cell.grasp.shaft import is_graspable, shaft_candidates

__all__ = ["GraspCandidates", "GraspKind", "is_graspable", "shaft_candidates"]
