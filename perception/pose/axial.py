"""Where along a known axis a part sits, and which way round.

Each viewing ray meets the cylinder of radius r_k about the axis at a place z_k that does not
depend on where the part sits. What was measured there speaks for a section of that radius (the
point lies on it), against it (the camera sees through it, or meets another of the part's radii),
or not at all. Surface of the part's kind beyond an end speaks against that end. Summed along z
once, this evidence gives the score of every position and both directions by differences.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.parts import Profile
from perception.pose.surface import Surface
from perception.pose.tube import distinct_radii

__all__ = ["Placement", "block_along", "flip_contrast", "place_along"]

ON_SURFACE_M = 0.0012
SEEN_THROUGH_M = 0.0025
BEYOND_M = 0.012
SEARCH_M = 0.012
# Against a section, and against an end with more of the same beyond it, to one ray for it.
AGAINST = 1.5
CONTINUES = 0.7
RADIAL = 0.6
# Peaks this close to a better one are the same place, which the refinement will find.
APART_M = 0.004
PER_DIRECTION = 2


@dataclass(frozen=True, eq=False)
class Placement:
    """A candidate: ``pose`` (4, 4) T_camera_object and its evidence.

    ``score`` counts rays for less rays against, as a share of the rays that a part lying free
    would have for it.
    """

    pose: NDArray[np.float64]
    is_flipped: bool
    score: float


@dataclass(frozen=True, eq=False)
class _Evidence:
    """Cumulated sums along z from ``low_m`` in steps of ``bin_m``.

    ``sections`` (K, bins + 1) for each radius, ``surface`` (bins + 1) for anything of the part's
    kind; ``expected`` is the rays that a metre of the part meets.
    """

    low_m: float
    bin_m: float
    sections: NDArray[np.float64]
    surface: NDArray[np.float64]
    expected: float

    def between(
        self, sums: NDArray[np.float64], start_m: NDArray[np.float64], end_m: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the evidence from ``start_m`` to ``end_m``, any equal shapes."""
        at = np.arange(len(sums))
        first = np.interp((start_m - self.low_m) / self.bin_m, at, sums)
        return np.interp((end_m - self.low_m) / self.bin_m, at, sums) - first


def place_along(
    surface: Surface,
    axis: NDArray[np.float64],
    span_m: tuple[float, float],
    profile: Profile,
    *,
    bin_m: float = 0.001,
    stride: int = 3,
) -> list[Placement]:
    """Return the likeliest placements on the z axis of ``axis`` (4, 4), best first.

    ``span_m`` is where along it the part's surface was seen: the part covers most of that.
    """
    radii_m = distinct_radii(profile)
    half_m = float(profile.z_edges_m[-1])
    low_m = span_m[0] - 2 * half_m - BEYOND_M - SEARCH_M
    high_m = span_m[1] + 2 * half_m + BEYOND_M + SEARCH_M
    evidence = _gather(surface, axis, radii_m, low_m, high_m, bin_m=bin_m, stride=stride)
    if evidence is None:
        return []
    ends_m = sorted((span_m[1] - half_m, span_m[0] + half_m))
    shifts_m = np.arange(ends_m[0] - SEARCH_M, ends_m[1] + SEARCH_M, bin_m)
    section = np.abs(radii_m[None] - profile.radii_m[:, None]).argmin(axis=1)
    placements: list[Placement] = []
    for is_flipped in (False, True):
        edges_m = -profile.z_edges_m[::-1] if is_flipped else profile.z_edges_m
        order = section[::-1] if is_flipped else section
        scores = -CONTINUES * (
            evidence.between(evidence.surface, shifts_m - half_m - BEYOND_M, shifts_m - half_m)
            + evidence.between(evidence.surface, shifts_m + half_m, shifts_m + half_m + BEYOND_M)
        )
        for k, row in enumerate(order.tolist()):
            scores += evidence.between(
                evidence.sections[row], shifts_m + edges_m[k], shifts_m + edges_m[k + 1]
            )
        scores /= evidence.expected * 2 * half_m
        placements += _peaks(axis, shifts_m, scores, is_flipped=is_flipped)
    return sorted(placements, key=lambda p: -p.score)


def flip_contrast(profile: Profile, step_m: float = 0.0005) -> float:
    """Return how much better the right direction can score at most: 0 for equal ends.

    The score of a part seen whole is 1; this is what the best place the other way round falls
    short of that.
    """
    half_m = float(profile.z_edges_m[-1])
    z_m = np.arange(-half_m + step_m / 2, half_m, step_m)
    own = profile.radius_at(z_m)
    best = -np.inf
    for shift_m in np.arange(-half_m, half_m, step_m).tolist():
        seen = profile.radius_at(-(z_m - shift_m))
        speaks = np.where(seen == 0, -CONTINUES, np.where(np.abs(seen - own) < ON_SURFACE_M, 1, -1))
        beyond = round(abs(shift_m) / step_m)
        best = max(best, float(speaks.sum() - AGAINST * beyond) / len(z_m))
    return 1.0 - best


