from collections import Counter

import numpy as np
import pytest

from hal import Region
from perception.rectify import distorted
from sims.camera import RigTruth, nominal_calibration
from sims.camera.lens import ray_slopes, undistorted
from sims.camera.primitives import box, capsule, cylinder, ellipsoid, revolved
from sims.camera.rig import HOUSING_SIZE_M, T_base_housing

SEEDS = range(10)


def test_rays_through_every_corner_of_the_sensor_come_back_to_their_pixel():
    for seed in SEEDS:
        true = RigTruth.seeded(seed).calibration
        for camera in (true.left, true.right):
            u, v = np.meshgrid(np.linspace(0, 1935, 23), np.linspace(0, 1215, 17))
            again = distorted(camera, *undistorted(camera, u, v))
            assert np.abs(again[0] - u).max() < 1e-8
            assert np.abs(again[1] - v).max() < 1e-8


def test_a_regions_rays_are_those_of_its_pixels():
    camera = RigTruth.seeded(1).calibration.left
    inner = ray_slopes(camera, Region(300, 200, 40, 30))
    outer = ray_slopes(camera, Region(290, 190, 60, 50))
    for a, b in zip(inner, outer, strict=True):
        np.testing.assert_array_equal(a, b[10:40, 10:50])
        assert not a.flags.writeable


@pytest.mark.parametrize(
    ("mesh", "volume", "tolerance"),
    [
        (box((0.1, 0.2, 0.3)), 8 * 0.006, 1e-6),
        (cylinder(0.1, 0.2), np.pi * 0.01 * 0.4, 3e-3),
        (capsule(0.1, 0.2), np.pi * 0.01 * 0.4 + 4 / 3 * np.pi * 0.001, 1e-2),
        (ellipsoid((0.1, 0.2, 0.3)), 4 / 3 * np.pi * 0.006, 1e-2),
        (revolved([(0.1, 0), (0.1, 1), (0.2, 1), (0.2, 2)]), np.pi * 0.05, 3e-3),
    ],
)
def test_shapes_have_outward_faces_and_their_volume(mesh, volume, tolerance):
    vertices, triangles = mesh
    corners = vertices[triangles].astype(float)
    signed = np.einsum("ni,ni->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert signed.sum() == pytest.approx(volume, rel=tolerance)
    edges = Counter((int(t[i]), int(t[(i + 1) % 3])) for t in triangles for i in range(3))
    assert all(edges[b, a] == count for (a, b), count in edges.items())


def test_the_true_rig_is_off_the_drawing_as_mounted_rigs_are():
    nominal = nominal_calibration()
    for seed in SEEDS:
        true = RigTruth.seeded(seed).calibration
        off = nominal.T_base_left.inverse() @ true.T_base_left.renamed("base", "true")
        assert 0.005 <= np.linalg.norm(off.translation_m) <= 0.020
        angle = np.degrees(np.arccos((np.trace(off.rotation) - 1) / 2))
        assert 0.5 <= angle <= 2.0
        assert 1e-5 < abs(true.baseline_m - nominal.baseline_m) + 1e-5 < 5e-4
        assert 1 < abs(true.left.focal_x_px - nominal.left.focal_x_px) < 8
        assert true.left.distortion != true.right.distortion


def test_a_seed_gives_one_rig_and_another_seed_another():
    assert RigTruth.seeded(3).calibration.serials == RigTruth.seeded(3).calibration.serials
    np.testing.assert_array_equal(
        RigTruth.seeded(3).calibration.T_base_left.matrix,
        RigTruth.seeded(3).calibration.T_base_left.matrix,
    )
    serials = {s for seed in range(200) for s in RigTruth.seeded(seed).calibration.serials}
    assert len(serials) == 400


def test_the_lenses_of_every_rig_look_out_of_the_housing():
    T_housing_base = T_base_housing().inverse()
    half = np.array(HOUSING_SIZE_M) / 2
    for seed in SEEDS:
        true = RigTruth.seeded(seed)
        left = true.calibration.T_base_left
        right = left @ true.calibration.T_left_right
        for pose in (left, right, true.projector.T_base_projector):
            place = T_housing_base.apply(pose.translation_m)
            assert (np.abs(place) < half - 0.005).all()
