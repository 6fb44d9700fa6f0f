"""Judging a pose: render the model and compare with what was measured, ray by ray."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.pose.gather import block_about
from perception.pose.lsq import to_object
from perception.pose.model import PartModel
from perception.pose.surface import Surface
from perception.pose.trace import trace

__all__ = ["Rendering", "Shares", "compare", "judge", "render"]

MATCH_M = 0.0011
BEYOND_M = 0.0028
RIM_M = 0.0015


@dataclass(frozen=True)
class Shares:
    """What the rays that meet the model say, as shares of those with a measurement.

    ``match``: the measured point lies on the model; ``closeness`` is the same with a soft edge,
    one for a point on the surface. ``violation``: the camera sees through the
    model to something behind it. ``occluded``: something stands in front. The rest lies between
    the tolerances. ``rays`` is how many rays meet the model, measured or not; ``measured`` the
    share of them with a measurement.
    """

    match: float
    closeness: float
    violation: float
    occluded: float
    measured: float
    rays: int

    @property
    def score(self) -> float:
        """One number to rank by: closeness less three times the violation."""
        return self.closeness - 3 * self.violation


@dataclass(frozen=True, eq=False)
class Rendering:
    """A model at a pose against what was measured, for the rays (N,) that have a measurement.

    ``pixels`` are flat indices into the surface's images. ``off_m``: distance of the measured
    point from the model; ``gap_m``: measured less rendered depth; ``is_core``: well inside the
    outline. ``rays`` counts all that meet the model.
    """

    pixels: NDArray[np.int64]
    off_m: NDArray[np.floating]
    gap_m: NDArray[np.floating]
    is_core: NDArray[np.bool_]
    rays: int


def render(
    surface: Surface, model: PartModel, pose: NDArray[np.float64], *, stride: int
) -> Rendering:
    """Render the model at ``pose`` (4, 4), every ``stride``-th pixel."""
    block = block_about(surface, model, pose, stride=stride).slices
    rays = surface.rays[block]
    shape = rays.shape[:2]
    rays = rays.reshape(-1, 3)
    expected_m = trace(model.field, pose, rays)
    is_met = np.isfinite(expected_m)
    # At its outline a part's depth snaps to the background within a matching window.
    rim = max(round(RIM_M / (surface.pixel_m * stride)), 1)
    kernel = np.ones((2 * rim + 1, 2 * rim + 1), np.uint8)
    core = cv2.erode(is_met.reshape(shape).astype(np.uint8), kernel).reshape(-1) > 0
    seen_m = surface.depth_m[block].reshape(-1)
    index = np.flatnonzero(is_met & np.isfinite(seen_m))
    points = rays[index] * seen_m[index][:, None]
    local = to_object(points[None], pose[None].astype(np.float32))[0]
    every = np.arange(surface.is_measured.size).reshape(surface.is_measured.shape)
    return Rendering(
        every[block].reshape(-1)[index],
        np.abs(model.field.distance(local)),
        seen_m[index] - expected_m[index],
        core[index],
        int(is_met.sum()),
    )


def judge(rendering: Rendering, free: NDArray[np.bool_] | None = None) -> Shares:
    """Sum a rendering up.

    Points outside ``free`` (H, W), explained by another part already, count as occluding unless
    they lie behind the model.
    """
    off_m, gap_m = rendering.off_m, rendering.gap_m
    if not len(off_m):
        return Shares(0.0, 0.0, 0.0, 0.0, 0.0, rendering.rays)
    match = off_m < MATCH_M
    if free is not None:
        match &= free.reshape(-1)[rendering.pixels]
    violation = rendering.is_core & (gap_m > BEYOND_M) & (off_m > BEYOND_M)
    occluded = ~match & ~violation & ((gap_m < -BEYOND_M) | (off_m < MATCH_M))
    return Shares(
        float(match.mean()),
        float((match * (1 - (off_m / MATCH_M) ** 2)).mean()),
        float(violation.mean()),
        float(occluded.mean()),
        len(off_m) / rendering.rays,
        rendering.rays,
    )


def compare(
    surface: Surface, model: PartModel, pose: NDArray[np.float64], *, stride: int
) -> Shares:
    """Compare the model at ``pose`` (4, 4) with the surface, every ``stride``-th pixel."""
    return judge(render(surface, model, pose, stride=stride))
