"""Where a turned part's ends and shoulders are seen: its place along the axis.

The sides of a shaft say nothing about its place along the axis; only ends and shoulders do, and
least squares on distances uses the few points on them badly. So each edge of the profile is
located by itself: within 4 mm of where it should be, how far along the axis does the larger
section reach before the measured depth drops to the smaller one, or to the background?

Matching windows smear depth across an edge by a part of a pixel, always in the same manner: the
larger section seems longer, and everything is drawn towards the half-hidden side, -x of the left
image. How much was measured once on rendered stereo (1 and 4 pairs, shafts of three sizes); the
first cancels between the two ends of a section, the second does not.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.parts import Profile
from perception.pose.axial import block_along
from perception.pose.surface import Surface

__all__ = ["AxialFix", "fix_along"]

REACH_M = 0.004
BIN_M = 0.00025
STRIP = 0.7
DROP_M = 0.003
MIN_RAYS = 60
MIN_BODY, MAX_BEYOND, MAX_COVERED = 0.85, 0.25, 0.05
MAX_MISFIT_M = 0.0007
FIT_SIGMA_M = 0.00017
# Edges of one part share their matching noise, so together they are worth less than counted.
SHARED = 1.3
# Unknown depth beside an edge is the shadow of one view: as likely this side as that.
UNKNOWN = 0.5


@dataclass(frozen=True)
class _Smear:
    """Outward displacement in pixels: ``always`` + ``along_x`` cx + ``across`` |cx|, and spread.

    cx is the image-x component of the edge's outward direction.
    """

    always: float
    along_x: float
    across: float
    sigma_px: float


SHOULDER = _Smear(0.47, -0.36, 0.30, 0.45)
END = _Smear(0.78, -1.22, 0.25, 0.80)


@dataclass(frozen=True)
class AxialFix:
    """How far to move along +z, with its standard deviation, from ``edges`` edges."""

    shift_m: float
    sigma_m: float
    edges: int


def fix_along(surface: Surface, pose: NDArray[np.float64], profile: Profile) -> AxialFix:
    """Locate the edges of the part at ``pose`` (4, 4); the fit's own place counts as one more."""
    shifts, weights = [0.0], [1 / FIT_SIGMA_M**2]
    for offset_m, outward, is_shoulder in _edges(surface, pose, profile):
        smear = SHOULDER if is_shoulder else END
        along_x = outward * float(pose[0, 2])
        expected_px = smear.always + smear.along_x * along_x + smear.across * abs(along_x)
        shifts.append(outward * (offset_m - expected_px * surface.pixel_m))
        weights.append(1 / (smear.sigma_px * surface.pixel_m) ** 2)
    values, weight = np.array(shifts), np.array(weights)
    middle = float(np.median(values))
    # An edge far from what the others say was something else's.
    kept = np.abs(values - middle) < MAX_MISFIT_M
    total = float(weight[kept].sum())
    if not kept.any():
        return AxialFix(0.0, MAX_MISFIT_M, 0)
    shift_m = float((values * weight)[kept].sum() / total)
    return AxialFix(shift_m, SHARED / float(np.sqrt(total)), int(kept[1:].sum()))


def _edges(
    surface: Surface, pose: NDArray[np.float64], profile: Profile
) -> list[tuple[float, float, bool]]:
    """Return (outward offset, outward sign along z, whether a shoulder) of each clear edge."""
    ends = pose[:3, 3] + np.outer(profile.z_edges_m[[0, -1]], pose[:3, 2])
    block, _ = block_along(surface, ends, float(profile.radii_m.max()), stride=1)
    rays = surface.rays[block].reshape(-1, 3).astype(np.float64)
    depth_m = surface.depth_m[block].reshape(-1).astype(np.float64)
    origin = -np.einsum("i,ij->j", pose[:3, 3], pose[:3, :3])
    direction = np.einsum("ni,ij->nj", rays, pose[:3, :3])
    a = np.maximum(direction[:, 0] ** 2 + direction[:, 1] ** 2, 1e-12)
    b = origin[0] * direction[:, 0] + origin[1] * direction[:, 1]
    c = origin[0] ** 2 + origin[1] ** 2
    nearest2 = c - b * b / a
    radii_m = np.concatenate([[0.0], profile.radii_m, [0.0]])
    found = []
    for k, edge_m in enumerate(profile.z_edges_m.tolist()):
        inner, outer = max(radii_m[k], radii_m[k + 1]), min(radii_m[k], radii_m[k + 1])
        outward = 1.0 if radii_m[k] > radii_m[k + 1] else -1.0
        hit_m = (-b - np.sqrt(np.maximum(b * b - a * (c - inner**2), 0))) / a
        x = (origin[2] + hit_m * direction[:, 2] - edge_m) * outward
        strip = min(STRIP * inner, 0.85 * outer if outer > 0 else inner)
        near = np.flatnonzero((nearest2 < strip**2) & (np.abs(x) < REACH_M))
        if len(near) < MIN_RAYS or inner - outer < 0.001:
            continue
        drop_m: NDArray[np.float64] | float = DROP_M
        if outer > 0:
            behind_m = (-b[near] - np.sqrt(np.maximum(b * b - a * (c - outer**2), 0))[near]) / a[
                near
            ]
            drop_m = (behind_m - hit_m[near]) / 2
        offset_m = _reach(x[near], depth_m[near] - hit_m[near], drop_m)
        if offset_m is not None:
            found.append((offset_m, outward, outer > 0))
    return found


def _reach(
    x: NDArray[np.float64], gap_m: NDArray[np.float64], drop_m: NDArray[np.float64] | float
) -> float | None:
    """Return how far beyond the edge the section reaches; None when something hides it.

    ``x`` is outward of the edge, ``gap_m`` how much deeper than the section was measured, NaN
    where nothing was; more than ``drop_m`` is no longer the section.
    """
    bins = round(2 * REACH_M / BIN_M)
    place = np.clip(((x + REACH_M) / BIN_M).astype(np.int64), 0, bins - 1)
    on = np.where(np.isnan(gap_m), UNKNOWN, gap_m < drop_m)
    counts = np.bincount(place, minlength=bins)
    if (counts == 0).any() or (gap_m < -DROP_M).mean() > MAX_COVERED:
        return None
    share = np.bincount(place, weights=on, minlength=bins) / counts
    fifth = bins // 5
    if share[:fifth].mean() < MIN_BODY or share[-fifth:].mean() > MAX_BEYOND:
        return None
    return float(share.sum() * BIN_M - REACH_M)
