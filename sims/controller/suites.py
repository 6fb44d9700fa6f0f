"""The ABB driver under the conformance suites, with the shipped package behind the wire."""

from drivers.abb import RapidIo, RapidRobot
from hal.conformance import Bench, IoConformance, RobotConformance
from sims.controller.stage import ControllerStage
from sims.controller.wire import MemoryConnector, shipped_controller
from sims.loop import LockstepLoop
from sims.world import World

__all__ = ["TestRapidIo", "TestRapidRobot"]


def running() -> tuple[LockstepLoop, MemoryConnector, ControllerStage]:
    """Return a loop, a cable to a controller that runs the package, and its operator."""
    world = World()
    loop = LockstepLoop(world)
    controller, connector = shipped_controller(world)

    async def start() -> None:
        await controller.power_on()
        await controller.start()

    loop.run_until_complete(start())
    return loop, connector, ControllerStage(controller, connector)


class TestRapidRobot(RobotConformance):
    """The arm, driven by RAPID."""

    backend = "abb-rapid"
    # Joints are sampled each 2 ms, stamps are not: over 50 ms that is 4 % of a speed.
    poll_s = 0.05

    def make_bench(self) -> Bench:
        loop, connector, stage = running()
        return Bench(loop, RapidRobot(connector), stage)


class TestRapidIo(IoConformance):
    """The controller's signals."""

    backend = "abb-io"

    def make_bench(self) -> Bench:
        loop, connector, stage = running()
        return Bench(loop, RapidIo(connector), stage)
