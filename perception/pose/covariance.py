"""How well a pose is known: covariance of a fit, and the directions that nothing holds."""

import numpy as np
from numpy.typing import NDArray

from perception.parts import Part
from perception.pose.surface import Surface

__all__ = ["DIRECTIONS", "pose_covariance"]

DIRECTIONS = (
    "rotation x", "rotation y", "rotation z", "translation x", "translation y", "translation z",
)  # fmt: skip
# Worse than this is as good as unknown: a tenth of a turn, or a part's length.
UNKNOWN_RAD = 0.6
UNKNOWN_M = 0.05
CORRELATION_PX = 3.5
# Smoothing over a curved surface and sub-pixel matching leave this much that no average removes.
BIAS_M = 0.00004


def pose_covariance(
    normal_matrix: NDArray[np.float64],
    part: Part,
    surface: Surface,
    *,
    residual_m: float,
    pixels_per_point: float,
    axial_sigma_m: float | None = None,
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Return the covariance (6, 6) of the twist and the names of its unobservable directions.

    ``normal_matrix`` is J'WJ. White noise of ``residual_m`` would give residual^2 (J'WJ)^-1;
    stereo noise is alike within a matching window, so n points are worth n / (4 pi s^2 / a)
    where s is the correlation's sigma in pixels and a the pixels a point stands for. The place
    along the axis of a turned part comes from its edges (``axial_sigma_m``), not from the fit.
    """
    inflation = max(4 * np.pi * CORRELATION_PX**2 / pixels_per_point, 1.0)
    variance = max(residual_m, 0.2 * surface.noise_m, 1e-6) ** 2 * inflation
    unknown = [2] if part.fold == 0 else []
    limits = np.array([UNKNOWN_RAD] * 3 + [UNKNOWN_M] * 3) ** 2
    while True:
        kept = [k for k in range(6) if k not in unknown]
        known = np.linalg.pinv(normal_matrix[np.ix_(kept, kept)], rcond=1e-12) * variance
        over = [k for k, value in zip(kept, np.diag(known), strict=True) if not value < limits[k]]
        if not over or len(unknown) + len(over) >= 6:
            break
        unknown += over
    covariance = np.zeros((6, 6))
    covariance[np.ix_(kept, kept)] = (known + known.T) / 2
    if axial_sigma_m is not None:
        covariance[5, :] = covariance[:, 5] = 0.0
        covariance[5, 5] = axial_sigma_m**2
        unknown = [k for k in unknown if k != 5]
    seen = [k for k in (3, 4, 5) if k not in unknown]
    covariance[seen, seen] += BIAS_M**2
    covariance[unknown, unknown] = np.inf
    return covariance, tuple(DIRECTIONS[k] for k in sorted(unknown))
