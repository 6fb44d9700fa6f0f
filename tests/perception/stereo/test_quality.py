from dataclasses import replace

import numpy as np
import pytest

from hal import Region, StereoCapture, StereoShot
from hal.errors import CellError, ConfigError, NoDepthError
from perception.depth import depth_view
from perception.quality import check_images, check_rig

RNG = np.random.default_rng(5)
REGION = Region(0, 0, 160, 120)
DOTS = np.kron(RNG.integers(20, 220, (40, 54)), np.ones((3, 3)))[:120, :160].astype(np.uint8)


def capture_of(left, right, *, regions=(REGION, REGION), bits=8, serials=("1", "2")):
    return StereoCapture((StereoShot(left, right, *regions, 0, 0, 0.01),), serials, bits)


def test_good_images_pass():
    check_images(capture_of(DOTS, DOTS))
    check_images(capture_of(DOTS.astype(np.uint16) * 16, DOTS.astype(np.uint16) * 16, bits=12))


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda image: image // 30, "dark"),
        (np.zeros_like, "dark"),
        (lambda image: np.minimum(image.astype(int) * 8, 255).astype(np.uint8), "saturated"),
        (lambda image: np.full_like(image, 90), "no texture"),
    ],
)
@pytest.mark.parametrize("side", ["left", "right"])
def test_a_bad_image_is_named_with_cause_and_cure(spoil, words, side):
    images = {"left": DOTS, "right": DOTS, side: spoil(DOTS)}
    with pytest.raises(NoDepthError) as caught:
        check_images(capture_of(**images))
    message = str(caught.value)
    assert words in message
    assert f"the {side} image of shot 0" in message
    assert "\n" not in message
    assert ": " in message


def test_images_of_another_rig_are_refused(look):
    other = StereoCapture(look.capture.shots, ("7", "8"))
    with pytest.raises(ConfigError, match="own calibration file"):
        depth_view(other, look.true, look.volume)
    exchanged = StereoCapture(look.capture.shots, look.true.serials[::-1])
    with pytest.raises(ConfigError, match="exchanged"):
        check_rig(exchanged, look.true)


def test_images_that_do_not_fit_their_regions_are_refused(look):
    shot = look.capture.shots[0]
    cut = replace(shot, left=shot.left[:-8])
    beyond = replace(shot, left_region=replace(shot.left_region, offset_x_px=1900))
    for spoilt, words in ((cut, "its region"), (beyond, "leaves the calibrated sensor")):
        capture = StereoCapture((spoilt,), look.true.serials)
        with pytest.raises(ConfigError, match=words):
            depth_view(capture, look.true, look.volume)


def test_shots_of_different_regions_do_not_make_a_capture(look):
    shot = look.capture.shots[0]
    shifted = replace(shot, right_region=replace(shot.right_region, offset_x_px=8))
    with pytest.raises(ConfigError, match="shot 1 has other regions"):
        depth_view(StereoCapture((shot, shifted), look.true.serials), look.true, look.volume)


def test_two_unrelated_pictures_give_an_error_and_no_depth(look):
    shot = look.capture.shots[0]
    upside_down = replace(shot, right=shot.right[::-1])
    with pytest.raises(CellError, match="do not fit the calibration"):
        depth_view(StereoCapture((upside_down,), look.true.serials), look.true, look.volume)
