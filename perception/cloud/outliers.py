"""Statistical outlier removal: equations (5) to (8)."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

__all__ = ["remove_outliers"]


def remove_outliers(
    points_m: NDArray[np.floating], *, neighbours: int = 16, deviations: float = 2.0
) -> NDArray[np.bool_]:
    """Return which points (N, 3) have their neighbours at a usual distance.

    For each point the distances (5) to its nearest ``neighbours`` are averaged. The averages of
    all points have the mean (6) and standard deviation (7); a point stays while its average is
    within ``deviations`` of them of the mean. Equation (8) prints the limit as the number of
    neighbours times the number of deviations, which would keep everything, and cuts on both
    sides; here the limit is the deviations alone, and being near to one's neighbours is no fault.

    Points with NaN are outliers.

    Raises
    ------
    ValueError
        Fewer than one neighbour is asked for.
    """
    if neighbours < 1:
        raise ValueError(f"{neighbours} neighbours")
    points = np.asarray(points_m, np.float64)
    kept = np.asarray(np.isfinite(points).all(axis=1))
    if kept.sum() <= neighbours:
        return kept
    finite = points[kept]
    distances, _ = cKDTree(finite).query(finite, k=neighbours + 1)
    average = distances[:, 1:].mean(axis=1)
    kept[kept] = average <= average.mean() + deviations * average.std()
    return kept
