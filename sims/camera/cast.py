"""Rays into the scene: what each pixel sees, and how the projector lights it."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hal import Transform
from sims.camera.bodies import Bodies, Poses
from sims.camera.rig import ProjectorOptics

__all__ = ["Buffer", "Hits", "RayScene"]

AMBIENT = 0.06
SHININESS = 24.0
LAMP = 0.49
"""Irradiance at 1 m: about one at the bin's distance."""
LIFT_M = 2e-5
"""Shadow rays start this far off the surface."""

Plane = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Hits:
    """First hit of each ray, arrays (H, W).

    Depth along the camera's z in metres (inf: none), index of the drawn mesh (-1: none), unit
    normal towards the camera.
    """

    depth_m: Plane
    index: NDArray[np.int32]
    normal: tuple[Plane, Plane, Plane]


@dataclass(frozen=True, eq=False)
class Buffer:
    """What an image of any pattern takes: ``light = pattern(u, v) * lamp + ambient``."""

    lamp: Plane
    ambient: Plane
    u_px: Plane
    v_px: Plane


class RayScene:
    """All bodies at one instant, ready to be asked with rays."""

    def __init__(self, bodies: Bodies, poses: Poses) -> None:
        import open3d as o3d  # noqa: PLC0415  (two seconds)

        self._tensor = o3d.core.Tensor
        # One thread builds the tree: the same tree, so the same hit where triangles meet.
        self._scene: Any = o3d.t.geometry.RaycastingScene(nthreads=1)
        for item in bodies.drawn:
            self._scene.add_triangles(self._tensor(item.placed(poses)), self._tensor(item.mesh[1]))
        surfaces = bodies.surfaces
        self.parts = np.append(bodies.parts, np.int32(-1))
        self._albedo = np.array([s.albedo for s in surfaces] + [0.0], np.float32)
        self._specular = np.array([s.specular for s in surfaces] + [0.0], np.float32)

    def first_hits(
        self, T_base_camera: Transform, slopes: tuple[Plane, Plane]
    ) -> tuple[Hits, NDArray[np.float32]]:
        """Cast one ray a pixel; also return the rays (H, W, 6), direction z of one in the camera.

        The direction is not normalised, so that the distance to the hit is the depth.
        """
        rays = _rays(T_base_camera, slopes)
        answer = self._scene.cast_rays(self._tensor(rays))
        index = answer["geometry_ids"].numpy().astype(np.int32)
        index[index >= len(self._albedo) - 1] = -1
        index[index < 0] = -1
        normal = answer["primitive_normals"].numpy()
        nx, ny, nz = (np.ascontiguousarray(normal[..., i]) for i in range(3))
        away = nx * rays[..., 3] + ny * rays[..., 4] + nz * rays[..., 5]
        sign = -np.sign(away)
        hits = Hits(answer["t_hit"].numpy(), index, (nx * sign, ny * sign, nz * sign))
        return hits, rays

    def is_hidden_from(
        self,
        points: tuple[Plane, Plane, Plane],
        normal: tuple[Plane, Plane, Plane],
        eye_m: NDArray[np.float64],
    ) -> NDArray[np.bool_]:
        """Whether something stands between each point (H, W) and ``eye_m``."""
        rays = np.empty((*points[0].shape, 6), np.float32)
        for axis in range(3):
            rays[..., axis] = points[axis] + normal[axis] * np.float32(LIFT_M)
            rays[..., 3 + axis] = np.float32(eye_m[axis]) - points[axis]
        hidden = self._scene.test_occlusions(self._tensor(rays), tnear=1e-4, tfar=1.0)
        return np.asarray(hidden.numpy(), bool)

    def buffer(
        self, T_base_camera: Transform, slopes: tuple[Plane, Plane], projector: ProjectorOptics
    ) -> Buffer:
        """The one geometry pass: after it, a pattern costs a look-up."""
        hits, rays = self.first_hits(T_base_camera, slopes)
        points = hit_points(hits, rays)
        lamp_m = projector.T_base_projector.translation_m
        is_lit = ~self.is_hidden_from(points, hits.normal, lamp_m)
        u_px, v_px, is_inside = into_projector(projector, points)
        diffuse, highlight = _shading(hits.normal, rays, points, lamp_m)
        albedo, specular = self._albedo[hits.index], self._specular[hits.index]
        lamp = albedo * diffuse + specular * highlight
        lamp *= is_lit & is_inside
        ambient = albedo * np.float32(AMBIENT)
        ambient *= np.float32(0.6) + np.float32(0.4) * np.abs(hits.normal[2])
        return Buffer(lamp, ambient, u_px, v_px)


