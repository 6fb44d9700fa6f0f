"""What is known of a stereo rig: two pinhole cameras, their relation, and where they hang."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal.transform import Transform

__all__ = ["CameraIntrinsics", "Region", "StereoCalibration"]


@dataclass(frozen=True)
class Region:
    """A part of the sensor, in GenICam SFNC terms (OffsetX, OffsetY, Width, Height), pixels."""

    offset_x_px: int
    offset_y_px: int
    width_px: int
    height_px: int

    def __post_init__(self) -> None:
        if min(self.offset_x_px, self.offset_y_px) < 0 or min(self.width_px, self.height_px) < 1:
            raise ValueError(f"not a region: {self}")

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns of the region in a full-sensor image."""
        return (
            slice(self.offset_y_px, self.offset_y_px + self.height_px),
            slice(self.offset_x_px, self.offset_x_px + self.width_px),
        )

    def is_inside(self, width_px: int, height_px: int) -> bool:
        """Whether the region lies on a sensor of this size."""
        return (
            self.offset_x_px + self.width_px <= width_px
            and self.offset_y_px + self.height_px <= height_px
        )


@dataclass(frozen=True)
class CameraIntrinsics:
    """A pinhole camera with Brown's distortion, for full-sensor pixel coordinates.

    ``distortion`` is (k1, k2, p1, p2, k3), OpenCV's order.
    """

    width_px: int
    height_px: int
    focal_x_px: float
    focal_y_px: float
    centre_x_px: float
    centre_y_px: float
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Shape (3, 3), pixels."""
        return np.array(
            [
                [self.focal_x_px, 0.0, self.centre_x_px],
                [0.0, self.focal_y_px, self.centre_y_px],
                [0.0, 0.0, 1.0],
            ]
        )


@dataclass(frozen=True)
class StereoCalibration:
    """Two cameras, ``T_left_right`` and the mounting ``T_base_left``.

    Frames ``left`` and ``right`` are the unrectified optical frames (z forward, x right,
    y down). ``camera``, the left camera after rectification, is derived from this by
    ``perception.rectify``. ``serials`` are the left and right camera's serial numbers: a
    calibration belongs to that pair and no other.
    """

    serials: tuple[str, str]
    left: CameraIntrinsics
    right: CameraIntrinsics
    T_left_right: Transform
    T_base_left: Transform
    version: int = 1

    def __post_init__(self) -> None:
        for name, transform, frames in (
            ("T_left_right", self.T_left_right, ("left", "right")),
            ("T_base_left", self.T_base_left, ("base", "left")),
        ):
            if (transform.parent, transform.child) != frames:
                raise ValueError(f"{name} relates {transform.parent} and {transform.child}")

    @property
    def baseline_m(self) -> float:
        """Distance between the two optical centres."""
        return float(np.linalg.norm(self.T_left_right.translation_m))
