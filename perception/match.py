"""Fine disparity: spatio-temporal ZNCC in a narrow band around a guess.

The right images are resampled at the guess, so a window follows a slanted or curved surface
instead of assuming that it faces the camera; what is searched is a small common correction.
All windows are Gaussian: a box of the same noise smears edges further.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["BandMatcher", "Windows", "is_seen_twice", "sharpened"]

Plane = NDArray[np.float32]
Mask = NDArray[np.bool_]

REACH = 2.5
"""A Gaussian window is cut off at this many sigmas."""
KEEP_BONUS = np.float32(0.02)
"""By how much a neighbour's disparity must score better than a pixel's own."""

SHARPENING = 1.0
SAME_SURFACE_PX = 2.0
"""Disparities of one right pixel that differ by less may belong to one steep surface."""


@dataclass(frozen=True)
class Windows:
    """Sigmas of the Gaussian windows, pixels: more patterns need less room.

    ``lowest_score`` is what a match must reach: the best of many chance matches gets further
    with fewer patterns.
    """

    search_px: float
    swap_px: float
    edge_px: float
    inside_px: float
    lowest_score: float

    @classmethod
    def for_pairs(cls, pairs: int) -> "Windows":
        """Windows that suit a number of pattern pairs."""
        if pairs >= 6:
            return cls(0.9, 0.5, 0.4, 1.6, 0.65)
        if pairs >= 3:
            return cls(0.9, 0.5, 0.5, 1.8, 0.70)
        if pairs == 2:
            return cls(1.1, 0.8, 0.7, 2.2, 0.75)
        return cls(1.4, 1.0, 0.9, 2.4, 0.80)


class BandMatcher:
    """Rectified pairs, ready to be scored along any map of disparities.

    Parameters
    ----------
    left, right
        (H, W) and (H, right W), float32, grey levels.
    shift_px
        Column ``u`` on the left with disparity ``d`` is column ``u - d + shift_px`` on the right.
    """

    def __init__(self, left: Sequence[Plane], right: Sequence[Plane], shift_px: int) -> None:
        self._left, self._right = left, right
        height, width = left[0].shape
        self._columns = np.arange(width, dtype=np.float32)[None] + np.float32(shift_px)
        self._rows = np.repeat(np.arange(height, dtype=np.float32)[:, None], width, axis=1)
        self._sum, self._squares = _sums(left)

    def scores(
        self, base_px: Plane, offsets_px: Sequence[float], sigmas_px: Sequence[float]
    ) -> list[list[Plane]]:
        """ZNCC (H, W) at ``base_px`` plus each offset, for each window size in turn.

        Two bands of rows are done side by side. Each reaches over the other by a window, so
        that the cut changes no bit, and the cut is the same for any number of cores.
        """
        height = len(base_px)
        reach = max(_reach_px(sigma) for sigma in sigmas_px)
        cut = height // 2
        bands = [
            (slice(0, cut), slice(0, cut + reach)),
            (slice(cut, height), slice(cut - reach, height)),
        ]

        def banded(band: tuple[slice, slice]) -> list[list[Plane]]:
            kept, rows = band
            inner = slice(kept.start - rows.start, kept.stop - rows.start)
            found = self._scores_of(rows, base_px[rows], offsets_px, sigmas_px)
            return [[plane[inner] for plane in planes] for planes in found]

        upper, lower = _workers().map(banded, bands)
        return [
            [np.concatenate(halves) for halves in zip(*planes, strict=True)]
            for planes in zip(upper, lower, strict=True)
        ]

    def _scores_of(
        self, rows: slice, base_px: Plane, offsets_px: Sequence[float], sigmas_px: Sequence[float]
    ) -> list[list[Plane]]:
        share = np.float32(1 / len(self._left))
        sides = []
        for sigma in sigmas_px:
            mean = _window(self._sum[rows], sigma) * share
            sides.append((mean, _deviation(_window(self._squares[rows], sigma) * share, mean)))
        scores: list[list[Plane]] = [[] for _ in sigmas_px]
        for offset in offsets_px:
            columns = self._columns - base_px - np.float32(offset)
            product, total, squares = self._products(rows, columns)
            for found, sigma, (mean, deviation) in zip(scores, sigmas_px, sides, strict=True):
                other = _window(total, sigma) * share
                spread = _deviation(_window(squares, sigma) * share, other)
                covariance = _window(product, sigma) * share - mean * other
                found.append(covariance / (deviation * spread))
        return scores

    def _products(self, rows: slice, columns: Plane) -> tuple[Plane, Plane, Plane]:
        """Sums over the pairs of left times right, right, and right squared."""
        product, total, squares = (np.zeros_like(columns) for _ in range(3))
        places = self._rows[rows]
        for left, right in zip(self._left, self._right, strict=True):
            warped = cv2.remap(
                right, columns, places, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE
            )
            cv2.accumulateProduct(left[rows], warped, product)
            cv2.accumulateSquare(warped, squares)
            total += warped
        return product, total, squares

    def searched(self, guess_px: Plane, *, sigma_px: float, reach_px: int = 2) -> Plane:
        """Best disparity within ``reach_px`` of a guess that is right to a pixel or two."""
        base = smoothed(cv2.medianBlur(guess_px, 5), tolerance_px=2.0)
        offsets = range(-reach_px, reach_px + 1)
        scores = np.stack(self.scores(base, offsets, [sigma_px])[0])
        best = np.clip(scores.argmax(axis=0), 1, 2 * reach_px - 1)
        three = [np.take_along_axis(scores, (best + i)[None], axis=0)[0] for i in (-1, 0, 1)]
        found = base + (best - reach_px).astype(np.float32) + _parabola(*three, limit=0.5)
        return np.asarray(cv2.medianBlur(found, 5))

    def swapped(self, disparity_px: Plane, *, sigma_px: float) -> Plane:
        """Let each pixel take the farthest or nearest disparity next to it if that fits better.

        This moves the edge of a part by a pixel towards where it is; a window on the edge
        cannot tell.
        """
        around = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (3, 3))
        near, far = cv2.dilate(disparity_px, around), cv2.erode(disparity_px, around)
        candidates = [disparity_px, near, far]
        scores = np.stack([self.scores(c, (0,), [sigma_px])[0][0] for c in candidates])
        scores[0] += KEEP_BONUS
        chosen = np.choose(scores.argmax(axis=0), candidates)
        return np.asarray(cv2.medianBlur(chosen.astype(np.float32), 3))

    def refined(
        self, disparity_px: Plane, *, edge_px: float, inside_px: float, step_px: float = 0.25
    ) -> tuple[Plane, Plane]:
        """Sub-pixel disparity and its score: a small window where it is steep, else a larger one.

        The parabola's step is small on purpose. Three points a whole pixel apart read the
        skewness of the texture in the window as disparity: twice the error of this.
        """
        base = smoothed(disparity_px, tolerance_px=1.5)
        sharp, wide = self.scores(base, (-step_px, 0, step_px), [edge_px, inside_px])
        weight = _steepness(base)
        correction = weight * _parabola(*sharp, limit=3.0)
        correction += (1 - weight) * _parabola(*wide, limit=3.0)
        return base + np.float32(step_px) * correction, np.maximum(sharp[1], wide[1])


def sharpened(images: Sequence[Plane]) -> list[Plane]:
    """Undo part of the lens' blur, which mixes a part's rim with what lies behind it."""
    return [
        cv2.addWeighted(image, 1 + SHARPENING, cv2.GaussianBlur(image, (5, 5), 0.8), -SHARPENING, 0)
        for image in images
    ]


def smoothed(disparity_px: Plane, *, tolerance_px: float) -> Plane:
    """Smooth within surfaces, not across steps of more than ``tolerance_px``."""
    return np.asarray(cv2.bilateralFilter(disparity_px, 9, tolerance_px, 2.0))


def is_seen_twice(disparity_px: Plane, *, shift_px: int, right_width_px: int) -> Mask:
    """Whether no nearer surface claims the same place in the right image, (H, W).

    A pixel the right camera cannot see has been given some disparity all the same.
    """
    height, width = disparity_px.shape
    columns = np.arange(width, dtype=np.float32)[None] + np.float32(shift_px) - disparity_px
    place = np.clip(np.rint(columns), 0, right_width_px - 1).astype(np.intp)
    place += np.arange(height)[:, None] * right_width_px
    nearest = np.zeros(height * right_width_px, np.float32)
    np.maximum.at(nearest, place.ravel(), disparity_px.ravel())
    return np.asarray(disparity_px > nearest[place] - np.float32(SAME_SURFACE_PX))


def _sums(images: Sequence[Plane]) -> tuple[Plane, Plane]:
    total, squares = np.zeros_like(images[0]), np.zeros_like(images[0])
    for image in images:
        total += image
        cv2.accumulateSquare(image, squares)
    return total, squares


@cache
def _workers() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(2, thread_name_prefix="binpick-match")


def _reach_px(sigma_px: float) -> int:
    return int(np.ceil(REACH * sigma_px))


def _window(image: Plane, sigma_px: float) -> Plane:
    size = 2 * _reach_px(sigma_px) + 1
    return np.asarray(cv2.GaussianBlur(image, (size, size), sigma_px))


def _deviation(mean_square: Plane, mean: Plane) -> Plane:
    """Standard deviation, at least one grey level: an unlit window has no score."""
    return np.asarray(np.sqrt(np.maximum(mean_square - mean * mean, np.float32(1))))


def _parabola(before: Plane, middle: Plane, after: Plane, *, limit: float) -> Plane:
    """Where the parabola through three scores has its top, in steps, clipped."""
    bend = np.minimum(before - 2 * middle + after, np.float32(-1e-6))
    return np.asarray(np.clip((before - after) / (2 * bend), -limit, limit), np.float32)


def _steepness(disparity_px: Plane) -> Plane:
    """Zero on gentle slopes, one near steps and on rims that turn away."""
    around = np.ones((5, 5), np.uint8)
    spread = cv2.dilate(disparity_px, around) - cv2.erode(disparity_px, around)
    return np.asarray(np.clip((spread - np.float32(0.5)) / np.float32(0.4), 0, 1), np.float32)
