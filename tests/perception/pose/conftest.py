"""Depth views ray-cast from posed meshes: an empty bin, shafts in it, and the noise of stereo.

Noise is correlated as a matching window leaves it, edges are fattened towards the foreground and
the strip that the right camera cannot see has no depth.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
import open3d as o3d
import pytest

from hal import Transform, rotation_from_rotvec
from perception.parts import Part, load_part
from perception.pose import BinVolume
from perception.view import DepthView

BIN_M = (0.36, 0.26, 0.14)
FOCAL_PX = 1365.0
BASELINE_M = 0.1
SIZE_PX = (700, 900)


@dataclass(frozen=True, eq=False)
class Scene:
    """A view with what it shows: true poses in frame ``camera``."""

    view: DepthView
    volume: BinVolume
    T_camera_parts: tuple[Transform, ...]


def lying(part: Part, x_m: float, y_m: float, turn_rad: float, *, lift_m: float = 0.0):
    """Return T_bin_object of a shaft on the floor, its axis at ``turn_rad`` from the bin's x."""
    # On its two largest radii on either side of the middle it lies nearly level.
    z = np.array([np.cos(turn_rad), np.sin(turn_rad), 0])
    up = np.array([0, 0, 1.0])
    rotation = np.column_stack([np.cross(up, z), up, z])
    return Transform.from_parts("bin", "object", rotation, [x_m, y_m, part.max_radius_m + lift_m])


def standing(part: Part, x_m: float, y_m: float):
    """Return T_bin_object of a shaft on its -z end."""
    return Transform.from_translation("bin", "object", [x_m, y_m, part.length_m / 2])


def camera_over_bin(tilt_rad=(0.02, -0.03, 0.4), height_m=0.72) -> Transform:
    rotation = np.diag([1.0, -1.0, -1.0]) @ rotation_from_rotvec(tilt_rad)
    centre = rotation[:, 2] * -height_m
    T_bin_camera = Transform.from_parts("bin", "camera", rotation, centre)
    return T_bin_camera.inverse()


def cast(part: Part, poses, T_camera_bin: Transform, *, noise_m=0.0, seed=0, boxes=()) -> Scene:
    """Ray-cast ``poses`` (T_bin_object) in the bin."""
    scene = o3d.t.geometry.RaycastingScene(nthreads=1)
    for pose in poses:
        _add(scene, (T_camera_bin @ pose).apply(part.vertices_m), part.triangles)
    length, width, height = BIN_M
    walls = [((0, 0, -0.005), (length, width, 0.01))]
    walls += [((s * (length / 2 + 0.003), 0, height / 2), (0.006, width, height)) for s in (-1, 1)]
    walls += [((0, s * (width / 2 + 0.003), height / 2), (length, 0.006, height)) for s in (-1, 1)]
    for centre, size in [*walls, ((0, 0, -0.06), (2, 2, 0.01)), *boxes]:
        box = o3d.geometry.TriangleMesh.create_box(*size)
        corners = np.asarray(box.vertices) - np.array(size) / 2 + centre
        _add(scene, T_camera_bin.apply(corners), np.asarray(box.triangles))
    rows, columns = SIZE_PX
    u, v = np.meshgrid(np.arange(columns), np.arange(rows))
    centre_x_px, centre_y_px = columns / 2 + 3.5, rows / 2 - 7.25
    rays = np.zeros((rows, columns, 6), np.float32)
    rays[..., 3] = (u - centre_x_px) / FOCAL_PX
    rays[..., 4] = (v - centre_y_px) / FOCAL_PX
    rays[..., 5] = 1
    depth_m = scene.cast_rays(o3d.core.Tensor(rays))["t_hit"].numpy()
    depth_m = np.where(np.isfinite(depth_m), depth_m, np.float32(np.nan))
    if noise_m > 0:
        depth_m = _as_stereo(depth_m, noise_m, seed)
    ones = np.ones_like(depth_m)
    view = DepthView(depth_m, ones, ones * 100, FOCAL_PX, centre_x_px, centre_y_px, BASELINE_M)
    volume = BinVolume(T_camera_bin, BIN_M)
    return Scene(view, volume, tuple(T_camera_bin @ pose for pose in poses))


def _add(scene, vertices_m, triangles) -> None:
    scene.add_triangles(
        o3d.core.Tensor(vertices_m.astype(np.float32)),
        o3d.core.Tensor(triangles.astype(np.uint32)),
    )


def _as_stereo(depth_m, noise_m: float, seed: int):
    rng = np.random.default_rng(seed)
    filled = np.where(np.isfinite(depth_m), depth_m, 2.0).astype(np.float32)
    fat = cv2.erode(filled, np.ones((3, 3), np.uint8))
    noise = cv2.GaussianBlur(rng.normal(size=depth_m.shape).astype(np.float32), (0, 0), 2.0)
    noisy = fat + noise_m * noise / noise.std()
    # Hidden from the right camera: what lies left of an edge, as far as the disparities differ.
    disparity_px = FOCAL_PX * BASELINE_M / fat
    u = np.arange(depth_m.shape[1])
    reached = np.minimum.accumulate((u - disparity_px)[:, ::-1], axis=1)[:, ::-1]
    hidden = (u - disparity_px) > np.roll(reached, -1, axis=1) + 0.5
    hidden[:, -1] = False
    noisy[hidden | (noisy > 1.5)] = np.nan
    return noisy


@pytest.fixture(scope="session")
def shaft() -> Part:
    return load_part("shaft")


@pytest.fixture(scope="session")
def look_into_bin() -> Callable[..., Scene]:
    return cast


@pytest.fixture(scope="session")
def lay() -> Callable[..., Transform]:
    return lying


@pytest.fixture(scope="session")
def stand_up() -> Callable[..., Transform]:
    return standing


@pytest.fixture(scope="session")
def over_bin() -> Callable[..., Transform]:
    return camera_over_bin


@pytest.fixture(scope="session")
def five_shafts(shaft) -> list[Transform]:
    """Apart, touching, crossing, and one end-on."""
    across = lying(shaft, 0.02, 0.02, 0.3, lift_m=0.029)
    return [
        lying(shaft, -0.10, 0.06, 0.2),
        lying(shaft, -0.095, 0.0305, 0.2),
        lying(shaft, 0.01, 0.03, 1.4),
        across,
        standing(shaft, 0.13, -0.08),
        lying(shaft, 0.05, -0.085, -2.9),
    ]