def _rays(T_base_camera: Transform, slopes: tuple[Plane, Plane]) -> NDArray[np.float32]:
    x, y = slopes
    rotation = T_base_camera.rotation.astype(np.float32)
    rays = np.empty((*x.shape, 6), np.float32)
    rays[..., :3] = T_base_camera.translation_m.astype(np.float32)
    for axis in range(3):
        rays[..., 3 + axis] = rotation[axis, 0] * x + rotation[axis, 1] * y + rotation[axis, 2]
    return rays


def hit_points(hits: Hits, rays: NDArray[np.float32]) -> tuple[Plane, Plane, Plane]:
    """Where the rays end, base frame, metres; the camera's own place where they do not."""
    depth = np.where(np.isfinite(hits.depth_m), hits.depth_m, np.float32(0))
    x, y, z = (rays[..., i] + rays[..., 3 + i] * depth for i in range(3))
    return x, y, z


def into_projector(
    projector: ProjectorOptics, points: tuple[Plane, Plane, Plane]
) -> tuple[Plane, Plane, NDArray[np.bool_]]:
    """Projector pixel (u, v) of each point, and whether it lies in the projector's image."""
    T = projector.T_base_projector
    rotation = T.rotation.astype(np.float32)
    x, y, z = (points[i] - np.float32(T.translation_m[i]) for i in range(3))
    qx, qy, qz = (rotation[0, i] * x + rotation[1, i] * y + rotation[2, i] * z for i in range(3))
    scale = np.float32(projector.focal_px) / np.maximum(qz, np.float32(1e-6))
    u = qx * scale + np.float32((projector.width_px - 1) / 2)
    v = qy * scale + np.float32((projector.height_px - 1) / 2)
    is_inside = (qz > 0) & (u >= -0.5) & (u <= projector.width_px - 0.5)
    is_inside &= (v >= -0.5) & (v <= projector.height_px - 0.5)
    return u, v, is_inside


def _shading(
    normal: tuple[Plane, Plane, Plane],
    rays: NDArray[np.float32],
    points: tuple[Plane, Plane, Plane],
    lamp_m: NDArray[np.float64],
) -> tuple[Plane, Plane]:
    """Lambert's cosine and Blinn and Phong's highlight, times the lamp's irradiance."""
    nx, ny, nz = normal
    lx, ly, lz = (np.float32(lamp_m[i]) - points[i] for i in range(3))
    inverse = 1 / np.sqrt(lx * lx + ly * ly + lz * lz)
    lx, ly, lz = lx * inverse, ly * inverse, lz * inverse
    vx, vy, vz = rays[..., 3], rays[..., 4], rays[..., 5]
    length = 1 / np.sqrt(vx * vx + vy * vy + vz * vz)
    hx, hy, hz = lx - vx * length, ly - vy * length, lz - vz * length
    cosine = np.maximum(nx * lx + ny * ly + nz * lz, np.float32(0))
    half = np.maximum(nx * hx + ny * hy + nz * hz, np.float32(0))
    half /= np.sqrt(hx * hx + hy * hy + hz * hz)
    irradiance = np.float32(LAMP) * inverse * inverse
    highlight = np.power(half, np.float32(SHININESS)) * (cosine > 0)
    return irradiance * cosine, irradiance * highlight
