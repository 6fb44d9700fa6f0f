"""The distance table tells distances, and the fit and the renderer that stand on it agree."""

from itertools import pairwise

import numpy as np
import open3d as o3d
import pytest

from hal import rotation_from_rotvec
from hal.errors import ConfigError
from perception.parts import load_part
from perception.pose import build_model, grid
from perception.pose.field import revolution_field
from perception.pose.lsq import refine, rotations
from perception.pose.trace import trace

RNG = np.random.default_rng(3)


def box_of(part, *, margin_m=0.006):
    low, high = part.vertices_m.min(axis=0) - margin_m, part.vertices_m.max(axis=0) + margin_m
    points = RNG.uniform(low, high, (4000, 3))
    return points[np.hypot(points[:, 0], points[:, 1]) < part.max_radius_m + margin_m]


def true_distance(part, points):
    scene = o3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(
        o3d.core.Tensor(part.vertices_m.astype(np.float32)),
        o3d.core.Tensor(part.triangles.astype(np.uint32)),
    )
    return scene.compute_signed_distance(o3d.core.Tensor(points.astype(np.float32))).numpy()


@pytest.mark.parametrize("name", ["shaft", "shaft-stout", "shaft:30x8,12x60"])
def test_the_table_of_a_shaft_tells_the_distance_to_its_mesh(name):
    part = load_part(name)
    points = box_of(part)
    off = revolution_field(part).distance(points) - true_distance(part, points)
    assert np.abs(off).max() < 0.00012
    assert abs(off.mean()) < 0.00001


def test_a_tube_has_an_inside_that_is_outside():
    part = load_part("shaft:20x40")
    inner = np.hypot(part.vertices_m[:, 0], part.vertices_m[:, 1]) < 1e-9
    tube = load_part("shaft:20x40").vertices_m.copy()
    tube[inner] *= 0.6  # the poles drawn in: a cone sunk into each end
    sunk = type(part)("sunk", tube, part.triangles, 0, True, part.profile)
    points = box_of(sunk)
    assert (
        np.abs(revolution_field(sunk).distance(points) - true_distance(sunk, points)).max() < 2e-4
    )


def test_the_gradient_points_away_with_length_one(shaft):
    points = box_of(shaft)
    distance, gradient, inside = revolution_field(shaft).sample(points)
    assert inside.all()
    step = 1e-4
    ahead = revolution_field(shaft).distance(points + step * gradient)
    length = np.linalg.norm(gradient, axis=1)
    smooth = np.abs(length - 1) < 0.02
    assert smooth.mean() > 0.85
    assert ((ahead - distance)[smooth] / step).mean() == pytest.approx(1, abs=0.02)


