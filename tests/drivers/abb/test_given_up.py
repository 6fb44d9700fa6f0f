"""The driver given up, raced and cut, at every moment."""

import asyncio

import pytest

from hal import Tool, Transform
from hal.errors import CellError, LinkError
from tests.drivers.abb.cell import THERE, moving, run, stays_short_of_there


@pytest.mark.parametrize("spoil", ["abort", "rubbish"])
def test_the_motion_connection_alone_is_lost_in_a_move(spoil):
    async def main(cell):
        motion = await moving(cell)
        channel = cell.robot._link._channel
        if spoil == "abort":
            channel._transport.abort()
        else:
            channel._arrived(b"220 FTP ready\r\n")
        with pytest.raises(CellError):
            await motion
        assert await stays_short_of_there(cell)
        assert await cell.is_well()

    run(main)


def test_a_move_given_up_while_it_begins_leaves_the_arm_still():
    moved_ms = []
    for tenths in range(1, 12, 2):

        async def main(cell, after_s=tenths / 10_000):
            motion = cell.robot.move_joints(THERE, speed=0.05)
            await asyncio.sleep(after_s)
            motion.cancel()
            with pytest.raises(asyncio.CancelledError):
                await motion
            return await cell.stands()

        if not run(main):
            moved_ms.append(tenths / 10)
    assert moved_ms == []


@pytest.mark.parametrize("first_ms", range(2, 62, 20))
def test_a_move_given_up_later_leaves_the_arm_still_and_the_driver_well(first_ms):
    async def main(cell):
        for ms in range(first_ms, first_ms + 20):
            motion = cell.robot.move_joints(THERE, speed=0.05)
            await asyncio.sleep(ms / 1000)
            motion.cancel()
            with pytest.raises(asyncio.CancelledError):
                await motion
            assert await cell.stands()
            await cell.robot.state()
        assert await cell.is_well()

    run(main)


@pytest.mark.parametrize("after_s", [0.0001, 0.0005])
def test_an_open_that_was_given_up_leaves_nothing_behind(after_s):
    async def main(cell):
        await cell.robot.close()
        await asyncio.sleep(0.3)
        opening = asyncio.ensure_future(cell.robot.open())
        await asyncio.sleep(after_s)
        assert opening.cancel()
        with pytest.raises(asyncio.CancelledError):
            await opening
        await asyncio.sleep(1.0)
        names = {task.get_name() for task in asyncio.all_tasks()}
        left = names & {"abb heartbeat", "monitor reader"}
        for task in asyncio.all_tasks():
            if task.get_name() in left:
                task.cancel()
        assert not left

    run(main)


def test_opening_twice_at_once_is_closed_once():
    async def main(cell):
        await cell.robot.close()
        await asyncio.sleep(0.3)
        await asyncio.gather(cell.robot.open(), cell.robot.open())
        session = cell.robot._session
        await cell.robot.close()
        is_left = session.is_open
        if is_left:
            await session._close()
        assert not is_left

    run(main)


def test_a_setting_and_a_move_at_once_on_a_new_connection():
    async def main(cell):
        await cell.robot.close()
        await cell.robot.open()
        tool = Tool(Transform.from_translation("flange", "tcp", (0, 0, 0.1)))
        setting = cell.robot.set_tool(tool)
        moved = cell.robot.move_joints(THERE)
        errors = await asyncio.gather(setting, moved, return_exceptions=True)
        for error in errors:
            if isinstance(error, LinkError):
                raise error

    run(main)
