"""Keeping what lies in a box."""

import numpy as np
from numpy.typing import NDArray

from hal import Transform

__all__ = ["crop_box"]


def crop_box(
    points_m: NDArray[np.floating],
    T_camera_box: Transform,
    *,
    low_m: tuple[float, float, float],
    high_m: tuple[float, float, float],
) -> NDArray[np.bool_]:
    """Return which points (N, 3), frame ``camera``, lie between two corners in the box's frame.

    NaN points do not.

    Examples
    --------
    >>> T_camera_box = Transform.from_translation("camera", "box", (0, 0, 1))
    >>> points = np.array([[0, 0, 1.0], [0, 0, 0.5], [np.nan, 0, 1]])
    >>> crop_box(points, T_camera_box, low_m=(-1, -1, -0.1), high_m=(1, 1, 0.1)).tolist()
    [True, False, False]
    """
    local = T_camera_box.inverse().apply(points_m)
    return np.asarray(((local > np.array(low_m)) & (local < np.array(high_m))).all(axis=-1))
