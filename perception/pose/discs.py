"""Flat faces: a part seen end-on, a gear lying on its side.

A piece whose normals agree is taken for one of the part's two end faces. The axis is its normal,
the part lies behind it, and for an n-fold part the phase is tried in a few steps.
"""

import numpy as np
from numpy.typing import NDArray

from perception.pose.model import PartModel
from perception.pose.surface import Surface
from perception.pose.tube import axis_frame, sample_pieces

__all__ = ["place_on_discs"]

FLATNESS = 0.90
POINTS_PER_PIECE = 200
MIN_POINTS = 40
PHASES = 3


def place_on_discs(
    surface: Surface, model: PartModel, labels: NDArray[np.int32], *, rng: np.random.Generator
) -> list[list[NDArray[np.float64]]]:
    """Return, for each flat piece, the poses (4, 4) with an end face on it."""
    points, normals = sample_pieces(surface, labels, POINTS_PER_PIECE, rng)
    part = model.part
    half_m = part.length_m / 2
    found = []
    for cloud, directions in zip(points, normals, strict=True):
        if len(cloud) < MIN_POINTS:
            continue
        scatter = np.einsum("ni,nj->ij", directions, directions) / len(directions)
        values, vectors = np.linalg.eigh(scatter)
        extent_m = np.ptp(cloud, axis=0).max()
        if values[2] < FLATNESS or extent_m > 2.4 * part.max_radius_m:
            continue
        axis = vectors[:, 2] * np.sign(vectors[:, 2] @ directions.mean(axis=0))
        # Half-hidden faces have their middle elsewhere; the bounding box is a better guess.
        middle = (cloud.min(axis=0) + cloud.max(axis=0) + cloud.mean(axis=0)) / 3
        middle += axis * ((cloud.mean(axis=0) - middle) @ axis)
        poses = []
        for sign in (1,) if part.is_reversible else (1, -1):
            frame = axis_frame(sign * axis, middle - axis * half_m)
            for turn in _phases(part.fold):
                pose = frame.copy()
                c, s = np.cos(turn), np.sin(turn)
                pose[:3, :3] = frame[:3, :3] @ [[c, -s, 0], [s, c, 0], [0, 0, 1]]
                poses.append(pose)
        found.append(poses)
    return found


def _phases(fold: int) -> NDArray[np.float64]:
    if fold == 0:
        return np.zeros(1)
    return 2 * np.pi / fold * np.arange(PHASES) / PHASES
