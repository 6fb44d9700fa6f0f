"""Seeing a model: where each viewing ray first meets it, by sphere tracing its distance field.

From any point the surface is at least the signed distance away, so that far one may safely go.
Hidden sides and steps are handled by the walk itself; no mesh, no rasteriser.
"""

import numpy as np
from numpy.typing import NDArray

from perception.pose.field import Field

__all__ = ["trace"]

CONTACT_M = 0.00015
MAX_STEPS = 32


def trace(
    field: Field, pose: NDArray[np.float64], rays: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return the depth (N,) along z at which rays (N, 3), z = 1, meet the part; NaN for a miss."""
    rotation = pose[:3, :3].astype(np.float32)
    origin = -(pose[:3, 3] @ pose[:3, :3]).astype(np.float32)
    direction = np.empty_like(rays)
    for k in range(3):
        direction[:, k] = (
            rays[:, 0] * rotation[0, k] + rays[:, 1] * rotation[1, k] + rays[:, 2] * rotation[2, k]
        )
    speed = np.sqrt((rays**2).sum(axis=1))
    depth_m, last_m = _bounds(field, origin, direction)
    active = np.flatnonzero(depth_m < last_m)
    found = np.full(len(rays), np.nan, np.float32)
    speed = np.sqrt((rays**2).sum(axis=1))
    for _ in range(MAX_STEPS):
        if not len(active):
            break
        at = depth_m[active]
        d = field.distance(origin + at[:, None] * direction[active])
        hit = d < CONTACT_M
        at = at + d / speed[active]
        found[active[hit]] = at[hit]
        depth_m[active] = at
        active = active[~hit & (at < last_m[active])]
    return found


def _bounds(
    field: Field, origin: NDArray[np.float32], direction: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Where rays enter and leave the cylinder about the part: nothing for a miss."""
    slack = np.float32(0.0005)
    dx, dy, dz = direction.T
    a = np.maximum(dx * dx + dy * dy, np.float32(1e-12))
    b = dx * origin[0] + dy * origin[1]
    c = origin[0] ** 2 + origin[1] ** 2 - np.float32(field.radius_m + slack) ** 2
    root = b * b - a * c
    spread = np.sqrt(np.maximum(root, 0))
    half = np.float32(field.half_length_m + slack)
    steep = np.where(np.abs(dz) < 1e-6, np.float32(1e-6), dz)
    ends = np.stack([(-half - origin[2]) / steep, (half - origin[2]) / steep])
    first = np.maximum((-b - spread) / a, ends.min(axis=0))
    last = np.minimum((-b + spread) / a, ends.max(axis=0))
    return first, np.where(root > 0, last, first - 1)
