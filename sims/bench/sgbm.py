"""The peer of the depth bench: OpenCV's semi-global matcher as its users set it up."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.rectify import Pinhole, RectifiedPair

__all__ = ["NAME", "sgbm_disparity"]

NAME = "OpenCV SGBM"
BLOCK_PX = 5


def sgbm_disparity(pairs: Sequence[RectifiedPair], pinhole: Pinhole) -> NDArray[np.float32]:
    """Disparity (H, W) in pixels, NaN where none; the median over several pairs."""
    found = np.stack([_one(pair, pinhole) for pair in pairs])
    if len(found) == 1:
        return np.asarray(found[0])
    # Sorting puts NaN last, so what was found comes first, in order.
    ordered = np.sort(found, axis=0)
    count = np.isfinite(ordered).sum(axis=0)
    places = (np.maximum(count - 1, 0) // 2, np.minimum(count // 2, len(found) - 1))
    low, high = (np.take_along_axis(ordered, place[None], axis=0)[0] for place in places)
    return np.where(2 * count >= len(found), (low + high) / 2, np.float32(np.nan))


def _one(pair: RectifiedPair, pinhole: Pinhole) -> NDArray[np.float32]:
    first = int(pinhole.disparity_low_px) - 1
    count = -(-(int(pinhole.disparity_high_px) + 3 - first) // 16) * 16
    height, width = pair.left.shape
    # Columns so that a disparity of ``first`` is zero; room for the matcher's blind margin.
    left, right = np.zeros((2, height, width + count), np.uint8)
    left[:, count:] = np.clip(np.rint(pair.left), 0, 255)
    start = pinhole.right_shift_px - first
    source = pair.right[:, max(start - count, 0) : start + width]
    offset = max(count - start, 0)
    right[:, offset : offset + source.shape[1]] = np.clip(np.rint(source), 0, 255)
    matcher = cv2.StereoSGBM_create(
        minDisparity=0,
        numDisparities=count,
        blockSize=BLOCK_PX,
        P1=8 * BLOCK_PX**2,
        P2=32 * BLOCK_PX**2,
        disp12MaxDiff=1,
        preFilterCap=31,
        uniquenessRatio=5,
        speckleWindowSize=100,
        speckleRange=2,
        mode=cv2.STEREO_SGBM_MODE_SGBM,
    )
    sixteenths = matcher.compute(left, right)[:, count:]
    disparity_px = sixteenths.astype(np.float32) / 16 + first
    return np.where(sixteenths >= 0, disparity_px, np.float32(np.nan))
