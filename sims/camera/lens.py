"""Pixels to rays: Brown's distortion inverted exactly, for any part of the sensor."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hal import CameraIntrinsics, Region

__all__ = ["ray_slopes", "undistorted"]

ROUNDS = 14


@lru_cache(maxsize=8)
def ray_slopes(
    camera: CameraIntrinsics, region: Region, border_px: int = 0
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Slopes (x/z, y/z) of the rays through a region's pixel centres.

    Each of shape (height + 2 border, width + 2 border), float32, read-only; a border pixel may
    lie off the sensor.
    """
    columns = np.arange(-border_px, region.width_px + border_px) + float(region.offset_x_px)
    rows = np.arange(-border_px, region.height_px + border_px) + float(region.offset_y_px)
    u, v = np.meshgrid(columns, rows)
    x, y = undistorted(camera, u, v)
    slopes = x.astype(np.float32), y.astype(np.float32)
    for table in slopes:
        table.setflags(write=False)
    return slopes


def undistorted(
    camera: CameraIntrinsics, u_px: NDArray[np.floating], v_px: NDArray[np.floating]
) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """Invert the Brown model by fixed-point iteration, to 1e-12 for lenses like ours.

    ``u_px``, ``v_px``: full-sensor pixel coordinates of any shape; returns ideal slopes.
    """
    k1, k2, p1, p2, k3 = camera.distortion
    x0 = (u_px - camera.centre_x_px) / camera.focal_x_px
    y0 = (v_px - camera.centre_y_px) / camera.focal_y_px
    x, y = x0.copy(), y0.copy()
    for _ in range(ROUNDS):
        r = x * x + y * y
        c = 1 + r * (k1 + r * (k2 + r * k3))
        xy = 2 * x * y
        dx = p1 * xy + p2 * (r + 2 * x * x)
        dy = p1 * (r + 2 * y * y) + p2 * xy
        x = (x0 - dx) / c
        y = (y0 - dy) / c
    return x, y
