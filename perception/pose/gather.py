"""Cutting out of the scene what concerns one pose."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.pose.lsq import to_object
from perception.pose.model import PartModel
from perception.pose.surface import Surface

__all__ = ["Block", "block_about", "near_points", "overshoot_m"]


@dataclass(frozen=True)
class Block:
    """Every ``stride``-th pixel of a rectangle of the window."""

    rows: slice
    columns: slice

    @property
    def slices(self) -> tuple[slice, slice]:
        """To index an image of the window with."""
        return self.rows, self.columns


def block_about(
    surface: Surface,
    model: PartModel,
    pose: NDArray[np.float64],
    *,
    stride: int,
    margin_px: int = 3,
) -> Block:
    """Return the block that shows the model at ``pose`` (4, 4)."""
    corners = model.corners_m @ pose[:3, :3].T + pose[:3, 3]
    corners[:, 2] = np.maximum(corners[:, 2], 0.05)
    rows, columns = surface.project(corners)
    height, width = surface.is_measured.shape
    limits = []
    for values, size in ((rows, height), (columns, width)):
        low = int(np.clip(np.floor(values.min()) - margin_px, 0, size))
        high = int(np.clip(np.ceil(values.max()) + margin_px + 1, low, size))
        limits.append(slice(low, high, stride))
    return Block(*limits)


def overshoot_m(surface: Surface, model: PartModel, pose: NDArray[np.float64]) -> float:
    """Return how far the part at ``pose`` (4, 4) would reach into the bin's floor or walls."""
    points = np.einsum("ni,ji->nj", model.samples_m, pose[:3, :3]) + pose[:3, 3]
    return surface.volume.overshoot_m(points)


def near_points(
    surface: Surface,
    model: PartModel,
    pose: NDArray[np.float64],
    mask: NDArray[np.bool_],
    *,
    within_m: float,
    stride: int,
    most: int,
    facing: float = 0.3,
) -> NDArray[np.float64]:
    """Return scene points (n, 3) of ``mask`` (H, W) near the model's surface at ``pose``.

    Near is closer than ``within_m``, with a normal that deviates from the model's by no more
    than acos(``facing``). At most ``most``, evenly spread over the image.
    """
    block = block_about(surface, model, pose, stride=stride).slices
    chosen = mask[block]
    points = surface.points_m[block][chosen]
    local = to_object(points[None], pose[None].astype(np.float32))[0]
    distance_m = np.abs(model.field.distance(local))
    near = np.flatnonzero(distance_m < within_m)
    if facing > -1:
        _, gradient, _ = model.field.sample(local[near])
        normals = surface.normals[block][chosen][near]
        towards = np.einsum("ij,nj->ni", pose[:3, :3].astype(np.float32), gradient)
        near = near[(towards * normals).sum(axis=1) > facing]
    if len(near) > most:
        near = near[np.linspace(0, len(near) - 1, most).astype(np.int64)]
    return points[near].astype(np.float64)
