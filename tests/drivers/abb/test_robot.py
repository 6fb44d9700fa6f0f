"""The driver against a scripted controller."""

import asyncio
from dataclasses import replace

import pytest

from drivers.abb import RapidIo, RapidRobot
from drivers.abb import messages as m
from drivers.abb.codec import encode
from hal import JointTarget, Load, Tool, Transform
from hal.errors import (
    DeviceTimeoutError,
    FaultError,
    LinkError,
    PreemptedError,
    RejectedError,
    RemoteProtocolError,
    SafetyError,
    UnreachableError,
)
from tests.drivers.abb.peer import run

HOME = (0.0, 0.0, 0.0, 0.0, 1.57, 0.0)
NONE = m.Flag(0)
THERE = (0.3, 0.0, 0.0, 0.0, 1.57, 0.0)


def with_robot(main, **options):
    async def whole(peer):
        robot = RapidRobot(peer.connector)
        await robot.open()
        try:
            return await main(peer, robot)
        finally:
            await robot.close()

    return run(whole, **options)


def flags(peer, *, on=NONE, off=NONE):
    peer.state = replace(peer.state, flags=(peer.state.flags | on) & ~off)


def test_a_move_is_queued_and_run_with_the_tick_it_was_decided_on():
    async def main(peer, robot):
        await robot.move([JointTarget(THERE, 0.5, 0.01), JointTarget(HOME)])
        return peer.heard

    heard = with_robot(main)
    adds = [message for message in heard if isinstance(message, m.AddJoint)]
    assert [add.share for add in adds] == [0.5, 1.0]
    assert adds[0].zone_m == pytest.approx(0.01)
    assert adds[0].joints_rad == pytest.approx(THERE)
    runs = [message for message in heard if isinstance(message, m.Run)]
    assert runs == [m.Run(1, 2, 3)]


def test_opening_says_who_the_controller_is_and_moves_nothing():
    async def main(peer, robot):
        return await robot.identity(), list(peer.heard)

    identity, heard = with_robot(main)
    assert (identity.vendor, identity.model, identity.firmware) == ("ABB", "IRB 1200-5/0.9", "6.08")
    assert {type(message) for message in heard} == {m.Hello, m.AskSignals, m.AskState, m.Identify}


def test_a_new_motion_connection_is_told_tool_and_load_before_anything_else():
    async def main(peer, robot):
        T_flange_tcp = Transform.from_translation("flange", "tcp", (0, 0, 0.16))
        await robot.set_tool(Tool(T_flange_tcp, Load(0.67, (0, 0, 0.08))))
        await robot.set_load(Load(0.3, (0, 0, 0.17)))
        peer.streams[5010].abort()
        await asyncio.sleep(0.01)
        peer.heard.clear()
        await robot.move_joints(THERE)
        return peer.heard

    heard = [
        message for message in with_robot(main) if not isinstance(message, m.AskState | m.Ping)
    ]
    assert isinstance(heard[0], m.Hello)
    assert heard[0].epoch == 77
    assert heard[1].position_m == pytest.approx((0, 0, 0.16))
    assert heard[1].mass_kg == pytest.approx(0.67)
    assert heard[2].centre_m == pytest.approx((0, 0, 0.01))


@pytest.mark.parametrize(
    ("code", "error", "words"),
    [
        (m.Code.OUT_OF_REACH, UnreachableError, "target 2: the target is out of reach"),
        (m.Code.JOINT_LIMIT, UnreachableError, "range"),
        (m.Code.OUTSIDE_BOX, UnreachableError, "BP_BOX"),
        (m.Code.TOO_FAST, RejectedError, "BP_MAX_SPEED"),
        (m.Code.TOO_HEAVY, RejectedError, "BP_MAX_PAYLOAD"),
        (m.Code.NOT_PAIRED, RejectedError, "reopen"),
        (m.Code.EMERGENCY_STOP, SafetyError, "emergency"),
        (m.Code.STOP_ORDERED, PreemptedError, "stop"),
        (m.Code.INTERNAL, FaultError, "event log"),
    ],
)
def test_a_refusal_becomes_the_error_that_says_what_to_do(code, error, words):
    async def main(peer, robot):
        peer.script[m.Run] = lambda frame: encode(frame.seq, m.Refused(code, 2))
        with pytest.raises(error, match=words):
            await robot.move_joints(THERE)
        del peer.script[m.Run]
        await robot.move_joints(THERE)

    with_robot(main)


def test_a_refused_target_ends_the_motion_before_it_begins():
    async def main(peer, robot):
        peer.script[m.AddJoint] = lambda frame: encode(frame.seq, m.Refused(m.Code.TOO_FAST, 1))
        peer.script[m.Run] = lambda frame: encode(frame.seq, m.Refused(m.Code.BAD_ARGUMENT, 0))
        with pytest.raises(RejectedError) as caught:
            await robot.move_joints(THERE)
        assert caught.value.code == "too_fast"
        peer.script.clear()
        await robot.move_joints(THERE)

    with_robot(main)


def test_a_failed_motion_says_where_and_why():
    async def main(peer, robot):
        def fail(frame):
            outcome = m.Outcome(m.Result.FAILED, m.Code.JOINT_LIMIT, frame.message.id, 2)
            return encode(frame.seq, m.Accepted(1)) + encode(frame.seq, outcome)

        peer.script[m.Run] = fail
        with pytest.raises(UnreachableError, match="target 2"):
            await robot.move_joints(THERE)

    with_robot(main)


