"""The same promises over real sockets of this machine, in paced time."""

import pytest

from drivers.abb import RapidIo, RapidRobot
from hal.conformance import Bench, IoConformance, RobotConformance
from sims.controller.loopback import loopback_controller
from sims.controller.stage import ControllerStage
from sims.loop import PacedLoop
from sims.world import World

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]


def running():
    """A loop, and a controller whose package listens."""
    world = World()
    loop = PacedLoop(world)
    controller, connector = loopback_controller(world)

    async def start():
        await controller.power_on()
        await controller.start()
        await world.until(lambda: len(connector.ports) == 2)

    loop.run_until_complete(start())
    return loop, connector, ControllerStage(controller, connector)


class TestRapidRobotOverTcp(RobotConformance):
    backend = "abb-rapid"
    wire = "tcp"
    poll_s = 0.05

    def make_bench(self) -> Bench:
        loop, connector, stage = running()
        return Bench(loop, RapidRobot(connector), stage)


class TestRapidIoOverTcp(IoConformance):
    backend = "abb-io"
    wire = "tcp"

    def make_bench(self) -> Bench:
        loop, connector, stage = running()
        return Bench(loop, RapidIo(connector), stage)
