"""The cloud stages do what their equations promise, wherever the cloud lies."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hal import rotation_from_rotvec
from perception.cloud import (
    find_keypoints,
    plane_normals,
    protrusion,
    remove_outliers,
    smooth_surface,
    thin_out,
)

RNG = np.random.default_rng(5)
TURN = rotation_from_rotvec([0.3, -0.5, 0.8])


def cylinder(count, *, radius_m=0.010, noise_m=0.0):
    """Return points on the camera-facing half of a cylinder along y, and their true normals."""
    rng = np.random.default_rng(1)
    angle = rng.uniform(-1.2, 1.2, count)
    normal = np.column_stack([np.sin(angle), np.zeros(count), -np.cos(angle)])
    place = np.column_stack([np.zeros(count), rng.uniform(-0.03, 0.03, count), np.full(count, 0.7)])
    return place + normal * (radius_m + rng.normal(size=count)[:, None] * noise_m), normal


def test_a_voxel_holds_the_centroid_of_its_points():
    corner = np.array([0.1, -0.2, 0.7])
    points = corner + RNG.uniform(0, 0.05, (5000, 3))
    points = np.concatenate([corner[None], points, [[np.nan, 0, 0]]])
    thin = thin_out(points, edge_m=0.01)
    low = points[:-1].min(axis=0)
    assert len(np.unique(np.floor((thin - low) / 0.01), axis=0)) == len(thin) <= 216
    counts = np.unique(np.floor((points[:-1] - low) / 0.01), axis=0, return_counts=True)[1]
    assert len(counts) == len(thin)
    order = np.lexsort((thin - low).T // 0.01)
    assert np.array_equal(order, np.arange(len(thin)))


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 400), st.floats(0.001, 0.5))
def test_thinning_keeps_the_mean_and_never_adds(count, edge_m):
    points = np.random.default_rng(count).normal(size=(count, 3))
    thin = thin_out(points, edge_m=edge_m)
    assert 1 <= len(thin) <= count
    assert (thin >= points.min(axis=0) - 1e-12).all()
    assert (thin <= points.max(axis=0) + 1e-12).all()


def test_a_voxel_needs_an_edge():
    with pytest.raises(ValueError, match="edge"):
        thin_out(np.zeros((3, 3)), edge_m=0.0)
    with pytest.raises(ValueError, match="too many"):
        thin_out(np.array([[0, 0, 0], [1e3, 1e3, 1e3]]), edge_m=1e-9)


def test_far_points_go_and_the_surface_stays():
    points, _ = cylinder(3000)
    far = points[:20] + [0.0, 0.0, -0.05]
    kept = remove_outliers(np.concatenate([points, far, [[np.nan] * 3]]))
    assert not kept[3000:].any()
    assert kept[:3000].mean() > 0.95


def test_normals_point_out_of_a_cylinder_to_the_camera():
    points, true = cylinder(4000)
    inner = np.abs(points[:, 1]) < 0.025
    cosine = (plane_normals(points) * true).sum(axis=1)[inner]
    assert np.percentile(cosine, 2) > 0.99


def test_turning_the_cloud_turns_the_normals():
    points, _ = cylinder(800)
    eye = np.array([0.1, 0.2, -0.3])
    turned = plane_normals(points @ TURN.T, eye_m=TURN @ eye)
    assert turned == pytest.approx(plane_normals(points, eye_m=eye) @ TURN.T, abs=1e-6)


def test_smoothing_halves_the_noise_and_bends_no_cylinder():
    noise_m = 0.0003
    points, true = cylinder(6000, noise_m=noise_m)
    smooth, normals = smooth_surface(points, radius_m=0.004, neighbours=60)
    inner = (np.abs(points[:, 1]) < 0.025) & (np.abs(true[:, 0]) < 0.8)
    off = np.hypot(smooth[:, 0], smooth[:, 2] - 0.7)[inner] - 0.010
    assert off.std() < 0.5 * noise_m
    assert abs(off.mean()) < 0.2 * noise_m
    assert np.median((normals * true).sum(axis=1)[inner]) > 0.99


def test_smoothing_looks_no_farther_than_its_radius():
    points, _ = cylinder(6000)
    shelf = points + [0.0, 0.0, -0.02]
    near, _ = smooth_surface(points, radius_m=0.002, neighbours=200)
    both, _ = smooth_surface(np.concatenate([points, shelf]), radius_m=0.002, neighbours=200)
    assert both[:6000] == pytest.approx(near, abs=2e-5)
    inner = np.abs(points[:, 1]) < 0.025
    assert np.abs(near - points)[inner].max() < 5e-5


def test_keypoints_sit_on_corners_and_not_on_planes():
    grid = np.linspace(-0.02, 0.02, 33)
    x, y = np.meshgrid(grid, grid)
    flat = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 0.7)])
    feature = protrusion(flat)
    middle = (np.abs(flat[:, :2]) < 0.012).all(axis=1)
    corner = np.abs(flat[:, :2]).min(axis=1) > 0.0199
    assert feature[corner].min() > 5 * feature[middle].max()
    found = flat[find_keypoints(flat, radius_m=0.008)]
    assert not (np.abs(found[:, :2]) < 0.012).all(axis=1).any()
    assert (np.abs(found[:, :2]).min(axis=1) > 0.0199).sum() == 4
