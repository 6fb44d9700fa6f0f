"""Normals of planes fitted to neighbourhoods: equations (15) to (21)."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

__all__ = ["plane_normals"]


def plane_normals(
    points_m: NDArray[np.floating],
    *,
    neighbours: int = 20,
    eye_m: NDArray[np.floating] | None = None,
) -> NDArray[np.float64]:
    """Return unit normals (N, 3) towards ``eye_m`` (the origin: the camera).

    The plane through a point's nearest ``neighbours`` (15) that minimises the squared distances
    (16) under a unit normal (17; its constraint is printed with d for c) goes through their
    centroid (18-20) and has as normal the eigenvector of the smallest eigenvalue of their
    scatter (21).

    Raises
    ------
    ValueError
        Fewer than three points are there, or some are not finite.
    """
    points = np.asarray(points_m, np.float64)
    if len(points) < 3 or not np.isfinite(points).all():
        raise ValueError("normals need at least three finite points")
    _, index = cKDTree(points).query(points, k=min(max(neighbours, 3), len(points)))
    off = points[index] - points[index].mean(axis=1, keepdims=True)
    scatter = np.einsum("nki,nkj->nij", off, off)
    normals = np.linalg.eigh(scatter)[1][..., 0]
    eye = np.zeros(3) if eye_m is None else np.asarray(eye_m, np.float64)
    away = ((eye - points) * normals).sum(axis=1) < 0
    normals[away] *= -1
    return np.asarray(normals)
