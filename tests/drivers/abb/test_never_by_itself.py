"""Ways to make the arm go on by itself, or to lose the task that could stop it."""

import asyncio
import contextlib
from pathlib import Path

import pytest

from drivers.abb import messages as m
from drivers.abb.codec import encode
from hal.errors import CellError
from sims.controller.cfg import read_cfg
from sims.rapid.library.sockets import Sockets
from tests.drivers.abb.cell import moving, run, stays_short_of_there

CONTROLLER = Path(__file__).parents[3] / "drivers/abb/controller"


def stop_program(cell):
    return cell.controller.stop()


async def press_emergency_stop(cell):
    cell.controller.press_emergency_stop()


async def open_guard(cell):
    cell.controller.set_guard(True)


async def switch_motors_off(cell):
    cell.controller.motors_off()


@pytest.mark.parametrize("act", [stop_program, press_emergency_stop, open_guard, switch_motors_off])
@pytest.mark.parametrize("stops", [1, 3])
def test_stops_ordered_while_the_program_stands_do_not_break_it(act, stops):
    """Each counts the tick up, so several interrupts wait when it is started again."""

    async def main(cell):
        motion = await moving(cell)
        await act(cell)
        with pytest.raises(CellError):
            await motion
        for _ in range(stops):
            await cell.robot.stop()
        await cell.start()
        await asyncio.sleep(0.5)
        assert cell.controller.is_running
        assert (await cell.robot._session.fresh_state()).active == 0
        assert await cell.is_well()

    run(main)


def test_no_motion_is_said_to_be_under_way_after_an_emergency_stop():
    async def main(cell):
        motion = await moving(cell)
        cell.controller.press_emergency_stop()
        with pytest.raises(CellError):
            await motion
        await cell.start()
        await asyncio.sleep(0.5)
        assert (await cell.robot._session.fresh_state()).active == 0

    run(main)


@pytest.mark.parametrize("count", [2, 3, 4, 6, 10])
def test_several_stops_in_one_segment_leave_the_motion_task_well(count):
    async def main(cell):
        motion = await moving(cell)
        channel = cell.robot._session.channel
        first = channel._seq + 1
        channel._seq += count
        for seq in range(first, first + count):
            channel._forgotten[seq] = 1
        await channel._transport.send(
            b"".join(encode(seq, m.Stop()) for seq in range(first, first + count))
        )
        with pytest.raises(CellError):
            await motion
        await asyncio.sleep(0.3)
        assert cell.controller.is_running
        assert cell.robot._link._channel.is_open
        assert (await cell.robot._session.fresh_state()).active == 0
        assert await cell.is_well()

    run(main)


@pytest.mark.parametrize("pause_s", [0.003, 0.006, 0.01])
def test_a_program_that_is_stopped_and_started_at_once_does_not_go_on(pause_s):
    async def main(cell):
        motion = await moving(cell)
        await cell.controller.stop()
        await asyncio.sleep(pause_s)
        await cell.controller.start()
        assert await stays_short_of_there(cell)
        with pytest.raises(CellError):
            await motion

    run(main)


def test_a_frame_that_comes_slowly_does_not_hide_a_stop_of_the_program():
    async def main(cell):
        motion = await moving(cell, speed=0.05)
        stream, ping = cell.robot._session.channel._transport, encode(0, m.Ping())
        send = stream.send

        async def hush(data):
            del data

        stream.send = hush
        await send(ping[:1])
        await asyncio.sleep(0.02)
        await cell.controller.stop()
        await asyncio.sleep(0.3)
        await cell.controller.start()
        await asyncio.sleep(0.1)
        await send(ping[1:])
        stream.send = send
        assert await stays_short_of_there(cell)
        with pytest.raises(CellError):
            await motion

    run(main)


def test_a_client_that_speaks_and_does_not_listen_cannot_stall_the_monitor():
    async def main(cell):
        await cell.robot.close()
        await asyncio.sleep(0.2)
        deaf = await cell.connector.connect(5011)
        await deaf.send(encode(1, m.Hello(1, 0, 0)))
        with contextlib.suppress(ConnectionError):
            for _ in range(3000):
                await deaf.send(encode(2, m.AskState()))
                await asyncio.sleep(0.001)
        await asyncio.sleep(1.0)
        assert await cell.is_well()

    run(main)


def test_a_listener_that_broke_is_made_anew():
    async def main(cell):
        await cell.robot.close()
        await asyncio.sleep(0.3)
        for socket in cell.controller.system.tasks["T_BINPICK"].service(Sockets)._sockets:
            if socket.listener is not None:
                socket.listener.close()
        await asyncio.sleep(1.0)
        assert await cell.is_well()

    run(main)


def test_without_its_monitor_task_the_program_cannot_be_started():
    cfg, wrong = read_cfg(CONTROLLER / "SYS.cfg")
    assert not wrong
    monitor = next(item for item in cfg.section("CAB_TASKS") if item.name == "T_BINPICK")
    assert monitor.text("TrustLevel", "SysFail") in ("SysFail", "SysHalt")