def test_a_gear_is_tabulated_in_space_and_kept(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(grid, "STEP_M", 0.001)
    part = load_part("gear-small")
    field = grid.grid_field(part)
    points = box_of(part)
    assert np.abs(field.distance(points) - true_distance(part, points)).max() < 0.0007
    (kept,) = (tmp_path / "binpick" / "fields").iterdir()
    monkeypatch.setattr(grid, "_cast", lambda *_: pytest.fail("the cache was not used"))
    assert np.array_equal(grid.grid_field(part).table, field.table)
    kept.write_bytes(b"cut off")
    monkeypatch.setattr(grid, "_cast", lambda *_: field.table[..., 0])
    assert np.array_equal(grid.grid_field(part).table, field.table)


def test_a_part_without_the_ray_caster_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setitem(__import__("sys").modules, "open3d", None)
    with pytest.raises(ConfigError, match="sim"):
        build_model(load_part("gear-small"))


def surface_points(part, count=600):
    scene_points = build_model(part).samples_m
    return scene_points[RNG.integers(0, len(scene_points), count)]


@pytest.mark.parametrize("seed", range(5))
def test_a_shifted_and_tilted_pose_is_recovered_from_exact_points(shaft, seed):
    rng = np.random.default_rng(seed)
    true = np.eye(4)
    true[:3, :3] = rotation_from_rotvec(rng.normal(size=3))
    true[:3, 3] = [0.05, -0.1, 0.7]
    points = surface_points(shaft) @ true[:3, :3].T + true[:3, 3]
    start = true.copy()
    start[:3, :3] = true[:3, :3] @ rotation_from_rotvec(rng.normal(size=3) * 0.02)
    start[:3, 3] += rng.normal(size=3) * 0.001
    fit = refine(
        revolution_field(shaft), points[None], np.ones((1, len(points))), start[None],
        scales_m=(0.004, 0.002), iterations=12,
    )  # fmt: skip
    assert np.linalg.norm(fit.poses[0, :3, 3] - true[:3, 3]) < 3e-5
    assert fit.poses[0, :3, 2] @ true[:3, 2] > np.cos(2e-4)


def test_turning_the_scene_turns_the_fit(shaft):
    turn = rotation_from_rotvec([0.4, -0.9, 0.2])
    points = surface_points(shaft) + RNG.normal(size=(600, 3)) * 2e-4
    start = np.eye(4)
    start[:3, 3] = [0.0005, -0.0004, 0.0008]
    turned = np.eye(4)
    turned[:3, :3] = turn @ start[:3, :3]
    turned[:3, 3] = turn @ start[:3, 3]
    clouds = np.stack([points, points @ turn.T])
    fit = refine(
        revolution_field(shaft), clouds, np.ones(clouds.shape[:2]), np.stack([start, turned]),
        scales_m=(0.002,), iterations=15,
    )  # fmt: skip
    assert fit.poses[1, :3, 3] == pytest.approx(turn @ fit.poses[0, :3, 3], abs=2e-7)
    assert fit.poses[1, :3, 2] == pytest.approx(turn @ fit.poses[0, :3, 2], abs=2e-6)


def test_a_step_is_kept_only_when_the_loss_falls(shaft):
    field = revolution_field(shaft)
    points = surface_points(shaft)[None] + [0, 0, 0.7]
    start = np.eye(4)[None].copy()
    start[0, :3, 3] = [0.003, 0.002, 0.703]
    losses = [
        refine(
            field, points, np.ones(points.shape[:2]), start, scales_m=(0.002,), iterations=n
        ).losses_m2[0]
        for n in range(12)
    ]
    assert all(after <= before for before, after in pairwise(losses))
    assert losses[-1] < 0.05 * losses[0]


def test_no_start_however_bad_ends_worse(shaft):
    rng = np.random.default_rng(8)
    points = surface_points(shaft) * [1, 1, 1]
    points[::4] += rng.normal(size=(150, 3)) * 0.004
    starts = np.tile(np.eye(4), (40, 1, 1))
    starts[:, :3, :3] = rotations(rng.normal(size=(40, 3)) * 0.25)
    starts[:, :3, 3] = rng.normal(size=(40, 3)) * 0.004
    clouds = np.broadcast_to(points, (40, *points.shape))
    losses = [
        refine(
            revolution_field(shaft), clouds, np.ones((40, len(points))), starts,
            scales_m=(0.003,), iterations=n,
        ).losses_m2
        for n in (0, 1, 2, 3, 4, 6)
    ]  # fmt: skip
    for before, after in pairwise(losses):
        assert (after <= before + 1e-15).all()


def test_many_rotations_are_the_same_as_one_by_one():
    vectors = RNG.normal(size=(20, 3)) * 2
    expected = np.stack([rotation_from_rotvec(v) for v in vectors])
    assert rotations(vectors) == pytest.approx(expected, abs=1e-12)
    assert np.array_equal(rotations(np.zeros((1, 3)))[0], np.eye(3))


@pytest.mark.parametrize("rotvec", [(0, 0, 0), (1.5, 0.1, 0), (0.5, -1.0, 0.7), (np.pi, 0, 0)])
def test_a_ray_meets_the_model_where_it_meets_the_mesh(shaft, rotvec):
    pose = np.eye(4)
    pose[:3, :3] = rotation_from_rotvec(rotvec)
    pose[:3, 3] = [0.01, -0.02, 0.7]
    u, v = np.meshgrid(np.linspace(-0.1, 0.12, 90), np.linspace(-0.12, 0.08, 90))
    rays = np.stack([u.ravel(), v.ravel(), np.ones(u.size)], axis=1).astype(np.float32)
    scene = o3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(
        o3d.core.Tensor((shaft.vertices_m @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32)),
        o3d.core.Tensor(shaft.triangles.astype(np.uint32)),
    )
    six = np.concatenate([np.zeros_like(rays), rays], axis=1)
    true = scene.cast_rays(o3d.core.Tensor(six))["t_hit"].numpy()
    seen = trace(revolution_field(shaft), pose, rays)
    assert (np.isfinite(true) != np.isfinite(seen)).mean() < 0.01
    both = np.isfinite(true) & np.isfinite(seen)
    assert both.sum() > 50
    assert np.percentile(np.abs(true - seen)[both], 95) < 0.0004
