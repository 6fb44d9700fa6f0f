"""Who is served, and what the controller allows whatever is asked."""

import asyncio

import pytest

from drivers.abb import RapidRobot
from drivers.abb import messages as m
from drivers.abb.codec import encode
from drivers.abb.session import Session
from hal import LinearTarget, Load, Transform
from hal.errors import (
    LinkError,
    RejectedError,
    UnreachableError,
)
from tests.drivers.abb.cell import HOME, THERE, moving, run


async def connect(cell, port):
    for _ in range(200):
        try:
            return await cell.connector.connect(port)
        except ConnectionRefusedError:
            await asyncio.sleep(0.01)
    raise AssertionError(f"port {port} never listened again")


def test_a_second_client_is_refused_and_the_first_is_not_disturbed():
    async def main(cell):
        motion = await moving(cell)
        other = RapidRobot(cell.connector, monitor_port=5011)
        # Another process has a session of its own: forget the shared one.
        with pytest.raises(LinkError, match="no other client"):
            await Session(cell.connector, "other")._connect(5011)
        assert not other.is_open
        await motion

    run(main)


def test_a_stranger_is_not_served():
    async def main(cell):
        await cell.robot.close()
        await asyncio.sleep(0.2)
        stranger = RapidRobot(cell.stranger)
        with pytest.raises(LinkError, match="BP_PEERS"):
            await stranger.open()
        await asyncio.sleep(0.2)
        assert await cell.is_well()

    run(main)


def test_a_motion_client_without_a_monitor_connection_is_refused():
    async def main(cell):
        await cell.robot.close()
        await asyncio.sleep(0.3)
        stream = await connect(cell, 5010)
        await stream.send(encode(1, m.Hello(1, 0, 1)))
        answer = await stream.receive(100)
        assert answer == encode(1, m.Refused(m.Code.NOT_PAIRED, 0))
        stream.close()
        assert await cell.is_well()

    run(main)


def test_the_controller_enforces_its_limits():
    limits = {
        "BP_MAX_SPEED": "100",
        "BP_MAX_JOINT_SHARE": "0.5",
        "BP_MAX_PAYLOAD": "1",
        "BP_BOX_MAX": "[1200, 300, 1600]",
    }

    async def main(cell):
        robot = cell.robot
        here = (await robot.state()).T_base_tcp
        near = Transform.from_parts(
            "base", "tcp", here.rotation, here.translation_m + (0, 0, -0.05)
        )
        with pytest.raises(RejectedError, match="BP_MAX_SPEED"):
            await robot.move([LinearTarget(near, 0.2)])
        with pytest.raises(RejectedError, match="BP_MAX_JOINT_SHARE"):
            await robot.move_joints(THERE, speed=0.8)
        with pytest.raises(RejectedError, match="BP_MAX_PAYLOAD"):
            await robot.set_load(Load(1.5))
        with pytest.raises(UnreachableError, match="BP_BOX"):
            await robot.move_joints((1.2, 0.0, 0.0, 0.0, 1.57, 0.0), speed=0.4)
        assert cell.joints_rad == pytest.approx(HOME, abs=1e-3)
        await robot.move([LinearTarget(near, 0.09)])
        await robot.set_load(Load(0.9))

    run_limited(main, limits)


def run_limited(main, limits):
    """The cell's own first move keeps to the limits too."""
    from tests.drivers.abb import cell as module

    async def slow(cell):
        return await main(cell)

    world = module.World()
    loop = module.LockstepLoop(world)

    async def whole():
        cell = module.Cell(world, limits)
        async with cell.controller:
            await cell.controller.start()
            await cell.robot.open()
            await cell.robot.move_joints(HOME, speed=0.3)
            await slow(cell)
            await cell.robot.close()

    try:
        loop.run_until_complete(whole())
    finally:
        loop.close()
