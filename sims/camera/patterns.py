"""The projector's dots: one random pattern and its cyclic shifts."""

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["OVERSAMPLING", "base_pattern", "lookup", "shift_px"]

CELL_PX = 2
FILL = 0.5
BLUR_PX = 0.6
OVERSAMPLING = 4
"""cv2.remap rounds to 1/32 of a source pixel; four source pixels a dot pixel make that 1/128."""
MARGIN_PX = 2
SEED = 1


@lru_cache(maxsize=2)
def base_pattern(width_px: int, height_px: int) -> NDArray[np.float32]:
    """Light per projector pixel, 0..1, oversampled, wrapped by a margin on every side.

    Random binary cells, softened by the projector's optics.
    """
    rng = np.random.default_rng(SEED)
    cells = rng.random((height_px // CELL_PX, width_px // CELL_PX)) < FILL
    fine = np.kron(cells, np.ones((CELL_PX * OVERSAMPLING,) * 2, np.float32)).astype(np.float32)
    margin = MARGIN_PX * OVERSAMPLING
    wrapped = np.pad(fine, 2 * margin, mode="wrap")
    soft = cv2.GaussianBlur(wrapped, (0, 0), BLUR_PX * OVERSAMPLING)
    pattern = np.ascontiguousarray(soft[margin:-margin, margin:-margin])
    pattern.setflags(write=False)
    return pattern


def shift_px(index: int) -> tuple[int, int]:
    """How far pattern ``index`` is shifted from the first, columns and rows."""
    return 7 * index % 53, (13 * index + index * index) % 89


def lookup(
    index: int, u_px: NDArray[np.float32], v_px: NDArray[np.float32], size_px: tuple[int, int]
) -> NDArray[np.float32]:
    """Light of pattern ``index`` at projector pixels (u, v), float32, shape of ``u_px``.

    Outside of the projector's image the pattern goes on; the caller knows what is lit.
    """
    width_px, height_px = size_px
    du, dv = shift_px(index)
    offset = np.float32(MARGIN_PX * OVERSAMPLING + (OVERSAMPLING - 1) / 2)
    u = np.mod(u_px + np.float32(du), np.float32(width_px)) * np.float32(OVERSAMPLING) + offset
    v = np.mod(v_px + np.float32(dv), np.float32(height_px)) * np.float32(OVERSAMPLING) + offset
    pattern = base_pattern(width_px, height_px)
    return np.asarray(cv2.remap(pattern, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE))
