"""The rig that hangs over one world: cameras, projector and their faults share it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal
from weakref import WeakKeyDictionary

from sims.camera.bodies import Bodies
from sims.camera.primitives import AnyMesh
from sims.camera.render import StereoRenderer
from sims.camera.rig import RigTruth
from sims.camera.sensor import Sensor
from sims.world import World

__all__ = ["CameraFaults", "Lamp", "Stand", "hang_rig", "rig_over"]

Side = Literal["left", "right"]


@dataclass
class CameraFaults:
    """What can be wrong with pictures, made to order from outside.

    ``is_lamp_dead``: the projector gives no light whatever it is told. ``brightness`` scales
    all light: 0 is a covered lens, 20 saturates. ``are_swapped``: the cables are exchanged.
    ``is_mirrored``: both pictures are flipped left to right. ``dead``: these cameras never
    answer. ``frames_to_drop``: this many shots are lost on the wire. ``noise_scale``
    multiplies the sensors' noise.
    """

    is_lamp_dead: bool = False
    brightness: float = 1.0
    are_swapped: bool = False
    is_mirrored: bool = False
    dead: set[Side] = field(default_factory=set)
    frames_to_drop: int = 0
    noise_scale: float = 1.0


@dataclass
class Lamp:
    """The projector: which pattern it shows next; a step at each exposure."""

    is_on: bool = True
    sequence: tuple[int, ...] = (0,)
    step: int = 0

    def next_pattern(self) -> int | None:
        """The pattern of this exposure, None when dark; the sequence goes on either way."""
        pattern = self.sequence[self.step % len(self.sequence)]
        self.step += 1
        return pattern if self.is_on else None


class Stand:
    """One rig over one world."""

    def __init__(self, world: World, rig: RigTruth, bodies: Bodies, sensor: Sensor) -> None:
        self.world = world
        self.rig = rig
        self.renderer = StereoRenderer(rig, bodies, sensor)
        self.faults = CameraFaults()
        self.lamp = Lamp()


_STANDS: "WeakKeyDictionary[World, Stand]" = WeakKeyDictionary()


def hang_rig(
    world: World,
    *,
    seed: int = 0,
    part_meshes: Mapping[int, AnyMesh] | AnyMesh | None = None,
    sensor: Sensor | None = None,
) -> Stand:
    """Hang a rig over a world, in place of the one that may be there.

    Parameters
    ----------
    world
        What the cameras look at.
    seed
        Decides the true rig, its serial numbers and all noise.
    part_meshes
        How parts look: (vertices (n, 3) metres, triangles (m, 3)) in frame ``object``, one for
        all or by part number. None: their collision shapes.
    sensor
        Bits and noise; 8 bits by default.
    """
    bodies = Bodies(world.model, part_meshes)
    stand = Stand(world, RigTruth.seeded(seed), bodies, sensor or Sensor())
    _STANDS[world] = stand
    return stand


def rig_over(world: World) -> Stand:
    """Return the rig over a world; one of seed 0 is hung there if there is none."""
    return _STANDS.get(world) or hang_rig(world)
