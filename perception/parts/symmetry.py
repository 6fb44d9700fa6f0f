"""Finding the axis of a part and what a turn about it leaves unchanged.

The axis of any rotational symmetry goes through the centroid and is an eigenvector of the second
moments of the solid and of its surface's normals. Each such direction is tried: turned copies of
points on the surface must lie on the surface again.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from perception.parts.sampling import sample_surface
from perception.parts.solid import solid_properties, triangle_normals

__all__ = ["Symmetry", "find_symmetry"]

PROBES = 400
DENSE = 40_000
NEIGHBOURS = 12
MAX_FOLD = 200
# A turned facet misses its neighbour by R (1 - cos(pi / facets)): 22 facets count as round.
ROUND_SHARE = 0.0105
FOLD_SHARE = 0.006
SLACK_M = 0.00002
# No turn of these is near a small fraction of a full one.
PLAIN_TURNS = 2 * np.pi * np.array([0.0271, 0.0833, 0.1511, 0.2237, 0.3049, 0.3761, 0.4409])


@dataclass(frozen=True, eq=False)
class Symmetry:
    """``rotation`` (3, 3) has the axis as its last column; ``origin_m`` (3,) lies on it.

    ``fold`` is 0 for a solid of revolution. Where ``is_reversible``, half a turn about the first
    column changes nothing either.
    """

    rotation: NDArray[np.float64]
    origin_m: NDArray[np.float64]
    fold: int
    is_reversible: bool


@dataclass(frozen=True, eq=False)
class _Probe:
    """Points on the surface about the centroid, and the surface to find them on again."""

    points_m: NDArray[np.float64]
    corners_m: NDArray[np.float64]
    owner: NDArray[np.int64]
    tree: cKDTree

    def misfit(self, turned_m: NDArray[np.float64]) -> float:
        """Return how far the turned points (N, 3) are off the surface: 98th percentile, metres."""
        count = len(self.owner)
        _, index = self.tree.query(turned_m, k=min(NEIGHBOURS, count))
        triangles = self.owner[np.asarray(index).reshape(len(turned_m), -1)]
        near = np.repeat(turned_m[:, None], triangles.shape[1], axis=1)
        distance = _to_triangles(near.reshape(-1, 3), self.corners_m[triangles.reshape(-1)])
        return float(np.percentile(distance.reshape(triangles.shape).min(axis=1), 98))


def find_symmetry(vertices_m: NDArray[np.float64], triangles: NDArray[np.integer]) -> Symmetry:
    """Return the axis with the highest symmetry.

    Raises
    ------
    ValueError
        There is none, or (a ball, a cube) there are several and no telling which.
    """
    solid = solid_properties(vertices_m, triangles)
    local_m = vertices_m - solid.centroid_m
    dense, owner = sample_surface(local_m, triangles, DENSE)
    points_m, _ = sample_surface(local_m, triangles, PROBES)
    probe = _Probe(points_m, local_m[triangles], owner, cKDTree(dense))
    found: list[tuple[int, NDArray[np.float64]]] = []
    smallest_m = np.inf
    for axis in _directions(local_m, triangles, solid.inertia_m5):
        fold, misfit_m = _fold(probe, axis)
        smallest_m = min(smallest_m, misfit_m)
        if fold != 1:
            found.append((fold, axis))
    if not found:
        raise ValueError(
            "no axis of symmetry: half a turn about the best one leaves "
            f"{smallest_m * 1000:.2g} mm between the surfaces"
        )
    rank = [np.inf if fold == 0 else fold for fold, _ in found]
    best = int(np.argmax(rank))
    if sum(r == rank[best] for r in rank) > 1 and rank[best] > 2:
        raise ValueError("more than one axis of symmetry of the same kind: no telling which it is")
    fold, axis = found[best]
    axis = axis if axis[np.argmax(np.abs(axis))] > 0 else -axis
    rotation, is_reversible = _reversal(probe, axis, fold)
    return Symmetry(rotation, solid.centroid_m, fold, is_reversible)


def _directions(
    local_m: NDArray[np.float64], triangles: NDArray[np.integer], inertia: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """Return the eigenvectors of both moments, each direction once."""
    normals, areas = triangle_normals(local_m, triangles)
    scatter = np.einsum("n,ni,nj->ij", areas, normals, normals)
    directions: list[NDArray[np.float64]] = []
    for moment in (inertia, scatter):
        for vector in np.linalg.eigh(moment)[1].T:
            if all(abs(float(vector @ other)) < 0.99999 for other in directions):
                directions.append(vector)
    return directions


def _turned(
    points_m: NDArray[np.float64], axis: NDArray[np.float64], angle_rad: float
) -> NDArray[np.float64]:
    along = np.outer(points_m @ axis, axis)
    across = points_m - along
    turned = np.cos(angle_rad) * across + np.sin(angle_rad) * np.cross(axis, points_m)
    return np.asarray(along + turned)


def _fold(probe: _Probe, axis: NDArray[np.float64]) -> tuple[int, float]:
    """Return 0 for revolution, the fold, or 1 for none; and the misfit of half a turn."""
    points = probe.points_m
    radius_m = float(np.linalg.norm(points - np.outer(points @ axis, axis), axis=1).max())
    limit_m = ROUND_SHARE * radius_m + SLACK_M
    if all(probe.misfit(_turned(points, axis, a)) < limit_m for a in PLAIN_TURNS.tolist()):
        return 0, 0.0
    limit_m = FOLD_SHARE * radius_m + SLACK_M
    fold, step = 1, 0.0
    # Every fold is a product of primes: each prime power that holds multiplies in.
    for prime in _primes(MAX_FOLD):
        power = prime
        while power <= MAX_FOLD and _holds(probe, axis, power, limit_m):
            fold, power = fold * prime, power * prime
    step = probe.misfit(_turned(points, axis, np.pi)) if fold == 1 else 0.0
    return fold, step


def _holds(probe: _Probe, axis: NDArray[np.float64], fold: int, limit_m: float) -> bool:
    """Whether turns by several multiples of 1/fold, large ones among them, change nothing."""
    multiples = {1, fold // 2, fold // 3, (2 * fold) // 5} - {0}
    return all(
        probe.misfit(_turned(probe.points_m, axis, 2 * np.pi * k / fold)) < limit_m
        for k in sorted(multiples, reverse=True)
        if k < fold
    )


def _primes(limit: int) -> list[int]:
    return [n for n in range(2, limit + 1) if all(n % d for d in range(2, int(n**0.5) + 1))]


def _reversal(
    probe: _Probe, axis: NDArray[np.float64], fold: int
) -> tuple[NDArray[np.float64], bool]:
    """Return a frame about ``axis`` and whether half a turn about its x changes nothing."""
    # x follows the file's own x, or y where that is the axis: an upright part is not turned.
    x = np.eye(3)[0] if abs(axis[0]) < 0.9 else np.eye(3)[1]
    x = x - axis * (x @ axis)
    x /= np.linalg.norm(x)
    points = probe.points_m
    radius_m = float(np.linalg.norm(points, axis=1).max())
    share = ROUND_SHARE if fold == 0 else FOLD_SHARE
    limit_m = share * radius_m + SLACK_M
    angles = np.zeros(1) if fold == 0 else np.linspace(0, np.pi / fold, 25)[:-1]
    across = [_turned(x[None], axis, angle)[0] for angle in angles.tolist()]
    misfits = [probe.misfit(_turned(points, u, np.pi)) for u in across]
    best = int(np.argmin(misfits))
    is_reversible = misfits[best] < limit_m
    x = across[best] if is_reversible else x
    return np.column_stack([x, np.cross(axis, x), axis]), is_reversible


def _to_triangles(points: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distance of each point (N, 3) to its triangle (N, 3, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    best = np.minimum(
        _to_edge(points, a, b), np.minimum(_to_edge(points, b, c), _to_edge(points, c, a))
    )
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(length, 1e-30)[:, None]
    above = ((points - a) * normal).sum(axis=1)
    foot = points - above[:, None] * normal
    inside = np.ones(len(points), bool)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(q - p, foot - p) * normal).sum(axis=1) >= 0
    return np.where(inside & (length > 1e-30), np.abs(above), best)


def _to_edge(
    points: NDArray[np.float64], start: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.float64]:
    along = end - start
    length2 = np.maximum((along**2).sum(axis=1), 1e-30)
    t = np.clip(((points - start) * along).sum(axis=1) / length2, 0, 1)
    return np.asarray(np.linalg.norm(points - start - t[:, None] * along, axis=1))
