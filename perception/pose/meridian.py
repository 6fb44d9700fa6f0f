"""The outline of a solid of revolution in the half-plane (radius, z), and distances to it."""

import numpy as np
from numpy.typing import NDArray

from perception.parts import Part

__all__ = ["meridian_distance", "meridian_segments"]

# Half-planes at angles that share no divisor with a tessellation: their mean is the mean facet.
ANGLES_RAD = 2 * np.pi * np.array([0.0137, 0.1413, 0.2791, 0.4177, 0.5449, 0.6731, 0.8123, 0.9391])


def meridian_segments(part: Part, angle_rad: float) -> NDArray[np.float64]:
    """Cut the surface by the half-plane at ``angle_rad``: segments (S, 2, 2) of (radius, z).

    The cut of a closed surface is a set of closed outlines, open only at the axis.
    """
    cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
    x, y, z = part.vertices_m.T
    across = (y * cosine - x * sine)[part.triangles]
    corners = np.stack([x * cosine + y * sine, z], axis=-1)[part.triangles]
    above = across > 0
    crossed = above.any(axis=1) & ~above.all(axis=1)
    across, corners, above = across[crossed], corners[crossed], above[crossed]
    # The corner that is alone on its side is the start of both crossed edges.
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    index = np.arange(len(alone))
    ends = []
    for step in (1, 2):
        other = (alone + step) % 3
        t = across[index, alone] / (across[index, alone] - across[index, other])
        ends.append(
            corners[index, alone] + t[:, None] * (corners[index, other] - corners[index, alone])
        )
    segments = np.stack(ends, axis=1)
    return _clip_to_half_plane(segments)


def _clip_to_half_plane(segments: NDArray[np.float64]) -> NDArray[np.float64]:
    """Keep what has a positive radius."""
    radius = segments[..., 0]
    segments = segments[(radius > 0).any(axis=1)]
    first, second = segments[:, 0].copy(), segments[:, 1].copy()
    for near, far in ((first, second), (second, first)):
        out = near[:, 0] < 0
        t = near[out, 0] / (near[out, 0] - far[out, 0])
        near[out] += t[:, None] * (far[out] - near[out])
    return np.stack([first, second], axis=1)


def meridian_distance(
    segments: NDArray[np.float64], radius_m: NDArray[np.float64], z_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the signed distance, shape (R, Z), of the grid ``radius_m`` (R,) x ``z_m`` (Z,).

    Negative inside, by the parity of crossings on the way outwards.
    """
    squared = np.full((len(radius_m), len(z_m)), np.inf)
    crossings = np.zeros(squared.shape, np.int64)
    for (r0, z0), (r1, z1) in segments.tolist():
        dr, dz = r1 - r0, z1 - z0
        length2 = dr * dr + dz * dz
        pr, pz = radius_m[:, None] - r0, z_m[None] - z0
        t = np.clip((pr * dr + pz * dz) / length2, 0, 1) if length2 > 0 else np.zeros_like(pr + pz)
        np.minimum(squared, (pr - t * dr) ** 2 + (pz - t * dz) ** 2, out=squared)
        spanned = np.flatnonzero((z0 <= z_m) != (z1 <= z_m))
        at = r0 + (z_m[spanned] - z0) / (dz if dz else 1.0) * dr
        crossings[:, spanned] += radius_m[:, None] < at
    distance_m = np.sqrt(squared)
    return np.asarray(np.where(crossings % 2 == 1, -distance_m, distance_m), np.float64)
