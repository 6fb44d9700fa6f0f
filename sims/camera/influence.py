"""Where a body must be to change a picture: seen, or between the lamp and what is seen.

A body that moves elsewhere - the arm over the tray - leaves every ray as it was, so that the
geometry need not be cast again.
"""

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from hal import CameraIntrinsics, Region, Transform
from sims.camera.bodies import STILL, Bodies, Drawn, Poses
from sims.camera.lens import undistorted
from sims.camera.rig import RigTruth

__all__ = ["Influence"]

FLOOR_M = -0.01
BORDER_PX = 16
EDGE_STEPS = 5


class Influence:
    """The convex hull of both eyes, the lamp, and all that the regions can show of the floor."""

    def __init__(self, rig: RigTruth, left: Region, right: Region) -> None:
        true = rig.calibration
        T_base_right = true.T_base_left @ true.T_left_right
        points = [rig.projector.T_base_projector.translation_m[None]]
        for camera, T, region in (
            (true.left, true.T_base_left, left),
            (true.right, T_base_right, right),
        ):
            points += [T.translation_m[None], _floor_rim(camera, T, region)]
        self._planes = ConvexHull(np.concatenate(points)).equations

    def reaches(self, item: Drawn, poses: Poses) -> bool:
        """Whether the body may have a point inside; never wrongly no."""
        outside = self._planes[:, :3] @ item.placed(poses).T.astype(np.float64)
        return not (outside.min(axis=1) + self._planes[:, 3] > 0).any()

    def is_same_picture(self, bodies: Bodies, before: Poses, after: Poses) -> bool:
        """Whether nothing that counts has moved by more than a micrometre."""
        moved = [item for item in bodies.drawn if _has_moved(item, before, after)]
        return not any(self.reaches(item, p) for item in moved for p in (before, after))


def _has_moved(item: Drawn, before: Poses, after: Poses) -> bool:
    k = item.index
    if item.is_body:
        pairs: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]] = (
            (before.body_m[k], after.body_m[k]),
            (before.body_rotation[k], after.body_rotation[k]),
        )
    else:
        pairs = (
            (before.geom_m[k], after.geom_m[k]),
            (before.geom_rotation[k], after.geom_rotation[k]),
        )
    return any(np.abs(a - b).max() >= STILL for a, b in pairs)


def _floor_rim(
    camera: CameraIntrinsics, T_base_camera: Transform, region: Region
) -> NDArray[np.float64]:
    """Where rays through the region's rim meet the floor, (n, 3), base frame."""
    share = np.linspace(0.0, 1.0, EDGE_STEPS)
    rim = np.array([(a, b) for a, b in product(share, share) if {a, b} & {0.0, 1.0}])
    size = np.array([region.width_px, region.height_px]) + 2 * BORDER_PX
    pixels = rim * size + [region.offset_x_px - BORDER_PX, region.offset_y_px - BORDER_PX]
    x, y = undistorted(camera, pixels[:, 0], pixels[:, 1])
    rays = np.column_stack([x, y, np.ones(len(x))]) @ T_base_camera.rotation.T
    origin = T_base_camera.translation_m
    depth = (FLOOR_M - origin[2]) / np.minimum(rays[:, 2], -1e-6)
    return np.asarray(origin + rays * depth[:, None])
