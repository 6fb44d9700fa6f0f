"""Which candidates can be true together.

The strongest is accepted first and claims the points on it. The next ones must stand on what is
left, and may not lie inside what was accepted.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from perception.pose.axial import flip_contrast
from perception.pose.candidates import IN_WALL_M, Candidate
from perception.pose.gather import block_about, overshoot_m
from perception.pose.lsq import to_object
from perception.pose.model import PartModel
from perception.pose.surface import Surface
from perception.pose.verify import Shares, judge

__all__ = ["Accepted", "Refusal", "Scene"]

MIN_MATCH = 0.35
MAX_VIOLATION = 0.04
MIN_MARGIN = 0.02
CONTRAST_SHARE = 0.1
CLAIM_M = 0.0025
DEEP_M = 0.0025
DEEP_SHARE = 0.03


@dataclass(frozen=True, eq=False)
class Accepted:
    """A pose (4, 4) that stands, with its judgement and its lead over the other direction."""

    pose: NDArray[np.float64]
    shares: Shares
    flip_margin: float


@dataclass(frozen=True, eq=False)
class Refusal:
    """A pose (4, 4) that does not, and why."""

    pose: NDArray[np.float64]
    score: float
    reason: str


@dataclass(eq=False)
class Scene:
    """The surface, what of it is explained, and by which poses."""

    surface: Surface
    model: PartModel
    accepted: list[Accepted] = field(default_factory=list)
    refused: list[Refusal] = field(default_factory=list)
    is_open: NDArray[np.bool_] = field(init=False)
    least_margin: float = field(init=False)

    def __post_init__(self) -> None:
        # Ends that hardly differ cannot lead by much; the better direction is taken then.
        contrast = flip_contrast(self.model.part.profile)
        self.least_margin = min(MIN_MARGIN, CONTRAST_SHARE * contrast) if contrast else MIN_MARGIN
        self.is_open = self.surface.is_inside.copy()

    def accept(self, candidates: list[Candidate]) -> int:
        """Accept what is consistent among ``candidates``; return how many."""
        before = len(self.accepted)
        for candidate in sorted(candidates, key=lambda c: -c.shares.score * c.shares.rays):
            self._try(candidate)
        return len(self.accepted) - before

    def _try(self, best: Candidate) -> None:
        if best.shares.match < MIN_MATCH * 0.9:
            return self._refuse(best, f"too little of it is seen ({best.shares.match:.0%})")
        shares = judge(best.rendering, self.is_open)
        if shares.match < 0.6 * best.shares.match:
            return self._refuse(best, "its points belong to another part")
        if shares.match < MIN_MATCH:
            return self._refuse(best, f"too little of it is seen ({shares.match:.0%})")
        if shares.violation > MAX_VIOLATION:
            return self._refuse(best, f"the camera sees through it ({shares.violation:.0%})")
        if overshoot_m(self.surface, self.model, best.pose) > IN_WALL_M:
            return self._refuse(best, "it sticks in the bin's floor or wall")
        if any(self._interpenetrate(best.pose, other.pose) for other in self.accepted):
            return self._refuse(best, "it lies inside another part")
        margin = min(best.slip_margin, best.flip_margin)
        if margin < self.least_margin:
            return self._refuse(best, f"another pose explains as much (lead {margin:.3f})")
        self.accepted.append(Accepted(best.pose, shares, best.flip_margin))
        self.is_open &= ~self.claim(best.pose)
        return None

    def _refuse(self, candidate: Candidate, reason: str) -> None:
        self.refused.append(Refusal(candidate.pose, candidate.shares.score, reason))

    def claim(self, pose: NDArray[np.float64], within_m: float = CLAIM_M) -> NDArray[np.bool_]:
        """Return which pixels (H, W) show points on or in the part at ``pose``."""
        block = block_about(self.surface, self.model, pose, stride=1).slices
        mask = np.zeros(self.is_open.shape, bool)
        inside = self.surface.is_inside[block]
        points = self.surface.points_m[block][inside]
        local = to_object(points[None], pose[None].astype(np.float32))[0]
        near = np.zeros(inside.shape, bool)
        near[inside] = self.model.field.distance(local) < within_m
        mask[block] = near
        return mask

    def _interpenetrate(self, first: NDArray[np.float64], second: NDArray[np.float64]) -> bool:
        reach_m = 2 * np.hypot(self.model.field.radius_m, self.model.field.half_length_m)
        if np.sqrt(((first[:3, 3] - second[:3, 3]) ** 2).sum()) > reach_m:
            return False
        for a, b in ((first, second), (second, first)):
            points = np.einsum("ni,ji->nj", self.model.samples_m, a[:3, :3]) + a[:3, 3]
            local = to_object(points[None], b[None])[0]
            if (self.model.field.distance(local) < -DEEP_M).mean() > DEEP_SHARE:
                return True
        return False
