from dataclasses import replace

import cv2
import numpy as np
import pytest

from hal import StereoCapture, Transform
from hal.errors import NoDepthError
from perception.coarse import coarse_by_sgbm, coarse_by_zncc
from perception.depth import depth_from_disparity, depth_view, disparity_of
from perception.match import BandMatcher, is_seen_twice
from perception.rectify import Pinhole, RectifiedPair
from sims.bench.depth import score
from sims.camera import nominal_calibration


def textures(rng, count, height=180, width=400):
    """Smooth random stripes and dots with four samples a pixel: no grid of their own."""
    for _ in range(count):
        fine = rng.random((height, 2 * width)) < 0.5
        grown = np.kron(fine, np.ones((4, 2), np.float32)).astype(np.float32)
        yield 40 + 150 * cv2.GaussianBlur(grown, (0, 0), 4.0)


def pinhole_of(width, height, low_px, high_px):
    return Pinhole(
        width_px=width,
        height_px=height,
        focal_px=1000.0,
        centre_x_px=width / 2,
        centre_y_px=height / 2,
        baseline_m=0.1,
        right_width_px=width + 60,
        right_shift_px=int(high_px) + 8,
        disparity_low_px=low_px,
        disparity_high_px=high_px,
    )


def pairs_of(disparity_px, pinhole, rng, count):
    """Pairs whose left view is the texture seen with this disparity (H, W) from the right one."""
    height, width = disparity_px.shape
    u, v = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    right_u, right_v = np.meshgrid(np.arange(pinhole.right_width_px, dtype=np.float32), v[:, 0])
    pairs = []
    for texture in textures(rng, count):
        left_at = u - disparity_px + pinhole.right_shift_px
        left = cv2.remap(texture, 4 * left_at + 40, 4 * v + 8, cv2.INTER_LINEAR)
        right = cv2.remap(texture, 4 * right_u + 40, 4 * right_v + 8, cv2.INTER_LINEAR)
        pairs.append(RectifiedPair(left, right))
    return pairs


@pytest.mark.parametrize("count", [1, 2, 4, 8])
def test_a_slanted_plane_is_recovered_without_bias(rng, count):
    height, width = 160, 240
    pinhole = pinhole_of(width, height, 20.0, 40.0)
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    true_px = (24.3 + 0.031 * u + 0.027 * v).astype(np.float32)
    found_px, found_score = disparity_of(pairs_of(true_px, pinhole, rng, count), pinhole)
    error_px = (found_px - true_px)[12:-12, 12:-12]
    assert np.isfinite(error_px).mean() > 0.97
    assert abs(np.nanmean(error_px)) < 0.01
    assert np.nanpercentile(np.abs(error_px), 95) < 0.12
    assert found_score.min() >= 0
    assert found_score.max() <= 1


def test_the_first_guess_is_right_to_a_pixel(rng):
    height, width = 160, 240
    pinhole = pinhole_of(width, height, 20.0, 40.0)
    u, _ = np.meshgrid(np.arange(width), np.arange(height))
    true_px = (22.0 + 0.06 * u).astype(np.float32)
    pairs = pairs_of(true_px, pinhole, rng, 4)
    left, right = [p.left for p in pairs], [p.right for p in pairs]
    given = {"shift_px": pinhole.right_shift_px, "low_px": 20.0, "high_px": 40.0}
    guesses = (
        coarse_by_zncc(left, right, **given),
        coarse_by_sgbm(left[0], right[0], top_level=255.0, **given),
    )
    for guess_px in guesses:
        error_px = (guess_px - true_px)[12:-12, 12:-12]
        assert abs(np.median(error_px)) < 0.2
        assert np.percentile(np.abs(error_px), 95) < 1.0


def test_no_fraction_of_a_pixel_is_preferred(rng):
    height, width = 120, 160
    pinhole = pinhole_of(width, height, 20.0, 40.0)
    biases = []
    for fraction in np.linspace(0, 0.9, 7):
        true_px = np.full((height, width), 28 + fraction, np.float32)
        found_px, _ = disparity_of(pairs_of(true_px, pinhole, rng, 4), pinhole)
        biases.append(float(np.nanmean((found_px - true_px)[12:-12, 12:-12])))
    assert np.abs(biases).max() < 0.015


def test_what_the_other_camera_cannot_see_is_not_seen_twice():
    disparity_px = np.full((4, 60), 20.0, np.float32)
    disparity_px[:, 30:40] = 30.0
    seen = is_seen_twice(disparity_px, shift_px=40, right_width_px=100)
    # The nearer strip hides the ten pixels on its left from the right camera.
    assert not seen[:, 20:30].any()
    assert seen[:, :20].all()
    assert seen[:, 30:].all()


