"""From pieces of surface to the axes of the turned parts whose sides they could be.

The normals of a turned surface avoid its axis, so the axis is the direction in which they
scatter least. Stepping back from each point along its normal by the right radius meets the axis;
the radii to try are the part's own. A robust fit of the bare tube (all the part's radii, no
ends) then makes the line exact enough to look along it for the ends.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.parts import Profile
from perception.pose.lsq import refine, to_object
from perception.pose.surface import Surface

__all__ = ["Tube", "TubeField", "axis_frame", "distinct_radii", "find_tubes"]

POINTS_PER_PIECE = 110
SAME_RADIUS_M = 0.0004
MIN_AREA_SHARE = 0.04
FIT_SCALES_M = (0.003, 0.0015)
FIT_ITERATIONS = 4
AGREES_M = 0.0012
AGREEING_SHARE = 0.7
OVERHANG_M = 0.004
MIN_POINTS = 25
LONG = 1.6


@dataclass(frozen=True, eq=False)
class Tube:
    """An axis with the pieces on it.

    ``pose`` (4, 4): frame with z along the axis, in ``camera``. ``pieces`` are labels;
    ``span_m`` is where along z they reach. ``residual_m`` is the root of the mean Tukey loss.
    """

    pose: NDArray[np.float64]
    pieces: tuple[int, ...]
    span_m: tuple[float, float]
    residual_m: float


@dataclass(frozen=True, eq=False)
class TubeField:
    """Distance to the nearest of endless cylinders about z; ``radii_m`` (K,), rising."""

    radii_m: NDArray[np.float64]
    half_length_m: float = np.inf

    @property
    def radius_m(self) -> float:
        """The largest radius."""
        return float(self.radii_m[-1])

    def distance(self, points_m: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the signed distance to the nearest cylinder at points (..., 3)."""
        rho = np.sqrt(points_m[..., 0] ** 2 + points_m[..., 1] ** 2)
        return np.asarray(rho - self._nearest(rho))

    def sample(
        self, points_m: NDArray[np.floating]
    ) -> tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.bool_]]:
        """Return distance, gradient, and True everywhere."""
        rho = np.sqrt(points_m[..., 0] ** 2 + points_m[..., 1] ** 2)
        gradient = points_m / np.maximum(rho, 1e-9)[..., None]
        gradient[..., 2] = 0
        return rho - self._nearest(rho), gradient, np.ones(rho.shape, bool)

    def _nearest(self, rho: NDArray[np.floating]) -> NDArray[np.floating]:
        between = (self.radii_m[1:] + self.radii_m[:-1]) / 2
        return self.radii_m[np.searchsorted(between, rho)].astype(rho.dtype)


def distinct_radii(profile: Profile, most: int = 5) -> NDArray[np.float64]:
    """Return the radii that make up the outline, rising; the ``most`` with the largest area."""
    order = np.argsort(profile.radii_m, kind="stable")
    groups: list[list[int]] = []
    for k in order.tolist():
        if groups and profile.radii_m[k] - profile.radii_m[groups[-1][0]] < SAME_RADIUS_M:
            groups[-1].append(k)
        else:
            groups.append([k])
    areas = [float((profile.radii_m[g] * profile.lengths_m[g]).sum()) for g in groups]
    means = [float(np.average(profile.radii_m[g], weights=profile.lengths_m[g])) for g in groups]
    ranked = np.argsort(areas, kind="stable")[::-1][:most].tolist()
    kept = sorted(k for k in ranked if areas[k] >= MIN_AREA_SHARE * sum(areas))
    return np.array([means[k] for k in kept])


