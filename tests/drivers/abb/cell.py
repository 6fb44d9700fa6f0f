"""The driver before a simulated controller that runs the shipped modules, with hands around."""

import asyncio

from drivers.abb import RapidRobot
from sims.controller import Controller, package_setup
from sims.controller.faults import ControllerFaults, FaultyNetwork
from sims.controller.wire import CONTROLLER_ADDRESS, MemoryConnector
from sims.loop import LockstepLoop
from sims.rapid.network import MemoryNetwork
from sims.world import World

__all__ = ["HOME", "THERE", "Cell", "moving", "run", "stays_short_of_there"]

HOME = (0.0, 0.0, 0.0, 0.0, 1.5707963, 0.0)
THERE = (0.5, 0.0, 0.0, 0.0, 1.5707963, 0.0)


class Cell:
    """``robot`` is open and at home when a test begins."""

    def __init__(self, world, overrides=None):
        self.world = world
        inside = MemoryNetwork(CONTROLLER_ADDRESS)
        self.network = FaultyNetwork(inside)
        self.connector = MemoryConnector(inside)
        self.stranger = MemoryConnector(inside, "10.0.0.9")
        self.controller = Controller(world, package_setup(overrides=overrides), self.network)
        self.faults = ControllerFaults(self.controller)
        self.robot = RapidRobot(self.connector)

    @property
    def joints_rad(self):
        return self.world.arm.measured_rad

    async def start(self):
        """Mend what can be mended at the cabinet, and press Start."""
        cabinet = self.world.cabinet
        cabinet.release_emergency_stop()
        cabinet.release_protective_stop()
        cabinet.switch_motors(True)
        await asyncio.sleep(0.02)
        if not self.controller.is_running:
            await self.controller.start()
        await asyncio.sleep(0.02)

    async def stands(self):
        """Whether the arm stands, a little after what should have stopped it, and stays."""
        await asyncio.sleep(0.15)
        before = self.joints_rad
        await asyncio.sleep(0.3)
        return abs(self.joints_rad - before).max() < 1e-4

    async def is_well(self):
        """The driver still works: reopened if its link was lost, and nothing more."""
        await self.robot.open()
        await self.robot.move_joints(HOME)
        state = await self.robot.move_joints(THERE, speed=0.5)
        return abs(state.joints_rad[0] - THERE[0]) < 1e-3


async def moving(cell, *, speed=0.1):
    """Begin a motion to ``THERE`` that takes seconds, and return it on its way."""
    motion = cell.robot.move_joints(THERE, speed=speed)
    await asyncio.sleep(0.3)
    assert cell.world.arm.is_following
    return motion


async def stays_short_of_there(cell):
    """Whether the arm was stopped on its way, and stays."""
    return await cell.stands() and abs(cell.joints_rad[0] - THERE[0]) > 0.05


def run(main, *, overrides=None):
    """Run a test's coroutine on a cell."""
    world = World()
    loop = LockstepLoop(world)

    async def whole():
        cell = Cell(world, overrides)
        async with cell.controller:
            await cell.controller.start()
            await cell.robot.open()
            await cell.robot.move_joints(HOME)
            try:
                return await main(cell)
            finally:
                await cell.robot.close()

    try:
        return loop.run_until_complete(whole())
    finally:
        loop.close()
