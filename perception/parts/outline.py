"""The outer outline of a mesh about its z axis, as stacked cylinders."""

import numpy as np
from numpy.typing import NDArray

from perception.parts.part import Profile

__all__ = ["outer_profile"]

STEP_M = 0.00025
FLAT_M = 0.00015
MAX_SECTIONS = 24
SLIVER_M = 0.0011


def outer_profile(vertices_m: NDArray[np.float64], triangles: NDArray[np.integer]) -> Profile:
    """Describe the outside by cylinders: radius within 0.15 mm, or at most 24 sections.

    The radius at a height is the largest over the triangles that reach it. Steps stand within
    0.02 mm; a cone becomes a stair; chamfers and grooves of less than 1.1 mm are left out.
    """
    low, high = float(vertices_m[:, 2].min()), float(vertices_m[:, 2].max())
    # A step lies at a vertex: cut there, and finely between.
    levels = np.unique(np.round(vertices_m[:, 2], 5))
    count = max(int(np.ceil((high - low) / STEP_M)), 4)
    edges_m = np.concatenate([np.linspace(low, high, count + 1), levels])
    edges_m = np.unique(np.clip(np.round(edges_m, 6), low, high))
    edges_m = edges_m[np.concatenate([[True], np.diff(edges_m) > 1e-5])]
    edges_m[0], edges_m[-1] = low, high
    middles_m = (edges_m[1:] + edges_m[:-1]) / 2
    radii_m = _radius_at(vertices_m, triangles, middles_m)
    kept = radii_m > 0
    edges = np.concatenate([edges_m[:-1][kept], [high]])
    return _merge(edges, radii_m[kept])


def _radius_at(
    vertices_m: NDArray[np.float64], triangles: NDArray[np.integer], levels_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the largest radius of the surface at each level, from the edges that cross it."""
    rings = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    rings = np.unique(np.sort(rings, axis=1), axis=0)
    a, b = vertices_m[rings[:, 0]], vertices_m[rings[:, 1]]
    swap = a[:, 2] > b[:, 2]
    a[swap], b[swap] = b[swap], a[swap].copy()
    first = np.searchsorted(levels_m, a[:, 2])
    last = np.searchsorted(levels_m, b[:, 2])
    radii_m = np.zeros(len(levels_m))
    crossing = last - first
    owner = np.repeat(np.arange(len(a)), crossing)
    level = np.arange(crossing.sum()) - np.repeat(np.cumsum(crossing) - crossing, crossing)
    level += first[owner]
    t = (levels_m[level] - a[owner, 2]) / (b[owner, 2] - a[owner, 2])
    x, y = ((a[owner, k] + t * (b[owner, k] - a[owner, k])) for k in range(2))
    np.maximum.at(radii_m, level, np.hypot(x, y))
    return radii_m


def _merge(edges_m: NDArray[np.float64], radii_m: NDArray[np.float64]) -> Profile:
    """Join neighbours of like radius; widen the likeness until few enough are left."""
    flat_m = FLAT_M
    while True:
        starts = [0]
        for k in range(1, len(radii_m)):
            run = radii_m[starts[-1] : k + 1]
            if run.max() - run.min() > flat_m:
                starts.append(k)
        if len(starts) <= MAX_SECTIONS:
            break
        flat_m *= 1.5
    ends = [*starts[1:], len(radii_m)]
    lengths = np.diff(edges_m)
    means = [
        float(np.average(radii_m[a:b], weights=lengths[a:b]))
        for a, b in zip(starts, ends, strict=True)
    ]
    return _without_slivers([*edges_m[starts].tolist(), float(edges_m[-1])], means)


def _without_slivers(edges_m: list[float], radii_m: list[float]) -> Profile:
    """Give sections too short to matter (chamfers, grooves) to the neighbour most like them."""
    while len(radii_m) > 1:
        lengths = np.diff(edges_m)
        k = int(np.argmin(lengths))
        if lengths[k] >= SLIVER_M:
            break
        below = abs(radii_m[k] - radii_m[k - 1]) if k > 0 else np.inf
        above = abs(radii_m[k] - radii_m[k + 1]) if k + 1 < len(radii_m) else np.inf
        del radii_m[k]
        del edges_m[k if below <= above else k + 1]  # the edge towards that neighbour
    return Profile(np.array(edges_m), np.array(radii_m))
