"""A settled pile for tests and benches, without arm motion or loop."""

from dataclasses import dataclass

from hal import Transform
from hal.errors import ConfigError
from perception.parts import Part, load_part
from sims.camera.bodies import Bodies, Poses
from sims.camera.stand import Stand, hang_rig
from sims.world import World
from sims.world.piles import fill
from sims.world.shapes import cylinders

__all__ = ["TrialScene", "trial_scene"]


@dataclass(frozen=True, eq=False)
class TrialScene:
    """A pile under a rig at one instant, and where the parts truly lie."""

    stand: Stand
    bodies: Bodies
    poses: Poses
    part: Part
    T_base_parts: tuple[Transform, ...]


def trial_scene(
    seed: int, parts: int, *, part_name: str = "shaft", part: Part | None = None
) -> TrialScene:
    """Drop ``parts`` turned parts into the standard bin; the arm stands at home.

    Raises
    ------
    ConfigError
        The part is not a turned one, or so many do not fit.
    """
    part = part or load_part(part_name)
    if part.profile is None:
        raise ConfigError("is not a turned part: take a shaft", source=part.name)
    shape = cylinders(part.profile.z_edges_m, part.profile.radii_m)
    world = World(shape=shape, parts=parts)
    fill(world, seed=seed)
    stand = hang_rig(world, seed=seed, part_meshes=(part.vertices_m, part.triangles))
    poses = tuple(world.part_pose(k) for k in range(parts))
    return TrialScene(stand, stand.renderer.bodies, Poses.of_world(world), part, poses)
