"""Cutting the organised surface into pieces that belong to one part each.

Two neighbours part where the depth jumps or where the surface folds inwards: touching convex
parts meet in a valley. A part may come out in several pieces (a shoulder is a valley too); a
piece should never span two parts.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.pose.surface import Surface

__all__ = ["label_pieces"]

REACH_M = 0.0016
JUMP_M = 0.0035
CREASE_M = 0.00040
# A crease must also stand out of what noise does to the normals over the same reach.
CREASE_OF_NOISE = 1.0
MIN_PIECE_M2 = 40e-6


def label_pieces(
    surface: Surface, is_open: NDArray[np.bool_], *, min_area_m2: float = MIN_PIECE_M2
) -> NDArray[np.int32]:
    """Label the pieces among the pixels ``is_open`` (H, W).

    Returns
    -------
    labels
        Shape (H, W), int32: 0 is none, then 1, 2, ... by falling pixel count. Pieces that show
        less than ``min_area_m2`` are dropped.
    """
    pixel_m = surface.pixel_m
    # Seams about parts that were found are too thin to hold a piece: spare them the search.
    if not _opened(is_open).any() or not np.isfinite(pixel_m):
        return np.zeros(is_open.shape, np.int32)
    reach_px = max(round(REACH_M / pixel_m), 1)
    block = _bounds(is_open, 2 * reach_px)
    whole = is_open.copy()
    whole[block] &= ~_cuts(
        (surface.rays * surface.smooth_m[..., None])[block],
        surface.normals[block],
        is_open[block],
        reach_px=reach_px,
        fold_m=max(CREASE_M, CREASE_OF_NOISE * surface.noise_m),
    )
    count, labels = cv2.connectedComponents(_opened(whole), connectivity=4)
    sizes = np.bincount(labels.ravel(), minlength=count)
    sizes[0] = 0
    order = np.argsort(-sizes, kind="stable")
    order = order[sizes[order] * pixel_m**2 >= min_area_m2]
    rename = np.zeros(count, np.int32)
    rename[order] = np.arange(1, len(order) + 1)
    return np.asarray(rename[labels])


def _opened(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Leave out what is thinner than three pixels."""
    kernel = np.ones((3, 3), np.uint8)
    return np.asarray(cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, kernel))


def _bounds(mask: NDArray[np.bool_], margin_px: int) -> tuple[slice, slice]:
    """Return the rectangle about what is set, with a margin."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return (
        slice(max(int(rows[0]) - margin_px, 0), int(rows[-1]) + margin_px + 1),
        slice(max(int(columns[0]) - margin_px, 0), int(columns[-1]) + margin_px + 1),
    )


def _cuts(
    points_m: NDArray[np.float32],
    normals: NDArray[np.float32],
    is_open: NDArray[np.bool_],
    *,
    reach_px: int,
    fold_m: float,
) -> NDArray[np.bool_]:
    """Return the pixels that lie in the middle of a jump or of a fold deeper than ``fold_m``."""
    height, width = is_open.shape
    cut = np.zeros(is_open.shape, bool)
    slant_px = max(round(0.75 * reach_px), 1)
    for dy, dx in ((0, reach_px), (reach_px, 0), (slant_px, slant_px), (slant_px, -slant_px)):
        first = slice(0, height - dy), slice(max(0, -dx), width - max(0, dx))
        second = slice(dy, height), slice(max(0, dx), width + min(0, dx))
        middle = (
            slice(dy // 2, dy // 2 + height - dy),
            slice(abs(dx) // 2, abs(dx) // 2 + width - abs(dx)),
        )
        step = points_m[second] - points_m[first]
        turn = normals[second] - normals[first]
        bend_m = np.einsum("ijk,ijk->ij", turn, step)
        both = is_open[first] & is_open[second]
        cut[middle] |= both & ((bend_m < -fold_m) | (np.abs(step[..., 2]) > JUMP_M))
    return cut
