"""What became of each pick, and of the whole bin, as the cell itself saw it."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Self

from cell.planning.pick import PickPlan
from hal import GraspOutcome, Transform

__all__ = ["Attempt", "Ending", "Outcome"]


class Ending(StrEnum):
    """Why the cycle ended."""

    EMPTY = "bin is empty"
    NONE_GRASPABLE = "parts left, none graspable"
    TRAY_FULL = "tray is full"
    TOO_MANY_MISSES = "too many misses in a row"
    FAILED = "stopped by an error"


@dataclass(frozen=True)
class Attempt:
    """One pick. ``miss`` says what went wrong, empty if it was laid down."""

    number: int
    kind: str
    T_base_object: Transform
    T_base_target: Transform
    outcome: GraspOutcome
    expected_m: float
    size_m: float | None
    force_n: float | None
    tries: int
    is_laid_down: bool = False
    miss: str = ""

    @classmethod
    def begun(cls, plan: PickPlan, *, number: int) -> Self:
        """Return an attempt of which nothing is known yet."""
        return cls(
            number,
            plan.kind,
            plan.T_base_object,
            plan.T_base_target,
            GraspOutcome.NO_PART,
            plan.expected_m,
            None,
            None,
            plan.tries,
        )

    @property
    def is_held(self) -> bool:
        """Whether the gripper said it held the right part when the arm was over the tray."""
        return self.outcome is GraspOutcome.HELD and not self.miss

    def as_json(self) -> dict[str, Any]:
        """The record of the journal and of ``picks`` in the demo's JSON."""
        return {
            "number": self.number,
            "kind": self.kind,
            "seen_m": self.T_base_object.translation_m,
            "axis": self.T_base_object.rotation[:, 2],
            "outcome": str(self.outcome),
            "expected_m": self.expected_m,
            "size_m": self.size_m,
            "force_n": self.force_n,
            "tries": self.tries,
            "is_laid_down": self.is_laid_down,
            "miss": self.miss,
        }


@dataclass(frozen=True)
class Outcome:
    """The whole bin. ``left_reasons``: reason to number of parts still seen."""

    ending: Ending
    attempts: tuple[Attempt, ...]
    left_reasons: dict[str, int]
    failure: str = ""
