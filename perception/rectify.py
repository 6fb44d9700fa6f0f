"""From two raw cameras to one ideal pair: rows aligned, axes parallel, no distortion.

Frame ``camera`` is the rectified left camera: it sits in the left camera's optical centre, its
x axis points along the baseline to the right camera, its z axis is as close to the middle of
the two optical axes as that allows.
"""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from hal import CameraIntrinsics, Region, StereoCalibration, StereoShot, Transform
from hal.errors import NoDepthError
from perception.volume import Volume

__all__ = [
    "Pinhole",
    "RectifiedPair",
    "Rectifier",
    "T_base_camera",
    "T_left_camera",
    "rectifier_for",
    "regions_for",
]

Maps = tuple[NDArray[np.float32], NDArray[np.float32]]


@dataclass(frozen=True)
class Pinhole:
    """The ideal pair: focal length and baseline, and the output rectangles' principal points.

    ``centre_x_px`` belongs to the left output image. Column ``u`` there and column
    ``u - disparity_px + right_shift_px`` of the right output image look along the same plane
    through both centres.
    """

    width_px: int
    height_px: int
    focal_px: float
    centre_x_px: float
    centre_y_px: float
    baseline_m: float
    right_width_px: int
    right_shift_px: int
    disparity_low_px: float
    disparity_high_px: float


@dataclass(frozen=True, eq=False)
class RectifiedPair:
    """Left (H, W) and right (H, right W) image, float32 grey levels of the full bit range."""

    left: NDArray[np.float32]
    right: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Rectifier:
    """Maps from the ideal pair to the raw images of two regions."""

    pinhole: Pinhole
    left_maps: Maps
    right_maps: Maps

    def __call__(self, shot: StereoShot) -> RectifiedPair:
        """Resample a shot; what lies outside of its images becomes 0."""
        return RectifiedPair(
            _resampled(shot.left, self.left_maps), _resampled(shot.right, self.right_maps)
        )


def T_left_camera(calibration: StereoCalibration) -> Transform:
    """Pose of the rectified left camera in the raw left one: a pure rotation."""
    T_left_right = calibration.T_left_right
    x = T_left_right.translation_m / calibration.baseline_m
    forward = T_left_right.rotation[:, 2] + (0.0, 0.0, 1.0)
    y = np.cross(forward, x)
    y /= np.linalg.norm(y)
    rotation = np.stack([x, y, np.cross(x, y)], axis=1)
    return Transform.from_parts("left", "camera", rotation, np.zeros(3))


def T_base_camera(calibration: StereoCalibration) -> Transform:
    """Pose of the rectified left camera in the base frame."""
    return calibration.T_base_left @ T_left_camera(calibration)