def test_a_late_answer_never_passes_for_anothers():
    """The answer to a given-up request comes after the next request was sent."""

    async def main(peer, robot):
        held = []
        peer.script[m.AskState] = lambda frame: (held.append(frame.seq), b"")[1]
        with pytest.raises(DeviceTimeoutError):
            await robot.state()
        lie = replace(peer.now(), joints_rad=(1.0,) * 6)
        peer.script[m.AskState] = lambda frame: encode(held[0], lie) + encode(frame.seq, peer.now())
        return (await robot.state()).joints_rad

    assert with_robot(main) == pytest.approx(HOME)


def test_an_answer_that_nobody_asked_for_ends_the_link():
    async def main(peer, robot):
        peer.script[m.AskState] = lambda frame: encode(frame.seq + 1, peer.now())
        with pytest.raises(RemoteProtocolError, match="nobody asked"):
            await robot.state()
        assert not robot.is_open
        peer.script.clear()
        await robot.open()
        await robot.state()

    with_robot(main)


def test_a_wrong_kind_of_answer_is_not_believed():
    async def main(peer, robot):
        peer.script[m.AskState] = lambda frame: encode(frame.seq, m.Accepted(1))
        with pytest.raises(RemoteProtocolError):
            await robot.state()

    with_robot(main)


def test_rubbish_ends_the_link_and_reopening_mends_it():
    async def main(peer, robot):
        peer.script[m.AskState] = lambda frame: b"220 FTP ready\r\n"
        with pytest.raises(RemoteProtocolError):
            await robot.state()
        with pytest.raises(LinkError):
            await robot.state()
        peer.script.clear()
        await robot.open()
        await robot.state()

    with_robot(main)


def test_a_controller_that_falls_silent_is_noticed():
    async def main(peer, robot):
        motion = robot.move_joints(THERE)
        await asyncio.sleep(0.05)
        with pytest.raises(LinkError, match="silent"):
            await motion
        assert not robot.is_open

    async def silent(peer):
        peer.sends_state = False
        peer.motion_s = 10.0
        robot = RapidRobot(peer.connector)
        await robot.open()
        await main(peer, robot)
        await robot.close()

    run(silent, sends_state=False)


def test_heartbeats_are_well_within_the_watchdog():
    async def main(peer, robot):
        peer.heard.clear()
        await asyncio.sleep(2.0)
        return sum(isinstance(message, m.Ping) for message in peer.heard)

    assert with_robot(main) >= 2.0 / 0.5 * 3


def test_a_stopped_program_is_noticed_while_moving_and_its_late_answer_is_dropped():
    async def main(peer, robot):
        peer.motion_s = 0.5
        motion = robot.move_joints(THERE)
        await asyncio.sleep(0.1)
        flags(peer, off=m.Flag.EXECUTING | m.Flag.MOVING)
        with pytest.raises(RejectedError) as caught:
            await motion
        assert caught.value.code == "program stopped"
        await asyncio.sleep(1.0)  # the outcome comes now, and nobody minds
        flags(peer, on=m.Flag.EXECUTING)
        await robot.move_joints(HOME)

    with_robot(main)


def test_after_a_stop_it_waits_until_the_controller_lets_go_of_the_path():
    async def main(peer, robot):
        peer.state = replace(peer.state, hold=m.Code.EMERGENCY_STOP)

        async def release():
            await asyncio.sleep(0.3)
            peer.state = replace(peer.state, hold=m.Code.NONE, tick=9)

        task = asyncio.ensure_future(release())
        await robot.move_joints(THERE)
        await task
        return [message.tick for message in peer.heard if isinstance(message, m.Run)]

    assert with_robot(main) == [9]


def test_a_path_that_is_never_let_go_is_refused_with_advice():
    async def main(peer, robot):
        peer.state = replace(peer.state, hold=m.Code.CLIENT_GONE)
        with pytest.raises(RejectedError, match="Start"):
            await robot.move_joints(THERE)

    with_robot(main)


def test_a_lost_answer_to_run_is_a_timeout_and_no_motion_is_begun_twice():
    async def main(peer, robot):
        peer.script[m.Run] = lambda frame: b""
        with pytest.raises(DeviceTimeoutError):
            await robot.move_joints(THERE)
        return sum(isinstance(message, m.Run) for message in peer.heard)

    assert with_robot(main) == 1


def test_cancelling_sends_a_stop_and_waits_for_it():
    async def main(peer, robot):
        peer.motion_s = 0.5
        motion = robot.move_joints(THERE)
        await asyncio.sleep(0.1)
        motion.cancel()
        with pytest.raises(asyncio.CancelledError):
            await motion
        assert any(isinstance(message, m.Stop) for message in peer.heard)
        state = await robot.state()
        assert not state.is_moving

    with_robot(main)


def test_robot_and_io_share_the_monitor_connection():
    async def main(peer, robot):
        io = RapidIo(peer.connector)
        await io.open()
        assert len(peer.connector.streams) == 1
        assert await io.read("di1")
        assert not await io.read("di2")
        assert await io.read("do2")
        await io.write("do1", True)
        assert peer.heard[-1] == m.Write(1, 1)
        await io.close()
        await robot.state()

    with_robot(main)


@pytest.mark.parametrize("at", range(0, 83, 5))
def test_a_connection_that_ends_within_a_frame_is_a_link_error_and_mends(at):
    async def main(peer, robot):
        def half(frame):
            data = encode(frame.seq, peer.now())
            asyncio.get_running_loop().call_soon(peer.streams[5011].close)
            return data[:at]

        peer.script[m.AskState] = half
        with pytest.raises(LinkError):
            await robot.state()
        peer.script.clear()
        await robot.open()
        await robot.move_joints(THERE)

    with_robot(main, sends_state=False)


def test_refused_connections_say_what_to_check():
    async def main(peer):
        await peer.stop()
        robot = RapidRobot(peer.connector, monitor_port=5999)
        with pytest.raises(LinkError, match=r"5999.*616-1"):
            await robot.open()
        assert not robot.is_open

    run(main)
