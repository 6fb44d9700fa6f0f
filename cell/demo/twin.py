"""The simulated cell of a demo: world, pile, rig, calibration file, and what is made wrong."""

from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, replace
from typing import Any

from cell.config import CellConfig
from cell.demo.controls import Controls, Images
from drivers.arms import ARMS
from hal import StereoCalibration, Tool, Transform
from hal.errors import ConfigError
from perception.parts import Part
from sims.camera.residual import calibration_for
from sims.camera.rig import nominal_calibration
from sims.camera.stand import Stand, hang_rig
from sims.controller.wire import running_package
from sims.world import PartShape, Physics, World, cylinders
from sims.world.piles import check_fit, fill

__all__ = ["Twin", "part_shape"]

DARK, DAZZLING = 0.02, 25.0


def part_shape(part: Part) -> PartShape:
    """Return the part as physics sees it: its outline as cylinders, its true mass."""
    profile = part.profile
    solid = cylinders(profile.z_edges_m, profile.radii_m, part.density_kgpm3)
    scale = part.mass_kg / solid.mass_kg
    across, _, along = (value * scale for value in solid.inertia)
    return replace(solid, mass_kg=part.mass_kg, inertia=(across, across, along))


@dataclass(eq=False)
class Twin:
    """A filled bin under a rig. ``calibration`` is what the cell is given, never the truth."""

    config: CellConfig
    part: Part
    world: World
    stand: Stand
    calibration: StereoCalibration
    controls: Controls

    @classmethod
    def filled(
        cls,
        config: CellConfig,
        part: Part,
        *,
        count: int,
        seed: int,
        controls: Controls | None = None,
    ) -> "Twin":
        """Build the world, drop the parts, hang the rig.

        Raises
        ------
        ConfigError
            An unknown arm, or parts that do not fit the bin.
        PileError
            The parts would not come to rest in the bin.
        """
        controls = controls or Controls()
        if config.arm not in ARMS:
            raise ConfigError(f"{config.arm!r} is unknown; known: {', '.join(sorted(ARMS))}")
        physics = Physics()
        if controls.pad_friction is not None:
            physics = replace(physics, pad_friction=controls.pad_friction)
        shape = part_shape(part)
        check_fit(shape, count, config.layout.bin)
        world = World(
            shape=shape,
            parts=count,
            layout=config.layout,
            arm=ARMS[config.arm],
            physics=physics,
        )
        fill(world, seed=seed)
        stand = hang_rig(world, seed=seed, part_meshes=(part.vertices_m, part.triangles))
        calibration = calibration_for(stand.rig, seed)
        if controls.has_nominal_calibration:
            calibration = replace(nominal_calibration(), serials=calibration.serials)
        twin = cls(config, part, world, stand, calibration, controls)
        twin._spoil()
        return twin

    @property
    def tool(self) -> Tool:
        """The gripper as the robot's tool, wrong if that was ordered."""
        place_m = (0.0, -self.controls.offset_m, self.config.fingers.tcp_m)
        return Tool(Transform.from_translation("flange", "tcp", place_m))

    @asynccontextmanager
    async def opened(self) -> AsyncIterator[Mapping[str, Any]]:
        """What the cell file's addresses mean, by scheme; controllers run as long as it is open."""
        async with AsyncExitStack() as running:
            opened: dict[str, Any] = {"sim": self.world}
            if self.config.robot.address.startswith("sim-abb:"):
                controller = running_package(self.world)
                opened["sim-abb"] = await running.enter_async_context(controller)
            yield opened

    def _spoil(self) -> None:
        faults, controls = self.stand.faults, self.controls
        faults.are_swapped = controls.images is Images.SWAPPED
        faults.is_mirrored = controls.images is Images.MIRRORED
        if controls.images is Images.DARK:
            faults.brightness = DARK
        if controls.images is Images.SATURATED:
            faults.brightness = DAZZLING
        if controls.has_one_finger:
            finger = self.world.model.geom("finger_right").id
            self.world.model.geom_contype[finger] = 0
            self.world.model.geom_conaffinity[finger] = 0