def test_depth_is_focal_length_times_baseline_over_disparity():
    disparity_px = np.array([[200.0, 100.0, 0.0, -3.0, np.nan, 1.0]], np.float32)
    depth_m = depth_from_disparity(disparity_px, focal_px=1400.0, baseline_m=0.1)
    assert depth_m.dtype == np.float32
    assert depth_m[0, :2] == pytest.approx([0.7, 1.4])
    assert np.isnan(depth_m[0, 2:]).all()
    nearer = depth_from_disparity(disparity_px + 1, focal_px=1400.0, baseline_m=0.1)
    assert nearer[0, 0] < depth_m[0, 0]


@pytest.mark.parametrize(("shots", "rms_m", "within"), [(1, 0.36e-3, 0.8), (8, 0.20e-3, 0.88)])
def test_a_rendered_pile_is_measured(look, shots, rms_m, within):
    view = depth_view(look.first(shots), look.true, look.volume)
    scores = score(view.depth_m, look.truth)
    assert scores["interior_rms"] < rms_m
    assert abs(scores["bias"]) < 0.12e-3
    assert scores["within_1mm"] > within
    assert scores["gross"] < 0.05
    assert view.depth_m.shape == look.truth.depth_m.shape == view.image.shape


def test_points_on_the_bins_floor_lie_at_its_height_in_base(look):
    from perception.rectify import T_base_camera

    view = depth_view(look.first(4), look.estimated, look.volume)
    base = T_base_camera(look.estimated).apply(view.points())
    inside = (np.abs(base[..., 0] - 0.55) < 0.15) & (np.abs(base[..., 1]) < 0.10)
    floor = base[inside & (base[..., 2] < 0.056)]
    assert len(floor) > 10_000
    assert abs(np.median(floor[:, 2]) - 0.05) < 0.5e-3


def test_nominal_values_in_place_of_the_file_give_no_depth(look):
    wrong = replace(nominal_calibration(), serials=look.true.serials)
    with pytest.raises(NoDepthError, match="calibrat"):
        depth_view(look.first(4), wrong, look.volume)


def test_swapped_images_give_no_depth_and_say_so(look):
    shots = tuple(replace(s, left=s.right, right=s.left) for s in look.first(2).shots)
    with pytest.raises(NoDepthError, match="left and right images are swapped"):
        depth_view(StereoCapture(shots, look.true.serials), look.true, look.volume)


def test_mirrored_images_give_no_depth_and_say_so(look):
    shots = tuple(
        replace(s, left=s.left[:, ::-1], right=s.right[:, ::-1]) for s in look.first(2).shots
    )
    with pytest.raises(NoDepthError, match="the images are mirrored"):
        depth_view(StereoCapture(shots, look.true.serials), look.true, look.volume)


@pytest.mark.parametrize("shots", [1, 4])
def test_the_bits_do_not_depend_on_the_number_of_threads(look, shots):
    before = cv2.getNumThreads()
    results = []
    try:
        for threads in (1, 2, 3):
            cv2.setNumThreads(threads)
            view = depth_view(look.first(shots), look.estimated, look.volume)
            results.append(view.depth_m.tobytes() + view.confidence.tobytes())
    finally:
        cv2.setNumThreads(before)
    assert results[0] == results[1] == results[2]


def test_the_cut_between_the_bands_of_rows_changes_no_bit(rng):
    pinhole = pinhole_of(200, 120, 20.0, 40.0)
    pairs = pairs_of(np.full((120, 200), 27.4, np.float32), pinhole, rng, 3)
    matcher = BandMatcher([p.left for p in pairs], [p.right for p in pairs], pinhole.right_shift_px)
    base = np.full((120, 200), 27.0, np.float32)
    banded = matcher.scores(base, (-0.25, 0.4), (0.5, 1.6))
    whole = matcher._scores_of(slice(0, 120), base, (-0.25, 0.4), (0.5, 1.6))
    for mine, other in zip(banded, whole, strict=True):
        for a, b in zip(mine, other, strict=True):
            np.testing.assert_array_equal(a, b)


def test_without_a_volume_all_that_the_left_region_shows_is_measured(look):
    view = depth_view(look.first(1), look.true)
    region = look.capture.shots[0].left_region
    assert abs(view.depth_m.shape[0] - region.height_px) < 40
    assert abs(view.depth_m.shape[1] - region.width_px) < 40
    assert np.isfinite(view.depth_m).mean() > 0.4


def test_a_mount_that_moved_moves_the_points_and_nothing_else(look):
    """Depth is the cameras' own business; where they hang only moves the volume."""
    shift = Transform.from_translation("base", "base", (0.01, 0.0, 0.0))
    moved = replace(look.true, T_base_left=shift @ look.true.T_base_left)
    volume = replace(look.volume, T_base_bin=shift @ look.volume.T_base_bin)
    here = depth_view(look.first(1), look.true, look.volume)
    there = depth_view(look.first(1), moved, volume)
    np.testing.assert_array_equal(here.depth_m, there.depth_m)
