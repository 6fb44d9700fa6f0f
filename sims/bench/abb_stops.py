"""How far the arm goes on when its client asks it to stop, falls silent, or is gone."""

import asyncio
from collections.abc import Awaitable, Callable

import numpy as np

from drivers.abb import RapidRobot
from drivers.arms import Kinematics
from hal import Figure, LinearTarget, Transform
from hal.errors import CellError
from sims.controller.wire import MemoryConnector, running_package
from sims.loop import LockstepLoop
from sims.world import World

__all__ = ["run"]

SPEEDS_MPS = (0.25, 1.0)
START_RAD = (-0.7, 0.3, -0.1, 0.0, 1.3, 0.0)
WAY_M = 0.8
BEFORE_M = 0.15

Order = Callable[[RapidRobot, MemoryConnector], Awaitable[None]]


def run() -> list[Figure]:
    """``abb.stop_by_*``: from the order, or the last byte, to standstill; virtual time."""
    figures = []
    for name, order in (("request", _ask), ("silence", _fall_silent), ("lost_link", _pull)):
        for speed_mps in SPEEDS_MPS:
            time_s, distance_m = _stop(speed_mps, order)
            label = f"abb.stop_by_{name}_{speed_mps * 1000:.0f}mmps"
            figures.append(Figure(f"{label}_time", time_s, "s"))
            figures.append(Figure(f"{label}_distance", distance_m, "m"))
    return figures


async def _ask(robot: RapidRobot, connector: MemoryConnector) -> None:
    del connector
    await robot.stop()


async def _fall_silent(robot: RapidRobot, connector: MemoryConnector) -> None:
    del robot
    connector.mute()


async def _pull(robot: RapidRobot, connector: MemoryConnector) -> None:
    del robot
    connector.cut()


def _stop(speed_mps: float, order: Order) -> tuple[float, float]:
    world = World()
    kinematics = Kinematics(world.arm_model)
    loop = LockstepLoop(world)

    def place() -> np.ndarray:
        return np.asarray(kinematics.forward(world.arm.measured_rad)[:3, 3])

    async def main() -> tuple[float, float]:
        async with running_package(world) as connector:
            robot = RapidRobot(connector)
            await robot.open()
            await robot.move_joints(START_RAD)
            here = (await robot.state()).T_base_tcp
            start = place()
            goal_m = here.translation_m + (0.0, WAY_M, 0.0)
            goal = Transform.from_parts("base", "tcp", here.rotation, goal_m)
            motion = robot.move([LinearTarget(goal, speed_mps)])
            await world.until(lambda: float(np.linalg.norm(place() - start)) > BEFORE_M)
            began_s, begin = loop.time(), place()
            ordered = asyncio.ensure_future(order(robot, connector))
            await world.until(lambda: world.arm.is_standing)
            ended_s, end = loop.time(), place()
            for waited in (ordered, motion):
                try:
                    await waited
                except CellError:
                    continue
            await robot.close()
            return ended_s - began_s, float(np.linalg.norm(end - begin))

    try:
        return loop.run_until_complete(main())
    finally:
        loop.close()
