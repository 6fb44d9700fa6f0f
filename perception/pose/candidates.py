"""Poses worth a closer look, for each piece of surface: refined, judged, with their rivals."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from perception.pose.axial import Placement, place_along
from perception.pose.discs import place_on_discs
from perception.pose.gather import near_points, overshoot_m
from perception.pose.lsq import refine
from perception.pose.model import PartModel
from perception.pose.surface import Surface
from perception.pose.tube import Tube, find_tubes, pad
from perception.pose.verify import Rendering, Shares, judge, render

__all__ = ["Candidate", "find_candidates", "refined"]

POINTS = 220
WITHIN_M = 0.0035
SCALES_M = (0.003, 0.0015)
ITERATIONS = 5
STRIDE_PX = 3
FINE_BIN_M = 0.0005
IN_WALL_M = 0.0025
FINE_STRIDE_PX = 2


@dataclass(frozen=True, eq=False)
class Candidate:
    """A refined pose (4, 4), its rendering and its judgement.

    ``slip_margin`` is by how much its place along the axis leads over other places the same way
    round, ``flip_margin`` over all places the other way round; infinite without a rival.
    """

    pose: NDArray[np.float64]
    rendering: Rendering
    shares: Shares
    slip_margin: float
    flip_margin: float


def find_candidates(
    surface: Surface,
    model: PartModel,
    labels: NDArray[np.int32],
    is_open: NDArray[np.bool_],
    *,
    rng: np.random.Generator,
) -> list[Candidate]:
    """Return the best candidate of each tube and each flat face among the labelled pieces."""
    candidates = _on_tubes(surface, model, labels, is_open, rng=rng)
    faces = place_on_discs(surface, model, labels, rng=rng)
    starts = [pose for poses in faces for pose in poses]
    poses = refined(surface, model, starts, is_open)
    first = 0
    for face in faces:
        last = first + len(face)
        if face:
            candidates.append(_best_on_face(surface, model, poses[first:last]))
        first = last
    return candidates


def _on_tubes(
    surface: Surface,
    model: PartModel,
    labels: NDArray[np.int32],
    is_open: NDArray[np.bool_],
    *,
    rng: np.random.Generator,
) -> list[Candidate]:
    profile = model.part.profile
    tubes = find_tubes(surface, labels, profile, rng=rng)
    starts: list[NDArray[np.float64]] = []
    kept: list[Tube] = []
    for tube in tubes:
        placements = place_along(surface, tube.pose, tube.span_m, profile)
        placements = _in_the_bin(surface, model, placements)
        if placements:
            kept.append(tube)
            starts.append(placements[0].pose)
    poses = refined(surface, model, starts, is_open)
    # The axis is exact now: look along it again, closer, before the place is settled.
    settled: list[Placement] = []
    margins: list[tuple[float, float]] = []
    for pose, tube in zip(poses, kept, strict=True):
        shift = float(pose[:3, 2] @ (tube.pose[:3, 3] - pose[:3, 3]))
        turned = float(np.sign(pose[:3, 2] @ tube.pose[:3, 2]))
        ends = sorted(shift + turned * end for end in tube.span_m)
        placements = place_along(
            surface, pose, (ends[0], ends[1]), profile, bin_m=FINE_BIN_M, stride=FINE_STRIDE_PX
        )
        placements = _in_the_bin(surface, model, placements)
        settled.append(placements[0])
        margins.append(_margins(placements, is_reversible=model.part.is_reversible))
    poses = refined(surface, model, [p.pose for p in settled], is_open)
    return [
        _judged(surface, model, pose, margin) for pose, margin in zip(poses, margins, strict=True)
    ]


def _in_the_bin(surface: Surface, model: PartModel, placements: list[Placement]) -> list[Placement]:
    """Leave out what would stick in a wall or the floor, unless nothing is left then."""
    fits = [p for p in placements if overshoot_m(surface, model, p.pose) < IN_WALL_M]
    return fits or placements


def _best_on_face(
    surface: Surface, model: PartModel, poses: list[NDArray[np.float64]]
) -> Candidate:
    """Judge the poses on one face; those the other way round are rivals of the best."""
    judged = [_judged(surface, model, pose, (np.inf, np.inf)) for pose in poses]
    best = max(judged, key=lambda c: c.shares.score)
    rivals = [c.shares.score for c in judged if float((c.pose[:3, 2] * best.pose[:3, 2]).sum()) < 0]
    lead = best.shares.score - max(rivals, default=-np.inf)
    return replace(best, flip_margin=np.inf if model.part.is_reversible else lead)


def _judged(
    surface: Surface,
    model: PartModel,
    pose: NDArray[np.float64],
    margins: tuple[float, float],
) -> Candidate:
    rendering = render(surface, model, pose, stride=STRIDE_PX)
    return Candidate(pose, rendering, judge(rendering), *margins)


def _margins(placements: list[Placement], *, is_reversible: bool) -> tuple[float, float]:
    best = placements[0]
    same = [p.score for p in placements[1:] if p.is_flipped == best.is_flipped]
    other = [p.score for p in placements if p.is_flipped != best.is_flipped and not is_reversible]
    return (
        best.score - max(same, default=-np.inf),
        best.score - max(other, default=-np.inf),
    )


def refined(
    surface: Surface,
    model: PartModel,
    starts: list[NDArray[np.float64]],
    is_open: NDArray[np.bool_],
) -> list[NDArray[np.float64]]:
    """Fit each start to the open points near it."""
    if not starts:
        return []
    clouds = [
        near_points(surface, model, pose, is_open, within_m=WITHIN_M, stride=2, most=POINTS)
        for pose in starts
    ]
    points, weights = pad(clouds)
    fit = refine(
        model.field, points.astype(np.float32), weights.astype(np.float32), np.array(starts),
        scales_m=SCALES_M, iterations=ITERATIONS,
    )  # fmt: skip
    return list(fit.poses)
