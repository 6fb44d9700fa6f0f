"""What a look into the bin found."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal import Transform
from perception.pose.volume import Window

__all__ = ["Detection", "Finding", "Rejection"]


@dataclass(frozen=True, eq=False)
class Detection:
    """One part and where it lies.

    Parameters
    ----------
    T_camera_object
        Its pose in the rectified left camera.
    score
        Confidence for sorting, 0..1: the share of the camera-facing surface that was seen to be
        there, less three times what was seen not to be.
    match, violation, occluded
        Shares of the measured rays that would meet the part: on it, through it, stopped before.
    visible
        The share of the part's outline area, as the camera would see it alone, that is matched.
    covariance
        Shape (6, 6) of the twist (rotation rad, translation m) in frame ``object``, applied on
        the right: T_true = T exp(twist). Rows of unobservable directions are infinite on the
        diagonal and zero beside it.
    unobservable
        Their names, such as ``rotation z``: a shaft's roll.
    flip_margin
        By how much the score exceeds that of the best pose the other way round; infinite when
        there is none: the part looks the same from both ends, or would stick in the bin.
    points
        How many scene points the last fit used.
    """

    T_camera_object: Transform
    score: float
    match: float
    violation: float
    occluded: float
    visible: float
    covariance: NDArray[np.float64]
    unobservable: tuple[str, ...]
    flip_margin: float
    points: int


@dataclass(frozen=True, eq=False)
class Rejection:
    """A hypothesis that was not accepted, and why."""

    T_camera_object: Transform
    score: float
    reason: str


@dataclass(frozen=True, eq=False)
class Finding:
    """All that was found, best first.

    Parameters
    ----------
    labels
        Shape of the whole view, int32: k + 1 where detection k was matched, -1 where there is
        something above the floor that no detection explains, 0 elsewhere.
    window
        The block of the view that was searched.
    leftover_m2
        Area of what stays unexplained above the floor, as seen, thin seams left out. An empty
        bin has next to none; compare with ``part_area_m2``.
    part_area_m2
        The least area that a whole part shows.
    noise_m
        Robust standard deviation of the measured about the smoothed depth in the bin.
    """

    detections: tuple[Detection, ...]
    rejections: tuple[Rejection, ...]
    labels: NDArray[np.int32]
    window: Window
    leftover_m2: float
    part_area_m2: float
    noise_m: float

    @property
    def is_empty(self) -> bool:
        """Nothing found, and nothing left that could be a tenth of a part."""
        return not self.detections and self.leftover_m2 < 0.1 * self.part_area_m2
