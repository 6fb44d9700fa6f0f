"""How far a pose is from another, as a part's symmetry allows."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hal import Transform
from perception.parts import Part

__all__ = ["PoseError", "pose_error", "summary"]


@dataclass(frozen=True)
class PoseError:
    """Axis angle in radians; distances across and along the true axis in metres.

    ``is_flipped``: the axis points the wrong way, which counts as a miss and not as 180 deg.
    """

    axis_rad: float
    transverse_m: float
    axial_m: float
    is_flipped: bool

    @property
    def position_m(self) -> float:
        """Both together."""
        return float(np.hypot(self.transverse_m, self.axial_m))

    def as_json(self) -> dict[str, float | bool]:
        """Degrees and millimetres, as people read them."""
        return {
            "axis_deg": float(np.degrees(self.axis_rad)),
            "transverse_mm": self.transverse_m * 1e3,
            "axial_mm": self.axial_m * 1e3,
            "position_mm": self.position_m * 1e3,
            "is_flipped": self.is_flipped,
        }


def pose_error(estimate: Transform, truth: Transform, part: Part) -> PoseError:
    """Compare two poses of the part; a turn about its axis never counts."""
    true_axis, axis = truth.rotation[:, 2], estimate.rotation[:, 2]
    cosine = float(true_axis @ axis)
    sine = float(np.linalg.norm(np.cross(true_axis, axis)))
    offset = estimate.translation_m - truth.translation_m
    along = float(offset @ true_axis)
    return PoseError(
        axis_rad=float(np.arctan2(sine, abs(cosine))),
        transverse_m=float(np.linalg.norm(offset - along * true_axis)),
        axial_m=abs(along),
        is_flipped=cosine < 0 and not part.is_reversible,
    )


def summary(errors: Sequence[PoseError], *, misses: int) -> dict[str, Any]:
    """RMS and 95th percentile of the successes, misses counted beside."""
    result: dict[str, Any] = {"n": len(errors), "misses": misses}
    if not errors:
        return result
    rows = [error.as_json() for error in errors]
    for key in ("axis_deg", "transverse_mm", "axial_mm", "position_mm"):
        values = np.array([row[key] for row in rows], float)
        result[key] = {
            "rms": float(np.sqrt((values**2).mean())),
            "p95": float(np.percentile(values, 95)),
        }
    return result
