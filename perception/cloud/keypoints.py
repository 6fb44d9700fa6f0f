"""Keypoints by how much the surface sticks out: equations (9) to (11)."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

__all__ = ["find_keypoints", "protrusion"]


def protrusion(points_m: NDArray[np.floating], *, neighbours: int = 24) -> NDArray[np.float64]:
    """Return the protrusion feature Atc (N,) of points (N, 3).

    The unit vectors from a point's neighbours to it have the mean f (9): short on a plane, long
    at an edge or a tip. The least cosine between f and one of them is the taper c (10), near one
    for a sharp cone. Atc = |f| e^c (11).

    Raises
    ------
    ValueError
        There are no more points than ``neighbours``, or some are not finite.
    """
    points = np.asarray(points_m, np.float64)
    if len(points) <= neighbours or not np.isfinite(points).all():
        raise ValueError(f"{len(points)} points, all finite, must outnumber {neighbours}")
    _, index = cKDTree(points).query(points, k=neighbours + 1)
    away = points[:, None] - points[index[:, 1:]]
    length = np.linalg.norm(away, axis=2, keepdims=True)
    # A twin at the same place points nowhere.
    away = np.divide(away, length, out=np.zeros_like(away), where=length > 0)
    mean = away.mean(axis=1)
    size = np.linalg.norm(mean, axis=1)
    direction = mean / np.maximum(size, 1e-12)[:, None]
    taper = np.einsum("nkj,nj->nk", away, direction).min(axis=1)
    return np.asarray(size * np.exp(taper))


def find_keypoints(
    points_m: NDArray[np.floating],
    *,
    radius_m: float,
    neighbours: int = 24,
    deviations: float = 1.0,
) -> NDArray[np.int64]:
    """Return the indices of keypoints, rising.

    A keypoint has the largest feature within ``radius_m`` (the local view) and more than the
    mean plus ``deviations`` standard deviations of the cloud (the global view).
    """
    feature = protrusion(points_m, neighbours=neighbours)
    points = np.asarray(points_m, np.float64)
    strong = np.flatnonzero(feature > feature.mean() + deviations * feature.std())
    kept: list[int] = []
    tree = cKDTree(points[strong]) if len(strong) else None
    taken = np.zeros(len(strong), bool)
    for k in np.argsort(-feature[strong], kind="stable").tolist():
        if tree is None or taken[k]:
            continue
        kept.append(int(strong[k]))
        taken[tree.query_ball_point(points[strong[k]], radius_m)] = True
    return np.array(sorted(kept), np.int64)
