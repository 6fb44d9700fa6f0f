"""The last fit of accepted poses: each with all the points that are its own."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.pose.edges import fix_along
from perception.pose.gather import block_about, near_points
from perception.pose.lsq import refine, to_object
from perception.pose.model import PartModel
from perception.pose.surface import Surface
from perception.pose.tube import pad

__all__ = ["Polished", "own_points", "polish"]

OWN_M = 0.0020
POINTS = 1000
SCALES_M = (0.0020, 0.0012)
ITERATIONS = 5
FACING = 0.5


@dataclass(frozen=True, eq=False)
class Polished:
    """A pose (4, 4), its J'WJ (6, 6), root mean Tukey loss, and the points used of those seen.

    ``axial_sigma_m`` is what the edges of a turned part say of its place along the axis; None
    when none of them was clear.
    """

    pose: NDArray[np.float64]
    normal_matrix: NDArray[np.float64]
    residual_m: float
    points: int
    pixels: int
    axial_sigma_m: float | None


def own_points(
    surface: Surface, model: PartModel, poses: list[NDArray[np.float64]]
) -> NDArray[np.int32]:
    """Label each pixel (H, W) with the nearest pose, k + 1, within 2 mm; 0 for none."""
    labels = np.zeros(surface.is_inside.shape, np.int32)
    nearest_m = np.full(labels.shape, OWN_M, np.float32)
    for k, pose in enumerate(poses):
        block = block_about(surface, model, pose, stride=1).slices
        inside = surface.is_inside[block]
        points = surface.points_m[block][inside]
        local = to_object(points[None], pose[None].astype(np.float32))[0]
        off_m = np.full(inside.shape, np.inf, np.float32)
        off_m[inside] = np.abs(model.field.distance(local))
        closer = off_m < nearest_m[block]
        nearest_m[block][closer] = off_m[closer]
        labels[block][closer] = k + 1
    return labels


def polish(surface: Surface, model: PartModel, poses: list[NDArray[np.float64]]) -> list[Polished]:
    """Fit all poses once more, points shared out between them."""
    if not poses:
        return []
    labels = own_points(surface, model, poses)
    clouds, pixels = [], []
    for k, pose in enumerate(poses):
        own = labels == k + 1
        pixels.append(int(cv2.countNonZero(own.astype(np.uint8))))
        clouds.append(
            near_points(
                surface, model, pose, own, within_m=OWN_M, stride=1, most=POINTS, facing=FACING
            )
        )
    points, weights = pad(clouds)
    fit = refine(
        model.field, points.astype(np.float32), weights.astype(np.float32), np.array(poses),
        scales_m=SCALES_M, iterations=ITERATIONS,
    )  # fmt: skip
    polished = []
    for k, pose in enumerate(fit.poses):
        fix = fix_along(surface, pose, model.part.profile) if model.part.fold == 0 else None
        if fix is not None:
            pose[:3, 3] += fix.shift_m * pose[:3, 2]
        polished.append(
            Polished(
                pose,
                fit.normal_matrices[k],
                float(np.sqrt(2 * fit.losses_m2[k])),
                len(clouds[k]),
                pixels[k],
                fix.sigma_m if fix is not None and fix.edges else None,
            )
        )
    return polished
