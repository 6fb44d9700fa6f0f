"""The outline of a part in the rectified image, for pictures."""

import cv2
import numpy as np
from numpy.typing import NDArray

from hal import Transform
from perception.parts import Part
from perception.view import DepthView

__all__ = ["outline"]

FINER = 4
CIRCLE_POINTS = 73


def outline(part: Part, T_camera_object: Transform, view: DepthView) -> list[NDArray[np.float32]]:
    """Return the part's silhouette and the visible half of each step.

    Returns
    -------
    polylines
        Each of shape (N, 2), float32: column u and row v in the view, pixels. The silhouette
        comes first and is closed (its last point is its first). Empty behind the camera.
    """
    points = T_camera_object.apply(part.vertices_m)
    if points[:, 2].min() < 0.01:
        return []
    image_px = _project(points, view)
    lines = _silhouettes(image_px, part.triangles)
    if part.fold == 0:
        lines += _shoulders(part, T_camera_object, view)
    return lines


def _project(points_m: NDArray[np.float64], view: DepthView) -> NDArray[np.float64]:
    scaled = points_m[:, :2] / points_m[:, 2:] * view.focal_px
    return np.asarray(scaled + [view.centre_x_px, view.centre_y_px])


def _silhouettes(
    image_px: NDArray[np.float64], triangles: NDArray[np.int32]
) -> list[NDArray[np.float32]]:
    """Fill the triangles on a canvas of their own and follow the rim."""
    low = np.floor(image_px.min(axis=0)) - 2
    size = np.ceil(image_px.max(axis=0) - low + 3).astype(int)
    if (size > 8000 // FINER).any():
        return []
    canvas = np.zeros((int(size[1]) * FINER, int(size[0]) * FINER), np.uint8)
    corners = np.round((image_px - low)[triangles] * FINER).astype(np.int32)
    for corner in corners:
        cv2.fillConvexPoly(canvas, corner, 1)
    contours, _ = cv2.findContours(canvas, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_SIMPLE)
    lines = []
    for contour in sorted(contours, key=lambda c: -cv2.contourArea(c)):
        smooth = cv2.approxPolyDP(contour, 1.0, closed=True)[:, 0].astype(np.float32)
        if len(smooth) >= 3:
            closed = np.concatenate([smooth, smooth[:1]]) / FINER
            lines.append((closed + low).astype(np.float32))
    return lines


def _shoulders(
    part: Part, T_camera_object: Transform, view: DepthView
) -> list[NDArray[np.float32]]:
    profile = part.profile
    theta = np.linspace(0, 2 * np.pi, CIRCLE_POINTS)
    circle = np.column_stack([np.cos(theta), np.sin(theta), np.zeros(CIRCLE_POINTS)])
    radii_m = np.concatenate([profile.radii_m[:1], profile.radii_m, profile.radii_m[-1:]])
    lines = []
    for k, z_m in enumerate(profile.z_edges_m.tolist()):
        radius_m = max(radii_m[k], radii_m[k + 1])
        points = T_camera_object.apply(circle * radius_m + [0, 0, z_m])
        facing = (points * (circle @ T_camera_object.rotation.T)).sum(axis=1) < 0
        # Start where the circle comes into sight, so that what is seen is one run.
        start = int(np.argmax(facing & ~np.roll(facing, 1))) if not facing.all() else 0
        order = (start + np.arange(CIRCLE_POINTS - 1)) % (CIRCLE_POINTS - 1)
        seen = order[facing[order]]
        if len(seen) > 1:
            lines.append(_project(points[seen], view).astype(np.float32))
    return lines
