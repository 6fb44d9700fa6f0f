"""Moving least squares: equations (12) to (14)."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from perception.cloud.normals import plane_normals

__all__ = ["smooth_surface"]

RIDGE = 1e-9


def smooth_surface(
    points_m: NDArray[np.floating], *, radius_m: float, neighbours: int = 40
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Move each point onto a quadric fitted to its surroundings.

    In the frame of the local plane the height is fitted by a1 + a2 x + a3 y + a4 x^2 + a5 xy +
    a6 y^2 (12), minimising the weighted squares (13) with weights exp(-(h/eta)^2), eta half the
    radius, and zero beyond the radius (14; printed with a fixed limit of 0.015). The point moves
    to the quadric along the plane's normal. The printed basis lists x, y twice; it is taken as
    the full quadratic.

    Parameters
    ----------
    points_m
        Shape (N, 3), finite, metres.
    radius_m
        Of the neighbourhood.
    neighbours
        At most this many, the nearest.

    Returns
    -------
    points_m, normals
        Both (N, 3), float64; normals of the quadric, towards the origin. A point with fewer than
        six neighbours stays and has its plane's normal.

    Raises
    ------
    ValueError
        The radius is not positive, or the points are too few or not finite.
    """
    if not radius_m > 0:
        raise ValueError(f"a radius of {radius_m:g} m")
    points = np.asarray(points_m, np.float64)
    normals = plane_normals(points, neighbours=neighbours)
    first, second = _tangents(normals)
    count = min(neighbours, len(points))
    distance, index = cKDTree(points).query(points, k=count, distance_upper_bound=radius_m)
    is_near = np.isfinite(distance)
    off = points[np.where(is_near, index, 0)] - points[:, None]
    # In units of the radius, so that one ridge fits every scale.
    x, y, height = (
        np.einsum("nkj,nj->nk", off, axis) / radius_m for axis in (first, second, normals)
    )
    weight = np.where(is_near, np.exp(-((np.where(is_near, distance, 0) * 2 / radius_m) ** 2)), 0)
    basis = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    normal_matrix = np.einsum("nk,nki,nkj->nij", weight, basis, basis) + RIDGE * np.eye(6)
    right = np.einsum("nk,nki,nk->ni", weight, basis, height)
    fit = np.linalg.solve(normal_matrix, right[..., None])[..., 0]
    fit[is_near.sum(axis=1) < 6] = 0
    moved = points + (fit[:, 0] * radius_m)[:, None] * normals
    tilted = normals - fit[:, 1:2] * first - fit[:, 2:3] * second
    return moved, tilted / np.linalg.norm(tilted, axis=1, keepdims=True)


def _tangents(normals: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two unit vectors (N, 3) that span each plane."""
    helper = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(helper, normals)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(normals, first)
