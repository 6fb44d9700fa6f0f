"""Thinning a cloud on a voxel grid: equations (3) and (4)."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["thin_out"]

MOST_CELLS = 2**62


def thin_out(points_m: NDArray[np.floating], *, edge_m: float) -> NDArray[np.float64]:
    """Replace the points of each voxel by their centroid.

    Equation (3) gives the box of the cloud, h = max - min on each axis. Equation (4) is printed
    as |h - r|, rounded down; a difference of lengths is no count, so the number of voxels is
    taken as floor(h / r) + 1, with r the voxel's edge, and a point's voxel as
    floor((p - min) / r). Voxels are taken in rising order of z, y, x index.

    Parameters
    ----------
    points_m
        Shape (N, 3), metres; points with NaN are left out.
    edge_m
        The voxel's edge, metres.

    Returns
    -------
    centroids_m
        Shape (M, 3), float64, M <= N.

    Raises
    ------
    ValueError
        The edge is not positive, or too small to number the voxels.

    Examples
    --------
    >>> thin_out(np.array([[0, 0, 0], [0.2, 0, 0], [1.5, 0, 0]]), edge_m=1.0).tolist()
    [[0.1, 0.0, 0.0], [1.5, 0.0, 0.0]]
    """
    if not edge_m > 0:
        raise ValueError(f"a voxel of edge {edge_m:g} m")
    points = np.asarray(points_m, np.float64)
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return points
    low = points.min(axis=0)
    counts = np.floor((points.max(axis=0) - low) / edge_m) + 1
    if counts.prod() > MOST_CELLS:
        raise ValueError(f"voxels of {edge_m:g} m are too many to number")
    cell = np.floor((points - low) / edge_m).astype(np.int64)
    nx, ny = int(counts[0]), int(counts[1])
    key = cell[:, 0] + nx * (cell[:, 1] + ny * cell[:, 2])
    _, owner, members = np.unique(key, return_inverse=True, return_counts=True)
    sums = [np.bincount(owner, weights=points[:, k]) for k in range(3)]
    return np.stack(sums, axis=1) / members[:, None]
