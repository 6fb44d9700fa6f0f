"""A stereo capture in, a depth image out."""

import cv2
import numpy as np
from numpy.typing import NDArray

from hal import StereoCalibration, StereoCapture
from perception.coarse import coarse_by_sgbm, coarse_by_zncc
from perception.match import BandMatcher, Windows, is_seen_twice, sharpened
from perception.quality import LEAST_COVERAGE, check_images, check_rig, explain
from perception.rectify import Pinhole, RectifiedPair, rectifier_for
from perception.view import DepthView
from perception.volume import Volume

__all__ = ["depth_from_disparity", "depth_view", "disparity_of"]

FEWEST_PAIRS_FOR_ZNCC = 3
PAIRS_TO_SEARCH = 4
"""More do not find the place any better; they measure it better."""
SMALLEST_PATCH_PX = 40
PATCH_STEP_PX = 1.0


def depth_view(
    capture: StereoCapture, calibration: StereoCalibration, volume: Volume | None = None
) -> DepthView:
    """Measure the depth of what a capture shows, in frame ``camera``.

    Parameters
    ----------
    capture
        One or several shots of the same still scene under different patterns.
    calibration
        Of the cameras that took it.
    volume
        What is looked at: output rectangle and range of depths. None: all that the left
        region shows, 0.3 m to 1.5 m.

    Raises
    ------
    ConfigError
        The capture belongs to another rig, or its images do not fit their regions.
    NoDepthError
        The images are dark, saturated, swapped, mirrored or without texture.
    """
    check_rig(capture, calibration)
    check_images(capture)
    first = capture.shots[0]
    rectify = rectifier_for(calibration, first.left_region, first.right_region, volume)
    pinhole = rectify.pinhole
    top_level = float(2**capture.bits - 1)

    def measured(shots: StereoCapture) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        return disparity_of([rectify(s) for s in shots.shots], pinhole, top_level=top_level)

    disparity_px, score = measured(capture)
    coverage = _coverage(disparity_px)
    if coverage < LEAST_COVERAGE:
        raise explain(capture, coverage, lambda other: _coverage(measured(other)[0]))
    return DepthView(
        depth_m=depth_from_disparity(
            disparity_px, focal_px=pinhole.focal_px, baseline_m=pinhole.baseline_m
        ),
        confidence=score,
        image=rectify(first).left,
        focal_px=pinhole.focal_px,
        centre_x_px=pinhole.centre_x_px,
        centre_y_px=pinhole.centre_y_px,
        baseline_m=pinhole.baseline_m,
    )


def depth_from_disparity(
    disparity_px: NDArray[np.float32],
    *,
    focal_px: float,
    baseline_m: float,
    max_depth_m: float = 3.0,
) -> NDArray[np.float32]:
    """Depth along the optical axis of the rectified left camera, z = f B / d.

    This is the usual d + Delta d = B f / (S + Delta s), here with its units: B in metres, f and
    the disparity S both in pixels, so that depth is in metres. S is the left column minus the
    right one, counted from each camera's own principal point, hence positive before the rig;
    differentiating gives an error of depth Delta d = -(z^2 / (f B)) Delta s: a disparity that
    is read too large makes things too near.

    Parameters
    ----------
    disparity_px
        Shape (H, W), float32, pixels. Zero, negative or NaN: no match.
    focal_px, baseline_m
        Of the rectified pair.
    max_depth_m
        What lies beyond is no measurement.

    Returns
    -------
    depth_m
        Shape (H, W), float32, metres; NaN where there is no match or it lies beyond
        ``max_depth_m``. Never zero.

    Examples
    --------
    >>> disparity_px = np.array([[200.0, 0.0]], np.float32)
    >>> depth_from_disparity(disparity_px, focal_px=1400.0, baseline_m=0.1).tolist()
    [[0.699999988079071, nan]]
    """
    is_match = disparity_px > np.float32(focal_px * baseline_m / max_depth_m)
    safe = np.where(is_match, disparity_px, np.float32(1))
    depth_m = np.float32(focal_px * baseline_m) / safe
    return np.where(is_match, depth_m, np.float32(np.nan))


def disparity_of(
    pairs: list[RectifiedPair], pinhole: Pinhole, *, top_level: float = 255.0
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Disparity (H, W) in pixels, NaN where there is none, and the matching score 0..1.

    ``top_level`` is the brightest grey level of the images.
    """
    left = sharpened([pair.left for pair in pairs])
    right = sharpened([pair.right for pair in pairs])
    shift_px = pinhole.right_shift_px
    windows = Windows.for_pairs(len(pairs))
    some = slice(PAIRS_TO_SEARCH)
    guess = _guess(left[some], right[some], pinhole, top_level)
    few = BandMatcher(left[some], right[some], shift_px)
    found = few.searched(guess, sigma_px=windows.search_px)
    found = few.swapped(found, sigma_px=windows.swap_px)
    matcher = BandMatcher(left, right, shift_px)
    found = matcher.swapped(found, sigma_px=windows.swap_px)
    disparity_px, score = matcher.refined(
        found, edge_px=windows.edge_px, inside_px=windows.inside_px
    )
    is_good = score > windows.lowest_score
    is_good &= disparity_px >= pinhole.disparity_low_px - 1
    is_good &= disparity_px <= pinhole.disparity_high_px + 1
    is_good &= is_seen_twice(disparity_px, shift_px=shift_px, right_width_px=pinhole.right_width_px)
    kept = np.where(is_good, disparity_px, np.float32(np.nan))
    return _without_specks(kept), np.clip(score, 0, 1)


def _coverage(disparity_px: NDArray[np.float32]) -> float:
    return float(np.isfinite(disparity_px).mean())


def _guess(
    left: list[NDArray[np.float32]],
    right: list[NDArray[np.float32]],
    pinhole: Pinhole,
    top_level: float,
) -> NDArray[np.float32]:
    """Disparity to a pixel or two."""
    shift_px = pinhole.right_shift_px
    low_px, high_px = pinhole.disparity_low_px, pinhole.disparity_high_px
    if len(left) >= FEWEST_PAIRS_FOR_ZNCC:
        return coarse_by_zncc(left, right, shift_px=shift_px, low_px=low_px, high_px=high_px)
    return coarse_by_sgbm(
        left[0], right[0], shift_px=shift_px, low_px=low_px, high_px=high_px, top_level=top_level
    )


def _without_specks(disparity_px: NDArray[np.float32]) -> NDArray[np.float32]:
    """Drop small islands of disparity: chance matches where there is nothing to match."""
    sixteenths = np.where(np.isfinite(disparity_px), disparity_px * 16, 0).astype(np.int16)
    cv2.filterSpeckles(sixteenths, 0, SMALLEST_PATCH_PX, 16 * PATCH_STEP_PX)
    return np.where(sixteenths > 0, disparity_px, np.float32(np.nan))
