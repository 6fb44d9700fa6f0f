from dataclasses import replace

import numpy as np
import pytest

from hal import Bin, Region, Transform
from hal.errors import NoDepthError
from perception.rectify import (
    T_base_camera,
    T_left_camera,
    distorted,
    rectifier_for,
    regions_for,
)
from perception.volume import Volume
from sims.camera import RigTruth, calibration_for, nominal_calibration
from sims.camera.lens import undistorted

TRUE = RigTruth.seeded(4).calibration
WHOLE = Region(0, 0, 1936, 1216)
VOLUME = Volume.of_bin(Bin())


def points_in(volume, rng, count=300):
    inside = rng.uniform(volume.low_m, volume.high_m, (count, 3))
    return volume.T_base_bin.apply(inside)


def seen(calibration, points_base):
    """Raw pixels (n, 2) of points in the left and right camera."""
    left = calibration.T_base_left.inverse().apply(points_base)
    right = calibration.T_left_right.inverse().apply(left)
    return [
        np.stack(distorted(camera, p[:, 0] / p[:, 2], p[:, 1] / p[:, 2]), axis=1)
        for camera, p in ((calibration.left, left), (calibration.right, right))
    ]


def triangulated(calibration, pixels):
    """Points in base, and the row difference in pixels, by this calibration alone."""
    rotation = T_left_camera(calibration).rotation
    rays = []
    turns = (rotation, calibration.T_left_right.rotation.T @ rotation)
    for camera, p, turn in zip((calibration.left, calibration.right), pixels, turns, strict=True):
        x, y = undistorted(camera, p[:, 0], p[:, 1])
        ray = np.column_stack([x, y, np.ones_like(x)]) @ turn
        rays.append(ray[:, :2] / ray[:, 2:])
    depth_m = calibration.baseline_m / (rays[0][:, 0] - rays[1][:, 0])
    points = np.column_stack([rays[0], np.ones_like(depth_m)]) * depth_m[:, None]
    rows_px = (rays[0][:, 1] - rays[1][:, 1]) * calibration.left.focal_x_px
    return T_base_camera(calibration).apply(points), rows_px


def test_a_point_projected_into_both_cameras_is_recovered(rng):
    points = points_in(VOLUME, rng)
    found, rows_px = triangulated(TRUE, seen(TRUE, points))
    assert np.abs(found - points).max() < 1e-9
    assert np.abs(rows_px).max() < 1e-6


def test_the_maps_lead_from_rectified_pixels_to_the_raw_pixels_of_the_same_point(rng):
    regions = regions_for(TRUE, VOLUME)
    rectify = rectifier_for(TRUE, *regions, VOLUME)
    pinhole = rectify.pinhole
    points = points_in(VOLUME, rng)
    camera = T_base_camera(TRUE).inverse().apply(points)
    u = camera[:, 0] / camera[:, 2] * pinhole.focal_px + pinhole.centre_x_px
    v = camera[:, 1] / camera[:, 2] * pinhole.focal_px + pinhole.centre_y_px
    disparity_px = pinhole.focal_px * pinhole.baseline_m / camera[:, 2]
    columns = (u, u - disparity_px + pinhole.right_shift_px)
    raw = seen(TRUE, points)
    maps = (rectify.left_maps, rectify.right_maps)
    for side in (0, 1):
        column, row = np.rint(columns[side]).astype(int), np.rint(v).astype(int)
        x, y = (table[row, column] for table in maps[side])
        offset = (regions[side].offset_x_px, regions[side].offset_y_px)
        # Half a pixel each way is rounding; rectification turns and scales by little.
        assert np.abs(x + offset[0] - raw[side][:, 0]).max() < 0.6
        assert np.abs(y + offset[1] - raw[side][:, 1]).max() < 0.6


def test_regions_see_the_whole_volume_and_have_one_size():
    left, right = regions_for(TRUE, VOLUME)
    assert (left.width_px, left.height_px) == (right.width_px, right.height_px)
    for region, pixels in zip((left, right), seen(TRUE, VOLUME.corners_base()), strict=True):
        low = np.array([region.offset_x_px, region.offset_y_px])
        high = low + (region.width_px, region.height_px)
        assert (pixels >= low).all()
        assert (pixels < high).all()
        assert region.is_inside(1936, 1216)


def test_a_volume_out_of_sight_is_refused():
    aside = replace(VOLUME, T_base_bin=Transform.from_translation("base", "bin", (3.0, 0, 0)))
    behind = replace(VOLUME, T_base_bin=Transform.from_translation("base", "bin", (0.5, 0, 2)))
    for volume in (aside, behind):
        with pytest.raises(NoDepthError, match="T_base_left"):
            regions_for(TRUE, volume)
        with pytest.raises(NoDepthError):
            rectifier_for(TRUE, WHOLE, WHOLE, volume)


def test_the_calibration_file_is_good_to_a_fraction_of_a_millimetre(rng):
    rig = RigTruth.seeded(4)
    points = points_in(VOLUME, rng)
    estimated = calibration_for(rig, 4)
    found, rows_px = triangulated(estimated, seen(TRUE, points))
    error_m = np.linalg.norm(found - points, axis=1)
    assert 1e-5 < np.sqrt((error_m**2).mean()) < 7e-4
    assert np.abs(rows_px).max() < 0.05


def test_nominal_values_are_wrong_by_centimetres(rng):
    points = points_in(VOLUME, rng)
    found, rows_px = triangulated(nominal_calibration(), seen(TRUE, points))
    error_m = np.linalg.norm(found - points, axis=1)
    assert np.median(error_m) > 0.005
    assert np.abs(rows_px).mean() > 1.0