def axis_frame(axis: NDArray[np.floating], origin_m: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return a (4, 4) pose at ``origin_m`` whose z is ``axis``; x is chosen, always the same."""
    z = np.asarray(axis, float) / np.linalg.norm(axis)
    x = np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    pose[:3, 3] = origin_m
    return pose


def find_tubes(
    surface: Surface,
    labels: NDArray[np.int32],
    profile: Profile,
    *,
    rng: np.random.Generator,
) -> list[Tube]:
    """Fit a tube to each piece, join those that lie on one, and fit again."""
    radii_m = distinct_radii(profile)
    length_m = float(profile.z_edges_m[-1] - profile.z_edges_m[0])
    points, normals = sample_pieces(surface, labels, POINTS_PER_PIECE, rng)
    starts, owners = [], []
    for k in range(len(points)):
        for pose in _first_axes(points[k], normals[k], radii_m):
            starts.append(pose)
            owners.append(k)
    if not starts:
        return []
    owner = np.array(owners)
    field = TubeField(radii_m)
    padded, weights = pad(points)
    fit = refine(
        field, padded[owner], weights[owner], np.array(starts),
        scales_m=FIT_SCALES_M, iterations=FIT_ITERATIONS,
    )  # fmt: skip
    best = [
        int(candidates[np.argmin(fit.losses_m2[candidates])])
        for k in range(len(points))
        if len(candidates := np.flatnonzero(owner == k))
    ]
    poses = fit.poses[best]
    pieces = [points[int(k)] for k in owner[best]]
    groups = _join(poses, pieces, field, length_m)
    joined = [_even(np.concatenate([pieces[k] for k in g]), 2 * POINTS_PER_PIECE) for g in groups]
    padded, weights = pad(joined)
    fit = refine(
        field, padded, weights, poses[[g[0] for g in groups]],
        scales_m=FIT_SCALES_M, iterations=FIT_ITERATIONS,
    )  # fmt: skip
    tubes = []
    for k, group in enumerate(groups):
        along = to_object(joined[k][None], fit.poses[k : k + 1])[0, :, 2]
        tubes.append(
            Tube(
                fit.poses[k],
                tuple(int(owner[best[g]]) + 1 for g in group),
                _extent(along),
                float(np.sqrt(fit.losses_m2[k])),
            )
        )
    return tubes


def sample_pieces(
    surface: Surface, labels: NDArray[np.int32], most: int, rng: np.random.Generator
) -> tuple[list[NDArray[np.float64]], list[NDArray[np.float64]]]:
    """Return points and normals of each piece, at most ``most`` of them, drawn at random."""
    flat = labels.ravel()
    order = np.argsort(flat, kind="stable")
    edges = np.searchsorted(flat[order], np.arange(1, int(labels.max()) + 2))
    points, normals = [], []
    for start, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        index = order[start:end]
        if len(index) > most:
            index = np.sort(rng.choice(index, most, replace=False))
        points.append(surface.points_m.reshape(-1, 3)[index].astype(np.float64))
        normals.append(surface.normals.reshape(-1, 3)[index].astype(np.float64))
    return points, normals


def pad(
    clouds: list[NDArray[np.float64]],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Stack clouds (n, 3) of unequal size: points (H, N, 3) and weights (H, N), 0 for padding."""
    most = max((len(cloud) for cloud in clouds), default=0)
    points = np.zeros((len(clouds), most, 3))
    weights = np.zeros((len(clouds), most))
    for k, cloud in enumerate(clouds):
        points[k, : len(cloud)] = cloud
        weights[k, : len(cloud)] = 1
    return points, weights


def _first_axes(
    points: NDArray[np.float64], normals: NDArray[np.float64], radii_m: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """Return a pose for each radius that the piece could have."""
    if len(points) < MIN_POINTS:
        return []
    _, vectors = np.linalg.eigh(np.einsum("ni,nj->ij", normals, normals))
    axes = [vectors[:, 0]]
    off = points - points.mean(axis=0)
    spread, directions = np.linalg.eigh(np.einsum("ni,nj->ij", off, off))
    # A long piece also shows its axis by its shape, and shoulders do not disturb that.
    if spread[2] > LONG**2 * spread[1]:
        axes.append(directions[:, 2])
    poses = []
    for axis in axes:
        frame = axis_frame(axis, np.zeros(3))
        across = np.einsum("ni,ij->nj", points, frame[:3, :2])
        outward = np.einsum("ni,ij->nj", normals, frame[:3, :2])
        along = float(np.median(np.einsum("ni,i->n", points, frame[:3, 2])))
        for radius_m in radii_m.tolist():
            centre = np.median(across - radius_m * outward, axis=0)
            poses.append(axis_frame(axis, frame[:3, :3] @ [*centre, along]))
    return poses


def _join(
    poses: NDArray[np.float64],
    pieces: list[NDArray[np.float64]],
    field: TubeField,
    length_m: float,
) -> list[list[int]]:
    """Group pieces that lie on one tube and together are no longer than the part."""
    groups: list[list[int]] = []
    spans: list[tuple[float, float]] = []
    for k, piece in enumerate(pieces):
        if groups:
            heads = poses[[group[0] for group in groups]]
            local = to_object(np.broadcast_to(piece, (len(heads), *piece.shape)), heads)
            agrees = (np.abs(field.distance(local)) < AGREES_M).mean(axis=1)
            for g in np.flatnonzero(agrees > AGREEING_SHARE).tolist():
                low, high = _extent(local[g, :, 2])
                low, high = min(spans[g][0], low), max(spans[g][1], high)
                if high - low < length_m + OVERHANG_M:
                    groups[g].append(k)
                    spans[g] = (low, high)
                    break
            else:
                groups.append([k])
                spans.append(_extent(to_object(piece[None], poses[k : k + 1])[0, :, 2]))
        else:
            groups.append([k])
            spans.append(_extent(to_object(piece[None], poses[k : k + 1])[0, :, 2]))
    return groups


def _extent(along_m: NDArray[np.floating]) -> tuple[float, float]:
    """Where a piece begins and ends along the axis, a hundredth at each end left out."""
    ordered = np.sort(along_m)
    cut = len(ordered) // 100
    return float(ordered[cut]), float(ordered[len(ordered) - 1 - cut])


def _even(points: NDArray[np.float64], most: int) -> NDArray[np.float64]:
    """Keep at most ``most`` points, evenly spread over the list."""
    if len(points) <= most:
        return points
    return np.asarray(points[np.linspace(0, len(points) - 1, most).astype(int)])
