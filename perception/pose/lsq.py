"""Robust least squares of many poses at once: Levenberg-Marquardt on a signed distance field.

For a scene point p (camera) and a pose T: X = R'(p - t), residual d = sdf(X), and a step on the
right, T <- T exp(xi) with xi = (w, v), moves X by -(v + w x X), hence J = [(g x X)', -g'].
Tukey's loss with scale c is minimised; a step is kept only when the loss falls.

Sums run in einsum, not in BLAS, whose order of summation depends on its threads.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.pose.field import Field

__all__ = ["Fit", "refine", "rotations", "to_object"]

FIRST_DAMPING = 1e-4
STILL_M = 2e-6
STILL_RAD = 2e-5
# An unobservable direction (a shaft's roll) must not make the system singular.
RIDGE = 1e-9


@dataclass(frozen=True, eq=False)
class Fit:
    """``poses`` (H, 4, 4), the mean Tukey loss (H,) in square metres, and J'WJ (H, 6, 6)."""

    poses: NDArray[np.float64]
    losses_m2: NDArray[np.float64]
    normal_matrices: NDArray[np.float64]


def rotations(rotvecs_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rodrigues for many: (..., 3) rotation vectors to (..., 3, 3)."""
    angle = np.sqrt((rotvecs_rad**2).sum(axis=-1))[..., None, None]
    x, y, z = np.moveaxis(rotvecs_rad, -1, 0)
    skew = np.zeros((*rotvecs_rad.shape[:-1], 3, 3))
    skew[..., 0, 1], skew[..., 0, 2], skew[..., 1, 2] = -z, y, -x
    skew[..., 1, 0], skew[..., 2, 0], skew[..., 2, 1] = z, -y, x
    small = np.maximum(angle, 1e-12)
    first = np.where(angle < 1e-12, 1.0, np.sin(small) / small)
    second = np.where(angle < 1e-12, 0.5, (1 - np.cos(small)) / small**2)
    squared = np.einsum("...ij,...jk->...ik", skew, skew)
    return np.asarray(np.eye(3) + first * skew + second * squared)


def to_object(points_m: NDArray[np.floating], poses: NDArray[np.floating]) -> NDArray[np.floating]:
    """Take camera points (H, N, 3) into the object frames of poses (H, 4, 4)."""
    d = points_m - poses[:, None, :3, 3]
    r = poses[:, None, :3, :3]
    out = np.empty_like(d)
    for k in range(3):
        out[..., k] = d[..., 0] * r[..., 0, k] + d[..., 1] * r[..., 1, k] + d[..., 2] * r[..., 2, k]
    return out


def refine(
    field: Field,
    points_m: NDArray[np.floating],
    weights: NDArray[np.floating],
    poses: NDArray[np.float64],
    *,
    scales_m: Sequence[float],
    iterations: int,
) -> Fit:
    """Fit each pose to its points.

    Parameters
    ----------
    field
        The part's signed distance.
    points_m
        Shape (H, N, 3), frame ``camera``, metres.
    weights
        Shape (H, N); 0 for padding.
    poses
        Shape (H, 4, 4), T_camera_object to start from.
    scales_m
        Tukey's scale, from coarse to fine.
    iterations
        At most, at each scale.
    """
    poses = np.array(poses, np.float64)
    fit = Fit(poses, np.full(len(poses), np.inf), np.zeros((len(poses), 6, 6)))
    if not len(poses):
        return fit
    for scale_m in scales_m:
        fit = _refine_at(field, points_m, weights, fit.poses, scale_m, iterations)
    return fit


@dataclass(eq=False)
class _State:
    """Loss, J'WJ and J'Wd of every pose."""

    losses_m2: NDArray[np.float64]
    normal: NDArray[np.float64]
    gradient: NDArray[np.float64]


def _refine_at(
    field: Field,
    points_m: NDArray[np.floating],
    weights: NDArray[np.floating],
    poses: NDArray[np.float64],
    scale_m: float,
    iterations: int,
) -> Fit:
    poses = poses.copy()
    state = _linearise(field, points_m, weights, poses, scale_m)
    damping = np.full(len(poses), FIRST_DAMPING)
    moving = np.ones(len(poses), bool)
    for _ in range(iterations):
        index = np.flatnonzero(moving)
        if not len(index):
            break
        steps = _twists(state.normal[index], state.gradient[index], damping[index])
        trial = _moved(poses[index], steps)
        new = _linearise(field, points_m[index], weights[index], trial, scale_m)
        better = new.losses_m2 < state.losses_m2[index]
        taken = index[better]
        poses[taken] = trial[better]
        state.losses_m2[taken] = new.losses_m2[better]
        state.normal[taken] = new.normal[better]
        state.gradient[taken] = new.gradient[better]
        damping[index] = np.where(better, damping[index] / 5, damping[index] * 8)
        is_still = (np.abs(steps[:, :3]).max(axis=1) < STILL_RAD) & (
            np.abs(steps[:, 3:]).max(axis=1) < STILL_M
        )
        moving[index] = ~is_still & (damping[index] < 1e4)
    return Fit(poses, state.losses_m2, state.normal)


def _linearise(
    field: Field,
    points_m: NDArray[np.floating],
    weights: NDArray[np.floating],
    poses: NDArray[np.float64],
    scale_m: float,
) -> _State:
    X = to_object(points_m, poses.astype(points_m.dtype))
    d, g, is_inside = field.sample(X)
    share = np.where(is_inside, np.minimum((d / scale_m) ** 2, 1), 1)
    total = np.maximum(weights.sum(axis=1, dtype=np.float64), 1e-12)
    losses = scale_m**2 / 6 * (weights * (1 - (1 - share) ** 3)).sum(axis=1, dtype=np.float64)
    J = np.empty((*d.shape, 6), d.dtype)
    J[..., 0] = g[..., 1] * X[..., 2] - g[..., 2] * X[..., 1]
    J[..., 1] = g[..., 2] * X[..., 0] - g[..., 0] * X[..., 2]
    J[..., 2] = g[..., 0] * X[..., 1] - g[..., 1] * X[..., 0]
    J[..., 3:] = -g
    w = weights * (1 - share) ** 2
    WJ = J * w[..., None]
    normal = np.einsum("hni,hnj->hij", WJ, J).astype(np.float64)
    gradient = np.einsum("hni,hn->hi", WJ, d).astype(np.float64)
    return _State(losses / total, normal, gradient)


def _twists(
    normal: NDArray[np.float64], gradient: NDArray[np.float64], damping: NDArray[np.float64]
) -> NDArray[np.float64]:
    diagonal = np.einsum("hii->hi", normal)
    # Rotations in radians and shifts in metres: one ridge for each kind.
    mean = np.stack([diagonal[:, :3].mean(axis=1), diagonal[:, 3:].mean(axis=1)], axis=1)
    ridge = np.repeat(mean, 3, axis=1) * 1e-6 + RIDGE * 1e-3
    damped = normal + np.eye(6) * (damping[:, None] * diagonal + ridge)[:, None]
    steps = -np.linalg.solve(damped, gradient[..., None])[..., 0]
    # A step of more than half a radian or 20 mm is a sign of a singular system.
    size = np.maximum(
        np.abs(steps[:, :3]).max(axis=1) / 0.5, np.abs(steps[:, 3:]).max(axis=1) / 0.02
    )
    return np.asarray(steps / np.maximum(size, 1)[:, None])


def _moved(poses: NDArray[np.float64], steps: NDArray[np.float64]) -> NDArray[np.float64]:
    moved = poses.copy()
    turned = np.einsum("hij,hjk->hik", poses[:, :3, :3], rotations(steps[:, :3]))
    moved[:, :3, :3] = turned
    moved[:, :3, 3] += np.einsum("hij,hj->hi", poses[:, :3, :3], steps[:, 3:])
    return moved
