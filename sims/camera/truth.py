"""What a perfect stereo camera would have measured. For benches and scores only."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from hal import StereoCalibration, Transform
from perception.rectify import Pinhole, T_left_camera, distorted
from sims.camera.bodies import Bodies, Drawn, Poses
from sims.camera.cast import RayScene, hit_points, into_projector
from sims.camera.lens import undistorted
from sims.camera.rig import RigTruth

__all__ = ["TrueView", "true_view", "visible_shares"]

STEP_M = 0.003
EDGE_PX = 4

Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class TrueView:
    """Truth for every pixel of the rectified left camera of a calibration, arrays (H, W).

    ``depth_m``: what the pixel's true ray hits, in the calibration's own frame ``camera``; NaN
    is nothing. ``part`` is the part's number or -1. ``is_measurable`` is a part's pixel that
    the right camera sees too and the projector lights; ``is_interior`` is such a pixel more
    than 4 px from a step of more than 3 mm.
    """

    depth_m: NDArray[np.float32]
    part: NDArray[np.int32]
    is_measurable: Mask
    is_interior: Mask


def true_view(
    rig: RigTruth,
    bodies: Bodies,
    poses: Poses,
    calibration: StereoCalibration,
    pinhole: Pinhole,
) -> TrueView:
    """Cast the rays that the true left camera has where the calibration believes its own."""
    true = rig.calibration
    scene = RayScene(bodies, poses)
    slopes = _true_slopes(rig, calibration, pinhole)
    hits, rays = scene.first_hits(true.T_base_left, slopes)
    points = hit_points(hits, rays)
    right_m = (true.T_base_left @ true.T_left_right).translation_m
    lamp_m = rig.projector.T_base_projector.translation_m
    in_light = into_projector(rig.projector, points)[2]
    towards = sum(
        n * (np.float32(lamp) - p) for n, lamp, p in zip(hits.normal, lamp_m, points, strict=True)
    )
    part = scene.parts[hits.index]
    is_measurable = (part >= 0) & in_light & (np.asarray(towards) > 0)
    is_measurable &= ~scene.is_hidden_from(points, hits.normal, right_m)
    is_measurable &= ~scene.is_hidden_from(points, hits.normal, lamp_m)
    depth_m = _depth_in(calibration, slopes, hits.depth_m)
    is_interior = is_measurable & ~_near_steps(depth_m)
    return TrueView(depth_m, part, is_measurable, is_interior)


def visible_shares(
    rig: RigTruth,
    bodies: Bodies,
    poses: Poses,
    calibration: StereoCalibration,
    pinhole: Pinhole,
) -> dict[int, float]:
    """Share of each part's camera-facing surface that the left camera sees, 0..1, by part."""
    slopes = _true_slopes(rig, calibration, pinhole)
    T_base_left = rig.calibration.T_base_left
    scene = RayScene(bodies, poses)
    hits, _ = scene.first_hits(T_base_left, slopes)
    seen = scene.parts[hits.index]
    shares = {}
    for item in bodies.drawn:
        if item.part < 0:
            continue
        rows, columns = _window(item, poses, T_base_left, slopes)
        alone = RayScene(_Only(item), poses)
        cut = (slopes[0][rows, columns], slopes[1][rows, columns])
        own, _ = alone.first_hits(T_base_left, cut)
        facing = int((own.index >= 0).sum())
        shares[item.part] = float((seen == item.part).sum()) / facing if facing else 0.0
    return shares


class _Only(Bodies):
    """One mesh of a scene."""

    def __init__(self, item: Drawn) -> None:
        self.drawn = [item]


def _window(
    item: Drawn,
    poses: Poses,
    T_base_left: Transform,
    slopes: tuple[NDArray[np.float32], NDArray[np.float32]],
) -> tuple[slice, slice]:
    """Rows and columns that can see a mesh."""
    points = T_base_left.inverse().apply(item.placed(poses))
    x, y = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
    inside = (slopes[0] >= x.min()) & (slopes[0] <= x.max())
    inside &= (slopes[1] >= y.min()) & (slopes[1] <= y.max())
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    if rows.size == 0 or columns.size == 0:
        return slice(0, 1), slice(0, 1)
    return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)


def _true_slopes(
    rig: RigTruth, calibration: StereoCalibration, pinhole: Pinhole
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    columns = (np.arange(pinhole.width_px) - pinhole.centre_x_px) / pinhole.focal_px
    rows = (np.arange(pinhole.height_px) - pinhole.centre_y_px) / pinhole.focal_px
    x, y = np.meshgrid(columns, rows)
    rotation = T_left_camera(calibration).rotation
    rays = [row[0] * x + row[1] * y + row[2] for row in rotation]
    u, v = distorted(calibration.left, rays[0] / rays[2], rays[1] / rays[2])
    true_x, true_y = undistorted(rig.calibration.left, u, v)
    return true_x.astype(np.float32), true_y.astype(np.float32)


def _depth_in(
    calibration: StereoCalibration,
    slopes: tuple[NDArray[np.float32], NDArray[np.float32]],
    depth_m: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Depth in frame ``left`` to depth in frame ``camera``: the two differ by a rotation."""
    forward = T_left_camera(calibration).rotation[:, 2].astype(np.float32)
    depth = depth_m * (forward[0] * slopes[0] + forward[1] * slopes[1] + forward[2])
    return np.where(np.isfinite(depth), depth, np.float32(np.nan))


def _near_steps(depth_m: NDArray[np.float32]) -> Mask:
    filled = np.where(np.isfinite(depth_m), depth_m, np.float32(9))
    step = np.zeros(depth_m.shape, np.uint8)
    across = np.abs(np.diff(filled, axis=1)) > STEP_M
    down = np.abs(np.diff(filled, axis=0)) > STEP_M
    step[:, :-1] |= across
    step[:, 1:] |= across
    step[:-1] |= down
    step[1:] |= down
    reach = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * EDGE_PX + 1,) * 2)
    return np.asarray(cv2.dilate(step, reach) > 0)
