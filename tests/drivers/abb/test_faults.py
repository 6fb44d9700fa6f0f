"""Every fault: seen to fire, a documented error, the arm standing, and the same driver goes on."""

import asyncio

import pytest

from drivers.abb import RapidIo
from drivers.abb import messages as m
from drivers.abb.codec import encode
from hal import OperatingMode
from hal.errors import (
    CollisionError,
    FaultError,
    LinkError,
    PreemptedError,
    RejectedError,
    SafetyError,
    UnreachableError,
)
from tests.drivers.abb.cell import HOME, THERE, moving, run, stays_short_of_there


def test_an_emergency_stop_in_a_move():
    async def main(cell):
        stopping = asyncio.ensure_future(cell.faults.stop_in_move())
        with pytest.raises(SafetyError, match="emergency"):
            await cell.robot.move_joints(THERE, speed=0.1)
        await stopping
        assert await stays_short_of_there(cell)
        with pytest.raises(SafetyError):
            await cell.robot.move_joints(HOME)
        cell.world.cabinet.release_emergency_stop()
        await asyncio.sleep(0.1)
        with pytest.raises(SafetyError, match="reset"):
            await cell.robot.move_joints(HOME)
        before = cell.joints_rad
        await cell.start()
        await asyncio.sleep(1.0)
        assert cell.joints_rad == pytest.approx(before, abs=1e-4)  # started, and nothing moves
        assert await cell.is_well()

    run(main)


def test_a_guard_that_opens_in_a_move():
    async def main(cell):
        motion = await moving(cell)
        cell.controller.set_guard(True)
        with pytest.raises(SafetyError, match="protective"):
            await motion
        assert await stays_short_of_there(cell)
        cell.controller.set_guard(False)
        await asyncio.sleep(0.1)
        with pytest.raises(RejectedError, match="Start"):
            await cell.robot.move_joints(HOME)
        await cell.start()
        assert await cell.is_well()

    run(main)


def test_the_key_is_turned_in_a_move():
    async def main(cell):
        motion = await moving(cell)
        cell.controller.set_mode(OperatingMode.MANUAL_REDUCED)
        with pytest.raises(RejectedError) as caught:
            await motion
        assert caught.value.code == "not in auto"
        assert await stays_short_of_there(cell)
        cell.controller.set_mode(OperatingMode.AUTO)
        await asyncio.sleep(0.1)
        await cell.start()
        assert await cell.is_well()

    run(main)


def test_the_program_is_stopped_in_a_move_with_its_sockets_open():
    async def main(cell):
        motion = await moving(cell)
        await cell.faults.stop_program()
        with pytest.raises(RejectedError) as caught:
            await motion
        assert caught.value.code == "program stopped"
        assert await stays_short_of_there(cell)
        assert cell.robot.is_open
        state = await cell.robot.state()  # the monitor task goes on
        assert not state.is_moving
        await cell.start()
        assert await stays_short_of_there(cell)
        assert await cell.is_well()

    run(main)


def test_the_controller_is_restarted_in_a_move():
    async def main(cell):
        motion = await moving(cell)
        await cell.faults.restart()
        with pytest.raises(LinkError):
            await motion
        assert await stays_short_of_there(cell)
        assert not cell.robot.is_open
        await cell.start()
        assert await cell.is_well()

    run(main)


def test_the_arm_runs_into_something():
    async def main(cell):
        colliding = asyncio.ensure_future(cell.faults.collide_in_move())
        with pytest.raises((CollisionError, FaultError, RejectedError)) as caught:
            await cell.robot.move_joints(THERE, speed=0.1)
        await colliding
        assert "supervision" in str(caught.value) or "program" in str(caught.value)
        assert await stays_short_of_there(cell)
        cell.controller.reset_error()
        await cell.start()
        assert await cell.is_well()

    run(main)


def test_all_connections_drop_in_a_move():
    async def main(cell):
        motion = await moving(cell)
        cell.network.drop_all()
        with pytest.raises(LinkError):
            await motion
        assert await stays_short_of_there(cell)
        assert await cell.is_well()

    run(main)


def test_the_client_ends_its_side_in_a_move():
    async def main(cell):
        motion = await moving(cell)
        cell.network.silence_all()
        with pytest.raises(LinkError):
            await motion
        assert await stays_short_of_there(cell)
        assert await cell.is_well()

    run(main)


def test_a_half_open_connection_stops_the_arm_within_the_watchdog():
    """Nothing arrives any more, either way, and nobody is told."""

    async def main(cell):
        await moving(cell)
        cell.connector.mute()
        began = asyncio.get_running_loop().time()
        await cell.world.until(lambda: not cell.world.arm.is_following)
        took_s = asyncio.get_running_loop().time() - began
        assert 0.3 < took_s < 0.5 + 0.1 + 0.1
        assert await stays_short_of_there(cell)
        await cell.robot.close()
        assert await cell.is_well()

    run(main)


def test_a_cable_pulled_and_plugged_in_again():
    async def main(cell):
        motion = await moving(cell)
        cell.connector.cut()
        with pytest.raises(LinkError):
            await motion
        with pytest.raises(LinkError, match="check"):
            await cell.robot.open()
        assert await stays_short_of_there(cell)
        cell.connector.mend()
        assert await cell.is_well()

    run(main)


