"""Scoring poses against truth: what counts as found, false, flipped, and how far off."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hal import Transform
from perception.parts import Part
from perception.pose import Detection

__all__ = ["Score", "score_poses"]

SUCCESS_RAD = np.radians(2.0)
SUCCESS_M = 0.002
VISIBLE = 0.5
FLIP_M = 0.015
FLIP_RAD = np.radians(5.0)


@dataclass
class Score:
    """Sums over scenes.

    ``wanted`` parts show at least half of their camera-facing surface, ``found`` of them have a
    detection within 2 degrees and 2 mm. ``false`` detections are near no part, ``flipped`` ones
    among them lie on a part the wrong way round. Errors are over successes on any part: radians
    and metres; ``deviations`` are errors over their stated sigmas, rows of five (rotation x, y;
    translation x, y, z).
    """

    wanted: int = 0
    found: int = 0
    detected: int = 0
    false: int = 0
    flipped: int = 0
    axis_rad: list[float] = field(default_factory=list)
    transverse_m: list[float] = field(default_factory=list)
    axial_m: list[float] = field(default_factory=list)
    deviations: list[NDArray[np.float64]] = field(default_factory=list)

    @property
    def position_m(self) -> list[float]:
        """Distances of the origins."""
        pairs = zip(self.transverse_m, self.axial_m, strict=True)
        return [float(np.hypot(across, along)) for across, along in pairs]


def score_poses(
    score: Score,
    part: Part,
    poses: Sequence[Transform],
    truth: Sequence[Transform],
    visible: Sequence[float],
    detections: Sequence[Detection] = (),
) -> None:
    """Add a scene's poses (frame ``camera``) to ``score``; ``detections`` give the sigmas."""
    found: set[int] = set()
    for k, pose in enumerate(poses):
        score.detected += 1
        errors = [_error(part, pose.matrix, true.matrix) for true in truth]
        best = min(range(len(errors)), key=lambda i: errors[i][1] + 0.02 * min(errors[i][0], 1.0))
        angle, off_m, turned, local_m = errors[best]
        if angle < SUCCESS_RAD and off_m < SUCCESS_M and best not in found:
            found.add(best)
            score.axis_rad.append(angle)
            score.transverse_m.append(float(np.hypot(local_m[0], local_m[1])))
            score.axial_m.append(float(local_m[2]))
            if detections:
                score.deviations.append(
                    _deviation(turned, truth[best].matrix, detections[k].covariance)
                )
        else:
            score.false += 1
            score.flipped += np.pi - angle < FLIP_RAD and off_m < FLIP_M
    wanted = {k for k, share in enumerate(visible) if share >= VISIBLE}
    score.wanted += len(wanted)
    score.found += len(wanted & found)


def _error(
    part: Part, pose: NDArray[np.float64], true: NDArray[np.float64]
) -> tuple[float, float, NDArray[np.float64], NDArray[np.float64]]:
    """Return axis angle, distance, the pose turned to match, and the shift in the true frame."""
    cosine = float((pose[:3, 2] * true[:3, 2]).sum())
    if part.is_reversible and cosine < 0:
        pose = pose.copy()
        pose[:3, 1:3] *= -1
        cosine = -cosine
    sine = float(np.linalg.norm(np.cross(pose[:3, 2], true[:3, 2])))
    local_m = np.einsum("ij,i->j", true[:3, :3], pose[:3, 3] - true[:3, 3])
    return float(np.arctan2(sine, cosine)), float(np.linalg.norm(local_m)), pose, local_m


def _deviation(
    pose: NDArray[np.float64], true: NDArray[np.float64], covariance: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the error in the frame of the estimate over the stated sigmas, shape (5,)."""
    axis = np.einsum("ij,i->j", pose[:3, :3], true[:3, 2])
    shift = np.einsum("ij,i->j", pose[:3, :3], true[:3, 3] - pose[:3, 3])
    error = np.array([-axis[1], axis[0], *shift])
    sigma = np.sqrt(np.diag(covariance))[[0, 1, 3, 4, 5]]
    return np.asarray(error / sigma)