def _gather(
    surface: Surface,
    axis: NDArray[np.float64],
    radii_m: NDArray[np.float64],
    low_m: float,
    high_m: float,
    *,
    bin_m: float,
    stride: int,
) -> _Evidence | None:
    ends = axis[:3, 3] + np.outer([low_m, high_m], axis[:3, 2])
    rays, depth_m, normals = _rays_near(surface, ends, float(radii_m[-1]), stride)
    if not len(rays):
        return None
    rotation = axis[:3, :3]
    origin = -np.einsum("i,ij->j", axis[:3, 3], rotation)
    direction = np.einsum("ni,ij->nj", rays, rotation)
    normal = np.einsum("ni,ij->nj", normals, rotation)
    point = origin + depth_m[:, None] * direction
    rho = np.hypot(point[:, 0], point[:, 1])
    outward = (point[:, 0] * normal[:, 0] + point[:, 1] * normal[:, 1]) / np.maximum(rho, 1e-9)
    off = np.abs(rho[None] - radii_m[:, None])
    on_any = (off.min(axis=0) < ON_SURFACE_M) & (outward > RADIAL)
    nearest = off.argmin(axis=0)
    bins = int(np.ceil((high_m - low_m) / bin_m)) + 1

    def summed(z_m: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
        place = np.floor((z_m - low_m) / bin_m).astype(np.int64)
        held = (place >= 0) & (place < bins)
        total = np.bincount(place[held], weights=values[held], minlength=bins)
        return np.concatenate([[0.0], np.cumsum(total)])

    a = direction[:, 0] ** 2 + direction[:, 1] ** 2
    b = origin[0] * direction[:, 0] + origin[1] * direction[:, 1]
    c = origin[0] ** 2 + origin[1] ** 2
    sections = []
    for k, radius_m in enumerate(radii_m.tolist()):
        root = b * b - a * (c - radius_m**2)
        hit_m = (-b - np.sqrt(np.maximum(root, 0))) / a
        speaks = np.where(on_any & (nearest != k), -1.0, 0.0)
        speaks = np.where(off[k] < ON_SURFACE_M, 1.0, speaks)
        speaks = np.where(depth_m - hit_m > SEEN_THROUGH_M, -AGAINST, speaks)
        z_m = origin[2] + hit_m * direction[:, 2]
        sections.append(summed(np.where(root > 0, z_m, low_m - 1), speaks))
    width_px = 2 * float(radii_m.mean()) / float(ends[:, 2].mean()) * surface.focal_px / stride
    slant = float(np.hypot(axis[0, 2], axis[1, 2]))
    per_m = surface.focal_px / stride / float(ends[:, 2].mean()) * max(slant, 0.2)
    return _Evidence(
        low_m, bin_m, np.array(sections), summed(point[:, 2], on_any * 1.0), width_px * per_m
    )


def block_along(
    surface: Surface, ends_m: NDArray[np.float64], radius_m: float, *, stride: int
) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
    """Return the image block about a line (2, 3), and which of its pixels lie ``radius_m`` near."""
    ends_m = ends_m.copy()
    ends_m[:, 2] = np.maximum(ends_m[:, 2], 0.05)
    rows, columns = surface.project(ends_m)
    reach = 1.1 * radius_m / float(ends_m[:, 2].min()) * surface.focal_px + 1
    height, width = surface.is_measured.shape
    top, bottom = (int(np.clip(x, 0, height)) for x in (rows.min() - reach, rows.max() + reach + 1))
    left, right = (
        int(np.clip(x, 0, width)) for x in (columns.min() - reach, columns.max() + reach + 1)
    )
    block = (slice(top, bottom, stride), slice(left, right, stride))
    u, v = np.arange(left, right, stride), np.arange(top, bottom, stride)[:, None]
    du, dv = columns[1] - columns[0], rows[1] - rows[0]
    off = np.abs((u - columns[0]) * dv - (v - rows[0]) * du) / max(float(np.hypot(du, dv)), 1e-9)
    return block, off < reach


def _rays_near(
    surface: Surface, ends_m: NDArray[np.float64], radius_m: float, stride: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return rays (N, 3), depths (N,) and normals (N, 3) within ``radius_m`` of a line."""
    block, is_near = block_along(surface, ends_m, radius_m, stride=stride)
    near = surface.is_measured[block] & is_near
    return (
        surface.rays[block][near].astype(np.float64),
        surface.depth_m[block][near].astype(np.float64),
        surface.normals[block][near].astype(np.float64),
    )


def _peaks(
    axis: NDArray[np.float64],
    shifts_m: NDArray[np.float64],
    scores: NDArray[np.float64],
    *,
    is_flipped: bool,
) -> list[Placement]:
    found: list[Placement] = []
    taken: list[float] = []
    for k in np.argsort(-scores, kind="stable").tolist():
        if all(abs(shifts_m[k] - other) >= APART_M for other in taken):
            taken.append(float(shifts_m[k]))
            placed = axis.copy()
            placed[:3, 3] += shifts_m[k] * axis[:3, 2]
            if is_flipped:
                placed[:3, 1:3] *= -1
            found.append(Placement(placed, is_flipped, float(scores[k])))
            if len(found) == PER_DIRECTION:
                break
    return found
