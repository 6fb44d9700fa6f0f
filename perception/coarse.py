"""First guess of disparity for every pixel: cheap, sharp at edges, good to a pixel or two."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["coarse_by_sgbm", "coarse_by_zncc"]

Plane = NDArray[np.float32]

WINDOW_PX = 3
SGBM_PENALTIES = (200, 800)


def coarse_by_zncc(
    left: Sequence[Plane], right: Sequence[Plane], *, shift_px: int, low_px: float, high_px: float
) -> Plane:
    """Winner of a spatio-temporal ZNCC at half size, over all disparities.

    The volume of scores is never held: a running best takes each disparity in turn.

    Parameters
    ----------
    left, right
        Rectified pairs (H, W) and (H, right W), float32; at least three pairs, so that 3 x 3
        half-size pixels tell one place from another.
    shift_px
        Column of the right image that a disparity of zero at column zero would have.
    low_px, high_px
        The disparities to look at.

    Returns
    -------
    disparity_px
        Shape (H, W), float32, full-size pixels; every pixel has some value.
    """
    odd = shift_px % 2
    lefts = [_half(image) for image in left]
    rights = [_half(image[:, odd:]) for image in right]
    best = _winner(lefts, rights, shift_px // 2, int(low_px) // 2 - 1, int(high_px) // 2 + 2)
    height, width = left[0].shape
    doubled = cv2.resize(2 * best, None, fx=2, fy=2, interpolation=cv2.INTER_NEAREST)
    down, across = height - doubled.shape[0], width - doubled.shape[1]
    return np.asarray(cv2.copyMakeBorder(doubled, 0, down, 0, across, cv2.BORDER_REPLICATE))


def coarse_by_sgbm(
    left: Plane, right: Plane, *, shift_px: int, low_px: float, high_px: float, top_level: float
) -> Plane:
    """OpenCV's semi-global matcher on one pair: what a single pattern is matched with first.

    ``top_level`` is the brightest grey level. Returns (H, W) float32, pixels; ``low_px`` - 1
    where it found nothing.
    """
    first = int(low_px) - 1
    count = -(-(int(high_px) + 3 - first) // 16) * 16
    offset = shift_px - first
    # The matcher gives up the first ``count`` columns: they are put on and cut off.
    scale = 255 / top_level
    left8 = cv2.copyMakeBorder(_bytes(left, scale), 0, 0, count, 0, cv2.BORDER_CONSTANT)
    start = offset - count
    right8 = _bytes(right[:, max(start, 0) : offset + left.shape[1]], scale)
    before = max(-start, 0)
    after = left8.shape[1] - before - right8.shape[1]
    right8 = cv2.copyMakeBorder(right8, 0, 0, before, after, cv2.BORDER_CONSTANT)
    matcher = cv2.StereoSGBM_create(
        minDisparity=0,
        numDisparities=count,
        blockSize=5,
        P1=SGBM_PENALTIES[0],
        P2=SGBM_PENALTIES[1],
        disp12MaxDiff=1,
        preFilterCap=31,
        uniquenessRatio=5,
        mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY,
    )
    found = matcher.compute(left8, right8)[:, count:]
    return np.asarray(found, np.float32) / np.float32(16) + np.float32(first)


def _half(image: Plane) -> Plane:
    height, width = (side // 2 * 2 for side in image.shape)
    even = np.ascontiguousarray(image[:height, :width])
    return np.asarray(cv2.resize(even, (width // 2, height // 2), interpolation=cv2.INTER_AREA))


def _bytes(image: Plane, scale: float) -> NDArray[np.uint8]:
    return np.asarray(np.clip(image * np.float32(scale), 0, 255), np.uint8)


def _box(image: Plane) -> Plane:
    return np.asarray(cv2.blur(image, (WINDOW_PX, WINDOW_PX), borderType=cv2.BORDER_REPLICATE))


def _moments(images: Sequence[Plane]) -> tuple[Plane, Plane]:
    """Window mean over all images, and one over the standard deviation, at least a level."""
    share = np.float32(1 / len(images))
    total, squares = images[0].copy(), images[0] * images[0]
    for image in images[1:]:
        total += image
        cv2.accumulateSquare(image, squares)
    mean = _box(total) * share
    variance = np.maximum(_box(squares) * share - mean * mean, np.float32(1))
    return mean, np.asarray(1 / np.sqrt(variance), np.float32)


def _winner(
    left: Sequence[Plane], right: Sequence[Plane], shift: int, low: int, high: int
) -> Plane:
    """Best disparity with its parabola's correction; arrays as given, whole pixels in."""
    height, width = left[0].shape
    left_mean, left_scale = _moments(left)
    right_mean, right_scale = _moments(right)
    share = np.float32(1 / len(left))
    best = np.full((height, width), -2, np.float32)
    place = np.full((height, width), low, np.float32)
    before, after = np.zeros_like(best), np.zeros_like(best)
    previous = np.zeros_like(best)
    is_better = np.zeros(best.shape, bool)
    product, means = np.empty_like(best), np.empty_like(best)
    for disparity in range(low, high + 1):
        start = shift - disparity
        if start < 0 or start + width > right[0].shape[1]:
            continue
        cut = slice(start, start + width)
        np.multiply(left[0], right[0][:, cut], out=product)
        for one, other in zip(left[1:], right[1:], strict=True):
            cv2.accumulateProduct(one, other[:, cut], product)
        score = _box(product)
        score *= share
        np.multiply(left_mean, right_mean[:, cut], out=means)
        score -= means
        score *= left_scale
        score *= right_scale[:, cut]
        np.copyto(after, score, where=is_better)
        np.greater(score, best, out=is_better)
        np.copyto(best, score, where=is_better)
        np.copyto(before, previous, where=is_better)
        place[is_better] = disparity
        previous = score
    bend = np.minimum(before - 2 * best + after, np.float32(-1e-6))
    return np.asarray(place + np.clip((before - after) / (2 * bend), -0.5, 0.5), np.float32)
