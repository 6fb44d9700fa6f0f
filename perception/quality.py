"""Whether images can give depth at all, and if not, why: one line that says what to do."""

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from hal import StereoCalibration, StereoCapture, StereoShot
from hal.errors import ConfigError, NoDepthError

__all__ = ["LEAST_COVERAGE", "check_images", "check_rig", "explain"]

BRIGHT_SHARE = 0.08
"""A lit scene has pixels brighter than this share of the range."""
MOST_SATURATED = 0.20
LEAST_CONTRAST = 0.10
"""Median of local deviation over local mean: a dot pattern gives 0.3 and more."""
LEAST_COVERAGE = 0.25
"""Share of the view that has depth when images and calibration belong together."""

Image = NDArray[np.uint8] | NDArray[np.uint16]


def check_rig(capture: StereoCapture, calibration: StereoCalibration, *, source: str = "") -> None:
    """Refuse images of other cameras, or that do not fit their regions or the sensors.

    ``source`` names the calibration's file in the message.

    Raises
    ------
    ConfigError
        Says which and what to do.
    """
    if capture.serials != calibration.serials:
        if capture.serials == calibration.serials[::-1]:
            hint = "left and right are exchanged: swap the cables or the images"
        else:
            hint = "use this rig's own calibration file, or calibrate it"
        raise ConfigError(
            f"belongs to cameras {'/'.join(calibration.serials)}, the images are of "
            f"{'/'.join(capture.serials)}: {hint}",
            source=source or "calibration",
            key="serials",
        )
    if not capture.shots:
        raise ConfigError("has no shots", source="capture")
    first = capture.shots[0]
    for number, shot in enumerate(capture.shots):
        if (shot.left_region, shot.right_region) != (first.left_region, first.right_region):
            raise ConfigError(
                f"shot {number} has other regions than shot 0: capture them in one go",
                source="capture",
            )
        for side, image, region, camera in (
            ("left", shot.left, shot.left_region, calibration.left),
            ("right", shot.right, shot.right_region, calibration.right),
        ):
            where = f"the {side} image of shot {number}"
            size_px = (image.shape[1], image.shape[0])
            if size_px != (region.width_px, region.height_px):
                raise ConfigError(
                    f"{where} is {size_px[0]} x {size_px[1]} px, its region "
                    f"{region.width_px} x {region.height_px}",
                    source="capture",
                )
            if not region.is_inside(camera.width_px, camera.height_px):
                raise ConfigError(
                    f"{where} leaves the calibrated sensor of {camera.width_px} x "
                    f"{camera.height_px} px: {region}",
                    source="capture",
                )


def check_images(capture: StereoCapture) -> None:
    """Refuse images that are dark, saturated or without texture.

    Raises
    ------
    NoDepthError
        Says which image and what to do.
    """
    top = 2**capture.bits - 1
    for number, shot in enumerate(capture.shots):
        for side, image in (("left", shot.left), ("right", shot.right)):
            where = f"the {side} image of shot {number}"
            saturated = float((image >= top).mean())
            if saturated > MOST_SATURATED:
                raise NoDepthError(
                    f"{where} is saturated ({saturated:.0%} at {top}): shorten the exposure"
                )
            # A sixteenth of the pixels is enough for a percentile.
            bright = float(np.percentile(image[::4, ::4], 99))
            if bright < BRIGHT_SHARE * top:
                raise NoDepthError(
                    f"{where} is dark (99 % of it below {bright:.0f} of {top}): switch the "
                    "projector's light on, uncover the lens or lengthen the exposure"
                )
            contrast = _contrast(image)
            if contrast < LEAST_CONTRAST:
                raise NoDepthError(
                    f"{where} has no texture (contrast {contrast:.2f}, a dot pattern gives 0.3 and "
                    "more): switch the projector's light on and focus it"
                )


def explain(
    capture: StereoCapture, coverage: float, coverage_of: Callable[[StereoCapture], float]
) -> NoDepthError:
    """Find out why a capture gave depth in only ``coverage`` of the view.

    ``coverage_of`` measures another capture in the same way: one with the images exchanged or
    flipped back, to see whether that was it.
    """
    only = f"only {coverage:.0%} of the view has depth"
    attempts: dict[str, Callable[[StereoShot], StereoShot]] = {
        "left and right images are swapped: exchange the cables or the files": _swapped,
        "the images are mirrored: switch the cameras' flip off": _mirrored,
        "the images are swapped and mirrored: mount the rig the right way round": (
            lambda shot: _mirrored(_swapped(shot))
        ),
    }
    for reason, change in attempts.items():
        changed = StereoCapture(
            tuple(change(shot) for shot in capture.shots[:1]), capture.serials, capture.bits
        )
        if coverage_of(changed) > max(LEAST_COVERAGE, 2 * coverage):
            return NoDepthError(f"{only}; {reason}")
    return NoDepthError(
        f"{only}; the images do not fit the calibration (camera moved, lens changed, or not "
        "exposed together): calibrate again"
    )


def _swapped(shot: StereoShot) -> StereoShot:
    return _with_images(shot, shot.right, shot.left)


def _mirrored(shot: StereoShot) -> StereoShot:
    return _with_images(shot, shot.left[:, ::-1], shot.right[:, ::-1])


def _with_images(shot: StereoShot, left: Image, right: Image) -> StereoShot:
    return StereoShot(
        left=left,
        right=right,
        left_region=shot.left_region,
        right_region=shot.right_region,
        block_id=shot.block_id,
        stamp_ns=shot.stamp_ns,
        exposure_s=shot.exposure_s,
    )


def _contrast(image: Image) -> float:
    """Median over the brighter half of the image of deviation over mean in 9 x 9 windows."""
    # A quarter of the rows and columns: the dots are random, so what is left is too.
    floats = image[::4, ::4].astype(np.float32)
    mean = cv2.blur(floats, (9, 9))
    variance = np.maximum(cv2.blur(floats * floats, (9, 9)) - mean * mean, 0)
    is_bright = mean >= np.median(mean)
    ratio = np.sqrt(variance[is_bright]) / np.maximum(mean[is_bright], 1)
    return float(np.median(ratio))
