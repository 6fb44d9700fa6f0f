"""Grasp candidates as arrays: many tool poses at once, each with a score."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Self

import numpy as np
from numpy.typing import NDArray

__all__ = ["GraspCandidates", "GraspKind"]


class GraspKind(StrEnum):
    """How the fingers meet the part."""

    ACROSS = "across"
    END = "end"


@dataclass(frozen=True, eq=False)
class GraspCandidates:
    """N candidates for one or several parts.

    ``T_base_tcp`` (N, 4, 4): tool z along the approach, tool y along the closing direction.
    ``opening_m`` (N,) before closing, ``expected_m`` (N,) between the pads when holding.
    ``score`` (N,), higher is better. ``detection`` (N,) indexes the part. ``kind`` (N,).
    """

    T_base_tcp: NDArray[np.float64]
    opening_m: NDArray[np.float64]
    expected_m: NDArray[np.float64]
    score: NDArray[np.float64]
    detection: NDArray[np.int64]
    kind: NDArray[np.str_]

    def __len__(self) -> int:
        return len(self.score)

    @classmethod
    def empty(cls) -> Self:
        """No candidates."""
        none = np.zeros(0)
        return cls(np.zeros((0, 4, 4)), none, none, none, np.zeros(0, int), np.zeros(0, "<U8"))

    @classmethod
    def joined(cls, groups: list["GraspCandidates"]) -> Self:
        """All groups in one."""
        if not groups:
            return cls.empty()
        return cls(
            *(
                np.concatenate([getattr(group, name) for group in groups])
                for name in ("T_base_tcp", "opening_m", "expected_m", "score", "detection", "kind")
            )
        )

    def best_first(self) -> Self:
        """Sorted by score; equal scores keep their order."""
        order = np.argsort(-self.score, kind="stable")
        return type(self)(
            self.T_base_tcp[order],
            self.opening_m[order],
            self.expected_m[order],
            self.score[order],
            self.detection[order],
            self.kind[order],
        )
