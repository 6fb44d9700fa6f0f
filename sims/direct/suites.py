"""The direct devices under the conformance suites; ``binpick conformance`` runs them too."""

from hal.conformance import (
    Bench,
    CameraConformance,
    GripperConformance,
    IoConformance,
    ProjectorConformance,
    RobotConformance,
)
from sims.camera.sensor import NOMINAL_EXPOSURE_S
from sims.camera.stand import rig_over
from sims.direct import DirectCamera, DirectGripper, DirectIo, DirectProjector, DirectRobot
from sims.direct.stage import WorldStage
from sims.loop import LockstepLoop
from sims.world import World, cylinders

__all__ = [
    "TestDirectCamera",
    "TestDirectGripper",
    "TestDirectIo",
    "TestDirectProjector",
    "TestDirectRobot",
]


class RigStage(WorldStage):
    """Hands at the rig over the world."""

    async def stop_frames(self) -> None:
        rig_over(self.world).faults.frames_to_drop = 1

    async def is_lit(self) -> bool:
        return rig_over(self.world).lamp.is_on


class TestDirectRobot(RobotConformance):
    """The arm on the world."""

    backend = "direct-robot"

    def make_bench(self) -> Bench:
        world = World()
        robot = DirectRobot(world)
        return Bench(LockstepLoop(world), robot, WorldStage(world, robot.name))


class TestDirectGripper(GripperConformance):
    """The fingers on the world."""

    backend = "direct-gripper"

    def make_bench(self) -> Bench:
        world = World(shape=cylinders([-0.03, 0.03], [0.010]), parts=1)
        gripper = DirectGripper(world)
        return Bench(LockstepLoop(world), gripper, WorldStage(world, gripper.name))


class TestDirectCamera(CameraConformance):
    """The rig over the world."""

    backend = "direct-camera"
    exposure_s = NOMINAL_EXPOSURE_S

    def make_bench(self) -> Bench:
        world = World()
        camera = DirectCamera(world)
        return Bench(LockstepLoop(world), camera, RigStage(world, camera.name))


class TestDirectProjector(ProjectorConformance):
    """The rig's light."""

    backend = "direct-projector"

    def make_bench(self) -> Bench:
        world = World()
        projector = DirectProjector(world)
        return Bench(LockstepLoop(world), projector, RigStage(world, projector.name))


class TestDirectIo(IoConformance):
    """The cabinet's signals."""

    backend = "direct-io"

    def make_bench(self) -> Bench:
        world = World()
        io = DirectIo(world)
        return Bench(LockstepLoop(world), io, WorldStage(world, io.name))
