"""A depth image with the pinhole it belongs to: what depth gives and pose takes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["DepthView"]


@dataclass(frozen=True, eq=False)
class DepthView:
    """Depth in the rectified left camera (frame ``camera``: z forward, x right, y down).

    ``depth_m`` has shape (H, W), float32, metres along z; NaN is no measurement.
    ``confidence`` has the same shape, the matching score in 0..1. ``image`` is the rectified
    left image, float32 grey levels, for pictures. A pixel (column u, row v), integers at
    pixel centres, looks along ((u - centre_x_px) / focal_px, (v - centre_y_px) / focal_px, 1).
    """

    depth_m: NDArray[np.float32]
    confidence: NDArray[np.float32]
    image: NDArray[np.float32]
    focal_px: float
    centre_x_px: float
    centre_y_px: float
    baseline_m: float

    def points(self) -> NDArray[np.float32]:
        """Return the organised cloud, shape (H, W, 3), camera frame, metres; NaN where no depth."""
        height, width = self.depth_m.shape
        x = (np.arange(width, dtype=np.float32) - np.float32(self.centre_x_px)) / np.float32(
            self.focal_px
        )
        y = (np.arange(height, dtype=np.float32) - np.float32(self.centre_y_px)) / np.float32(
            self.focal_px
        )
        points = np.empty((height, width, 3), np.float32)
        np.multiply(self.depth_m, x, out=points[..., 0])
        np.multiply(self.depth_m, y[:, None], out=points[..., 1])
        points[..., 2] = self.depth_m
        return points
