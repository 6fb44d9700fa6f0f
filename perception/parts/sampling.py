"""Points spread evenly over a mesh, the same every time."""

import numpy as np
from numpy.typing import NDArray

from perception.parts.solid import triangle_normals

__all__ = ["sample_surface"]

# The plastic number's powers: Roberts' low-discrepancy sequence in the plane.
STEP_U, STEP_V = 0.7548776662466927, 0.5698402909980532
GOLDEN = 0.6180339887498949


def sample_surface(
    vertices_m: NDArray[np.float64], triangles: NDArray[np.integer], count: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return ``count`` points (count, 3) and the triangle of each (count,), even by area.

    No random numbers: equal steps over the cumulated area, and a low-discrepancy sequence that
    starts afresh in each triangle, elsewhere in each.
    """
    _, areas = triangle_normals(vertices_m, triangles)
    cumulated = np.cumsum(areas)
    steps = (np.arange(count) + 0.5) / count * cumulated[-1]
    owner = np.minimum(np.searchsorted(cumulated, steps), len(areas) - 1)
    rank = np.arange(count) - np.searchsorted(owner, owner)
    u = (STEP_U * rank + 0.5 + GOLDEN * owner) % 1
    v = (STEP_V * rank + 0.5 + GOLDEN**2 * owner) % 1
    beyond = u + v > 1
    u, v = np.where(beyond, 1 - u, u)[:, None], np.where(beyond, 1 - v, v)[:, None]
    a, b, c = np.moveaxis(vertices_m[triangles[owner]], 1, 0)
    return a + u * (b - a) + v * (c - a), owner