def regions_for(
    calibration: StereoCalibration, volume: Volume, *, margin_px: int = 24, multiple_px: int = 8
) -> tuple[Region, Region]:
    """Return the smallest equal-sized sensor regions that see a volume in both cameras.

    Offsets and sizes are multiples of ``multiple_px``, as sensors want them.

    Raises
    ------
    NoDepthError
        The volume lies outside of a camera's picture.
    """
    base_left = calibration.T_base_left.inverse()
    T_right_base = calibration.T_left_right.inverse() @ base_left
    corners = volume.corners_base()
    boxes = [
        _bounds(calibration.left, base_left.apply(corners), margin_px, multiple_px, "left"),
        _bounds(calibration.right, T_right_base.apply(corners), margin_px, multiple_px, "right"),
    ]
    size = np.max([high - low for low, high in boxes], axis=0)
    regions = []
    for (low, _), camera in zip(boxes, (calibration.left, calibration.right), strict=True):
        limit = np.array([camera.width_px, camera.height_px]) - size
        offset = np.minimum(low, limit // multiple_px * multiple_px)
        regions.append(Region(int(offset[0]), int(offset[1]), int(size[0]), int(size[1])))
    return regions[0], regions[1]


@lru_cache(maxsize=4)
def rectifier_for(
    calibration: StereoCalibration, left: Region, right: Region, volume: Volume | None = None
) -> Rectifier:
    """Make the maps for two regions; with a volume, only as much of them as shows it.

    Without a volume the output has the left region's size and depth from 0.3 m to 1.5 m.

    Raises
    ------
    NoDepthError
        The volume lies outside of the regions.
    """
    pinhole = _pinhole(calibration, left, volume)
    to_left = T_left_camera(calibration).rotation
    to_right = calibration.T_left_right.rotation.T @ to_left
    columns = np.arange(float(pinhole.width_px)) - pinhole.centre_x_px
    right_columns = np.arange(float(pinhole.right_width_px)) - pinhole.centre_x_px
    right_columns -= pinhole.right_shift_px
    rows = np.arange(float(pinhole.height_px)) - pinhole.centre_y_px
    focal_px = pinhole.focal_px
    return Rectifier(
        pinhole,
        _maps(calibration.left, left, to_left, columns / focal_px, rows / focal_px),
        _maps(calibration.right, right, to_right, right_columns / focal_px, rows / focal_px),
    )


def distorted(
    camera: CameraIntrinsics, x: NDArray[np.floating], y: NDArray[np.floating]
) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """Brown's model: ray slopes x/z, y/z of any shape to full-sensor pixels (u, v)."""
    k1, k2, p1, p2, k3 = camera.distortion
    r = x * x + y * y
    radial = 1 + r * (k1 + r * (k2 + r * k3))
    xy = 2 * x * y
    u = x * radial + p1 * xy + p2 * (r + 2 * x * x)
    v = y * radial + p1 * (r + 2 * y * y) + p2 * xy
    return (
        u * camera.focal_x_px + camera.centre_x_px,
        v * camera.focal_y_px + camera.centre_y_px,
    )


def _bounds(
    camera: CameraIntrinsics,
    points_m: NDArray[np.float64],
    margin_px: int,
    multiple_px: int,
    side: str,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Low and high corner (2,) of the pixels that see the points, clipped to the sensor."""
    if (points_m[:, 2] <= 0.05).any():
        raise NoDepthError(f"the volume reaches behind the {side} camera: check T_base_left")
    slopes = points_m[:, :2] / points_m[:, 2:]
    pixels = np.stack(distorted(camera, slopes[:, 0], slopes[:, 1]), axis=1)
    size = np.array([camera.width_px, camera.height_px])
    low = np.clip(np.floor(pixels.min(axis=0)).astype(int) - margin_px, 0, size)
    high = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + 1 + margin_px, 0, size)
    low = low // multiple_px * multiple_px
    high = np.minimum(-(-high // multiple_px) * multiple_px, size // multiple_px * multiple_px)
    if (high - low < 4 * multiple_px).any():
        raise NoDepthError(f"the {side} camera does not see the volume: check T_base_left")
    return low, high


def _pinhole(calibration: StereoCalibration, left: Region, volume: Volume | None) -> Pinhole:
    cameras = (calibration.left, calibration.right)
    focal_px = float(np.mean([(c.focal_x_px + c.focal_y_px) / 2 for c in cameras]))
    baseline_m = calibration.baseline_m
    slopes = _edge_slopes(calibration, left)
    low, high = slopes.min(axis=0), slopes.max(axis=0)
    nearest_m, farthest_m = 0.3, 1.5
    if volume is not None:
        points = T_base_camera(calibration).inverse().apply(volume.corners_base())
        if (points[:, 2] <= 0.05).any():
            raise NoDepthError("the volume reaches behind the left camera: check T_base_left")
        seen = points[:, :2] / points[:, 2:]
        low, high = np.maximum(low, seen.min(axis=0)), np.minimum(high, seen.max(axis=0))
        nearest_m, farthest_m = float(points[:, 2].min()), float(points[:, 2].max())
    if (high - low < 16 / focal_px).any():
        raise NoDepthError("the images do not show the volume: check the regions and T_base_left")
    first, last = np.floor(low * focal_px), np.ceil(high * focal_px)
    width_px, height_px = (int(n) + 1 for n in last - first)
    disparity_low_px = focal_px * baseline_m / farthest_m
    disparity_high_px = focal_px * baseline_m / nearest_m
    shift_px = int(np.ceil(disparity_high_px)) + MARGIN_PX
    return Pinhole(
        width_px=width_px,
        height_px=height_px,
        focal_px=focal_px,
        centre_x_px=float(-first[0]),
        centre_y_px=float(-first[1]),
        baseline_m=baseline_m,
        right_width_px=width_px + shift_px - int(disparity_low_px) + MARGIN_PX,
        right_shift_px=shift_px,
        disparity_low_px=disparity_low_px,
        disparity_high_px=disparity_high_px,
    )


MARGIN_PX = 8
"""Columns of the right image beyond the range of disparities, for windows and offsets."""


def _edge_slopes(calibration: StereoCalibration, region: Region) -> NDArray[np.float64]:
    """Rectified slopes (n, 2) of the rays through a region's border."""
    camera = calibration.left
    u = region.offset_x_px + np.linspace(0, region.width_px - 1, 65)
    v = region.offset_y_px + np.linspace(0, region.height_px - 1, 65)
    low, high = np.full(65, v[0]), np.full(65, v[-1])
    first, last = np.full(65, u[0]), np.full(65, u[-1])
    border = np.concatenate(
        [np.stack(pair, 1) for pair in ((u, low), (u, high), (first, v), (last, v))]
    )
    rounds = (cv2.TERM_CRITERIA_COUNT, 30, 0.0)
    ideal = cv2.undistortPointsIter(
        border[:, None, :], camera.matrix, np.array(camera.distortion), np.eye(3), np.eye(3), rounds
    )[:, 0]
    rays = np.column_stack([ideal, np.ones(len(ideal))]) @ T_left_camera(calibration).rotation
    return np.asarray(rays[:, :2] / rays[:, 2:])


def _maps(
    camera: CameraIntrinsics,
    region: Region,
    rotation: NDArray[np.float64],
    x: NDArray[np.floating],
    y: NDArray[np.floating],
) -> Maps:
    """Raw region pixel of every output pixel; ``rotation`` takes ideal to raw camera rays."""
    x, y = x[None, :], y[:, None]
    rays = [row[0] * x + row[1] * y + row[2] for row in rotation]
    u, v = distorted(camera, rays[0] / rays[2], rays[1] / rays[2])
    return (
        np.asarray(u - region.offset_x_px, np.float32),
        np.asarray(v - region.offset_y_px, np.float32),
    )


def _resampled(image: NDArray[np.integer], maps: Maps) -> NDArray[np.float32]:
    floats = image.astype(np.float32)
    return np.asarray(cv2.remap(floats, *maps, cv2.INTER_CUBIC, borderValue=0))