@pytest.mark.parametrize(
    "fault", [{"cut_bytes": 1}, {"merge_s": 0.005}, {"delay_s": 0.02}], ids=str
)
def test_segments_split_merged_and_late_change_nothing(fault):
    async def main(cell):
        for name, value in fault.items():
            setattr(cell.network, name, value)
        await cell.robot.close()
        assert await cell.is_well()

    run(main)


def test_a_connection_dropped_at_every_byte_of_a_request():
    """The client's stream ends after so many bytes, within the greeting or a request after it."""

    async def main(cell):
        stream_bytes = (
            encode(1, m.Hello(1, 0, 0)) + encode(2, m.AskState()) + encode(3, m.Write(1, 1))
        )
        await cell.robot.close()
        for port in (5010, 5011):
            for size in range(len(stream_bytes) + 1):
                await asyncio.sleep(0.05)
                stream = await connect(cell, port)
                await stream.send(stream_bytes[:size])
                await asyncio.sleep(0.002)
                stream.close()
        await asyncio.sleep(0.6)
        assert cell.controller.is_running
        assert await cell.is_well()

    run(main)


async def connect(cell, port):
    for _ in range(200):
        try:
            return await cell.connector.connect(port)
        except ConnectionRefusedError:
            await asyncio.sleep(0.01)
    raise AssertionError(f"port {port} never listened again")


def test_a_target_out_of_reach_in_the_middle_of_the_queue_moves_nothing():
    """Told past the driver's own look at the way."""

    async def main(cell):
        session, link = cell.robot._session, cell.robot._link
        far = m.AddLinear((2.0, 0.0, 0.5), (0.0, 0.0, 1.0, 0.0), (0, 0, 0, 0), 0.2, 0.0)
        near = m.AddJoint(THERE, 0.2, 0.01)
        state = await session.fresh_state()
        with pytest.raises(UnreachableError, match="target 2"):
            await link.begin([near, far, near], state.tick)
        assert await cell.stands()
        assert cell.joints_rad == pytest.approx(HOME, abs=1e-3)
        assert await cell.is_well()

    run(main)


def test_a_line_that_leaves_the_reach_between_its_ends_stops_the_arm():
    async def main(cell):
        await cell.robot.move_joints((1.5, 0.9, -0.3, 0.0, 0.9, 0.0))
        state = await cell.robot.state()
        session, link = cell.robot._session, cell.robot._link
        x, y, z = state.T_base_tcp.translation_m
        there = m.AddLinear(
            (x, -y, z), tuple(state.T_base_tcp.quaternion_wxyz), (-1, 0, 0, 0), 0.3, 0.0
        )
        run_ = await link.begin(
            [m.AddJoint((1.45, 0.9, -0.3, 0, 0.9, 0), 0.2, 0.01), there],
            (await session.fresh_state()).tick,
        )
        outcome = await link.end(run_)
        assert outcome.result is m.Result.FAILED
        assert outcome.at == 2
        with pytest.raises((UnreachableError, FaultError)):
            await link.judge(outcome, is_stopping=False)
        assert await cell.stands()
        assert await cell.is_well()

    run(main)


def test_a_run_that_crosses_a_stop_never_begins():
    async def main(cell):
        session, link = cell.robot._session, cell.robot._link
        tick = (await session.fresh_state()).tick
        await cell.robot.stop()
        with pytest.raises(PreemptedError):
            await link.begin([m.AddJoint(THERE, 0.2, 0.0)], tick)
        assert await cell.stands()
        assert cell.joints_rad == pytest.approx(HOME, abs=1e-3)
        assert await cell.is_well()

    run(main)


def test_a_run_sent_to_a_stopped_program_does_not_begin_when_it_is_started():
    async def main(cell):
        session, link = cell.robot._session, cell.robot._link
        tick = (await session.fresh_state()).tick
        await cell.controller.stop()
        channel = link._channel
        await channel.begin(m.AddJoint(THERE, 0.2, 0.0))
        await channel.begin(m.Run(99, 1, tick), answers=2)
        await asyncio.sleep(0.3)
        await cell.start()
        await asyncio.sleep(1.0)
        assert cell.joints_rad == pytest.approx(HOME, abs=1e-3)
        assert await cell.is_well()

    run(main)


def test_a_port_that_is_in_use_is_tried_again():
    async def main(cell):
        await cell.robot.close()
        cell.network.busy_ports = {5010, 5011}
        await asyncio.sleep(2.0)
        with pytest.raises(LinkError):
            await cell.robot.open()
        cell.network.busy_ports = set()
        await asyncio.sleep(1.2)
        assert await cell.is_well()

    run(main)


def test_signals_are_served_while_the_arm_moves_and_while_the_program_is_stopped():
    async def main(cell):
        io = RapidIo(cell.connector)
        await io.open()
        motion = await moving(cell)
        await io.write("do3", True)
        assert cell.world.cabinet.outputs["do3"]
        await motion
        await cell.controller.stop()
        await io.write("do3", False)
        assert not cell.world.cabinet.outputs["do3"]
        await io.close()

    run(main)
