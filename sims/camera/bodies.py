"""What stands in a MuJoCo world, as triangle meshes with a surface."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import mujoco
import numpy as np
from numpy.typing import NDArray

from sims.camera import primitives
from sims.camera.primitives import AnyMesh, Mesh
from sims.world import World

__all__ = ["Bodies", "Drawn", "Poses", "Surface"]

FIRST_HIDDEN_GROUP = 4
HOUSING = "camera"
"""A geom whose name begins so is the rig itself: it must not stand before its own lenses."""


@dataclass(frozen=True)
class Surface:
    """How a surface answers to light: Lambert's share and a Blinn-Phong highlight."""

    albedo: float
    specular: float


STILL = 1e-6
"""Metres, and radians as entries of a rotation."""

METAL = Surface(albedo=0.30, specular=0.35)


@dataclass(frozen=True, eq=False)
class Poses:
    """Where everything was at one instant: copies, so that physics may go on.

    Positions (n, 3) in metres and rotations (n, 3, 3), float64, in the base frame.
    """

    body_m: NDArray[np.float64]
    body_rotation: NDArray[np.float64]
    geom_m: NDArray[np.float64]
    geom_rotation: NDArray[np.float64]

    @classmethod
    def copied(cls, data: Any) -> Self:
        """Copy from an ``MjData`` whose kinematics are up to date."""
        return cls(
            data.xpos.copy(),
            data.xmat.reshape(-1, 3, 3).copy(),
            data.geom_xpos.copy(),
            data.geom_xmat.reshape(-1, 3, 3).copy(),
        )

    @classmethod
    def of_world(cls, world: World) -> Self:
        """Copy from a running world."""
        now = world.body_poses()
        return cls(now.position_m, now.rotation, now.geom_position_m, now.geom_rotation)


@dataclass(frozen=True, eq=False)
class Drawn:
    """One mesh and the body (or geom) it moves with; ``part`` is -1 for what is no part."""

    mesh: Mesh
    surface: Surface
    index: int
    is_body: bool
    part: int = -1

    def placed(self, poses: Poses) -> NDArray[np.float32]:
        """Vertices in the base frame, (n, 3) float32, metres."""
        rotations = poses.body_rotation if self.is_body else poses.geom_rotation
        positions = poses.body_m if self.is_body else poses.geom_m
        turned = np.einsum("nj,ij->ni", self.mesh[0], rotations[self.index], optimize=False)
        return np.asarray(turned + positions[self.index], np.float32)


class Bodies:
    """All that can be seen of a model.

    Bodies named ``part{k}`` are drawn with ``part_meshes[k]`` (a mapping by k, or one mesh for
    all) instead of their collision geoms. Geoms of group 4 and above, fully transparent ones
    and the rig's own housing are not drawn.
    """

    def __init__(
        self, model: Any, part_meshes: Mapping[int, AnyMesh] | AnyMesh | None = None
    ) -> None:
        self.drawn: list[Drawn] = []
        part_bodies: set[int] = set()
        for body in range(model.nbody):
            name = model.body(body).name
            if part_meshes is None or not (name.startswith("part") and name[4:].isdigit()):
                continue
            part = int(name[4:])
            mesh = part_meshes[part] if isinstance(part_meshes, Mapping) else part_meshes
            part_bodies.add(body)
            self.drawn.append(Drawn(_as_mesh(*mesh), METAL, body, is_body=True, part=part))
        for geom in range(model.ngeom):
            if model.geom_bodyid[geom] in part_bodies or _is_hidden(model, geom):
                continue
            found = _mesh_of(model, geom)
            if found is not None:
                self.drawn.append(Drawn(found, _surface(model, geom), geom, is_body=False))

    @property
    def surfaces(self) -> Sequence[Surface]:
        """One per drawn mesh, in order."""
        return [item.surface for item in self.drawn]

    @property
    def parts(self) -> NDArray[np.int32]:
        """Part number per drawn mesh, -1 for the rest."""
        return np.array([item.part for item in self.drawn], np.int32)


def _as_mesh(vertices: NDArray[Any], triangles: NDArray[Any]) -> Mesh:
    return (
        np.ascontiguousarray(vertices, dtype=np.float32),
        np.ascontiguousarray(triangles, dtype=np.uint32),
    )


def _rgba(model: Any, geom: int) -> NDArray[np.float64]:
    material = model.geom_matid[geom]
    rgba = model.mat_rgba[material] if material >= 0 else model.geom_rgba[geom]
    return np.asarray(rgba, float)


def _is_hidden(model: Any, geom: int) -> bool:
    return bool(
        model.geom_group[geom] >= FIRST_HIDDEN_GROUP
        or _rgba(model, geom)[3] == 0
        or model.geom(geom).name.startswith(HOUSING)
    )


def _surface(model: Any, geom: int) -> Surface:
    """Matt paint, as bright as the geom's colour."""
    luminance = float(_rgba(model, geom)[:3] @ (0.2126, 0.7152, 0.0722))
    return Surface(albedo=float(np.clip(0.6 * luminance, 0.03, 0.6)), specular=0.02)


def _mesh_of(model: Any, geom: int) -> Mesh | None:
    kinds = mujoco.mjtGeom
    size = model.geom_size[geom]
    kind = model.geom_type[geom]
    if kind == kinds.mjGEOM_BOX:
        return primitives.box(size)
    if kind == kinds.mjGEOM_CYLINDER:
        return primitives.cylinder(size[0], size[1])
    if kind == kinds.mjGEOM_CAPSULE:
        return primitives.capsule(size[0], size[1])
    if kind == kinds.mjGEOM_SPHERE:
        return primitives.ellipsoid((size[0],) * 3)
    if kind == kinds.mjGEOM_ELLIPSOID:
        return primitives.ellipsoid(size)
    if kind == kinds.mjGEOM_PLANE:
        return primitives.plane(size)
    if kind == kinds.mjGEOM_MESH:
        mesh = model.mesh(model.geom_dataid[geom])
        vertices = model.mesh_vert[mesh.vertadr[0] :][: mesh.vertnum[0]]
        return _as_mesh(vertices, model.mesh_face[mesh.faceadr[0] :][: mesh.facenum[0]])
    return None
