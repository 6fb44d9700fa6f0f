"""The organised surface: the depth image of the bin, smoothed, with normals and its noise.

A plane is linear in inverse depth over the image, so smoothing and differentiating inverse depth
bends no plane. This is the image-shaped counterpart of the moving least squares and the normals
of ``perception.cloud``; the pose path uses this one because it costs a few milliseconds.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.pose.volume import BinVolume, Window
from perception.view import DepthView

__all__ = ["Surface", "see_surface"]

SMOOTHING_DIAMETER_PX = 9
SMOOTHING_SIGMA_PX = 3.0
# Two rounds: the first bridges the noise, the second keeps edges that the first made clear.
SMOOTHING_DEPTHS_M = (0.003, 0.002)
NO_DEPTH = -10.0
BORDER_PX = 12


@dataclass(frozen=True, eq=False)
class Surface:
    """What the bin's part of a view shows; all images have the shape (H, W) of ``window``.

    ``points_m`` (H, W, 3) as measured; ``smooth_m`` the smoothed depth; ``normals`` (H, W, 3),
    unit, towards the camera; ``is_measured``: there is depth; ``is_inside``: and it lies in the
    volume. ``rays`` (H, W, 3) are the viewing directions with z = 1. ``noise_m`` is the robust
    standard deviation of the measured about the smoothed depth. ``measured_share`` is how much of
    the whole volume's window has depth.
    """

    window: Window
    volume: BinVolume
    focal_px: float
    points_m: NDArray[np.float32]
    smooth_m: NDArray[np.float32]
    normals: NDArray[np.float32]
    rays: NDArray[np.float32]
    is_measured: NDArray[np.bool_]
    is_inside: NDArray[np.bool_]
    noise_m: float
    measured_share: float

    @property
    def depth_m(self) -> NDArray[np.float32]:
        """Shape (H, W), as measured; NaN is no measurement."""
        return self.points_m[..., 2]

    @cached_property
    def pixel_m(self) -> float:
        """The width of a pixel at the middle of what was measured."""
        depth_m = self.depth_m[self.is_measured]
        return float(np.median(depth_m)) / self.focal_px if depth_m.size else np.nan

    def project(
        self, points_m: NDArray[np.floating]
    ) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
        """Return rows and columns, fractional, in the window, of points (..., 3)."""
        u = points_m[..., 0] / points_m[..., 2] * self.focal_px
        v = points_m[..., 1] / points_m[..., 2] * self.focal_px
        first = self.rays[0, 0] * self.focal_px
        return v - first[1], u - first[0]


def see_surface(view: DepthView, volume: BinVolume) -> Surface | None:
    """Cut the volume's window out of ``view``, smooth it and find normals.

    Returns None when the volume is not in view.
    """
    window = volume.window(view)
    if window is None:
        return None
    surface = _cut(view, volume, window)
    # The walls show no parts: what lies inside is often half of the window.
    inner = window.around(surface.is_inside, BORDER_PX)
    return (
        surface if inner is None else _smoothed(_cut(view, volume, inner), surface.measured_share)
    )


def _cut(view: DepthView, volume: BinVolume, window: Window) -> Surface:
    """The surface as measured, not smoothed yet."""
    rows, columns = window.slices
    depth_m = np.ascontiguousarray(view.depth_m[rows, columns], np.float32)
    x = (np.arange(window.left, window.right) - view.centre_x_px) / view.focal_px
    y = (np.arange(window.top, window.bottom) - view.centre_y_px) / view.focal_px
    rays = np.ones((*depth_m.shape, 3), np.float32)
    rays[..., 0] = x
    rays[..., 1] = y[:, None]
    is_measured = np.isfinite(depth_m) & (depth_m > 0)
    points_m = rays * np.where(is_measured, depth_m, np.float32(np.nan))[..., None]
    return Surface(
        window=window,
        volume=volume,
        focal_px=view.focal_px,
        points_m=points_m,
        smooth_m=depth_m,
        normals=np.zeros_like(rays),
        rays=rays,
        is_measured=is_measured,
        is_inside=volume.contains(points_m),
        noise_m=0.0,
        measured_share=float(is_measured.mean()),
    )


def _smoothed(surface: Surface, measured_share: float) -> Surface:
    depth_m, is_measured = surface.depth_m, surface.is_measured
    inverse = smooth_inverse_depth(depth_m, is_measured)
    smooth_m = np.where(is_measured, 1 / np.where(is_measured, inverse, 1), np.float32(np.nan))
    off_m = np.abs(depth_m - smooth_m)[surface.is_inside]
    return replace(
        surface,
        smooth_m=smooth_m,
        normals=normals_from_inverse_depth(inverse, surface.rays, surface.focal_px),
        noise_m=1.4826 * float(np.median(off_m)) if off_m.size else 0.0,
        measured_share=measured_share,
    )


def smooth_inverse_depth(
    depth_m: NDArray[np.float32], is_measured: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """Smooth 1/z bilaterally; a missing pixel stays far below every measured one."""
    inverse = np.where(is_measured, 1 / np.where(is_measured, depth_m, 1), np.float32(NO_DEPTH))
    if not is_measured.any():
        return inverse.astype(np.float32)
    middle_m = float(np.median(depth_m[is_measured]))
    for step_m in SMOOTHING_DEPTHS_M:
        inverse = cv2.bilateralFilter(
            inverse, SMOOTHING_DIAMETER_PX, step_m / middle_m**2, SMOOTHING_SIGMA_PX
        )
    return np.asarray(inverse, np.float32)


def normals_from_inverse_depth(
    inverse: NDArray[np.float32], rays: NDArray[np.float32], focal_px: float
) -> NDArray[np.float32]:
    """Return unit normals (H, W, 3) towards the camera from 1/z (H, W).

    A plane n.P = -c has 1/z = -(n.ray)/c, so the image gradient of 1/z gives n up to scale.
    """
    along_x = cv2.Scharr(inverse, cv2.CV_32F, 1, 0) * np.float32(focal_px / 32)
    along_y = cv2.Scharr(inverse, cv2.CV_32F, 0, 1) * np.float32(focal_px / 32)
    along_z = inverse - along_x * rays[..., 0] - along_y * rays[..., 1]
    length = np.sqrt(along_x**2 + along_y**2 + along_z**2)
    scale = -1 / np.maximum(length, np.float32(1e-12))
    return np.stack([along_x * scale, along_y * scale, along_z * scale], axis=-1)
