"""Servers in RAPID under the network's and the controller's faults."""

import asyncio

import pytest

from sims.controller.faults import ControllerFaults, FaultyNetwork, UnlicensedNetwork

ECHO = """
  VAR socketdev listener;
  VAR socketdev client;
  VAR string text;
  VAR string peer;
  PERS num clients := 0;
  PROC main()
    SocketClose client;
    SocketClose listener;
    SocketCreate listener;
    SocketBind listener, "192.168.125.1", 1025;
    SocketListen listener;
    SocketAccept listener, client \\ClientAddress:=peer \\Time:=WAIT_MAX;
    clients := clients + 1;
    WHILE TRUE DO
      SocketReceive client \\Str:=text \\Time:=WAIT_MAX;
      SocketSend client \\Str:=text;
    ENDWHILE
  ERROR
    errno_seen := ERRNO;
    WaitTime 0.1;
    ExitCycle;
  ENDPROC
"""


def on_faulty(bench, module=ECHO):
    made = bench(module)
    made.network = FaultyNetwork(made.controller.network)
    made.controller.network = made.network
    return made


async def connected(b):
    inner = b.network._inner
    for _ in range(100):
        try:
            return await inner.connect("192.168.125.1", 1025, peer="192.168.125.50")
        except OSError:
            await asyncio.sleep(0.05)
    raise AssertionError("nobody listens")


async def asked(stream, data, size=None):
    await stream.send(data)
    answer = b""
    while len(answer) < (size or len(data)):
        got = await stream.receive(100)
        if not got:
            break
        answer += got
    return answer


@pytest.mark.parametrize("fault", [{}, {"cut_bytes": 1}, {"delay_s": 0.2}, {"merge_s": 0.2}])
def test_an_echo_survives_cut_slow_and_merged_segments(bench, fault):
    async def play(b):
        for name, value in fault.items():
            setattr(b.network, name, value)
        await b.start()
        stream = await connected(b)
        assert await asked(stream, b"hello") == b"hello"
        await stream.send(b"one")
        assert await asked(stream, b"two", 6) == b"onetwo"

    on_faulty(bench).run(play)


def test_a_lost_connection_is_an_error_in_the_program_and_the_next_client_is_served(bench):
    async def play(b):
        await b.start()
        first = await connected(b)
        assert await asked(first, b"a") == b"a"
        b.network.drop_all()
        await asyncio.sleep(0.3)
        assert b.value("errno_seen") == b.value("ERR_SOCK_CLOSED")
        second = await connected(b)
        assert await asked(second, b"b") == b"b"
        assert b.value("clients") == 2

    on_faulty(bench).run(play)


def test_a_half_closed_connection_ends_the_session(bench):
    async def play(b):
        await b.start()
        stream = await connected(b)
        assert await asked(stream, b"a") == b"a"
        b.network.silence_all()
        await asyncio.sleep(0.3)
        assert b.value("errno_seen") == b.value("ERR_SOCK_CLOSED")

    on_faulty(bench).run(play)


def test_an_address_in_use_is_an_error_until_it_is_free(bench):
    async def play(b):
        b.network.busy_ports.add(1025)
        await b.start()
        await asyncio.sleep(0.5)
        assert b.value("errno_seen") == b.value("ERR_SOCK_ADDR_INUSE")
        b.network.busy_ports.clear()
        assert await asked(await connected(b), b"a") == b"a"

    on_faulty(bench).run(play)


def test_without_the_option_the_log_says_which_one_is_missing(bench):
    made = bench(ECHO)
    made.controller.network = UnlicensedNetwork(made.controller.log)

    async def play(b):
        await b.start()
        await asyncio.sleep(0.3)
        assert any("616-1" in line for entry in b.controller.log for line in entry.cause)
        assert b.value("errno_seen") != 0

    made.run(play)


def test_after_a_program_stop_the_client_hears_nothing_and_is_not_cut_off(bench):
    async def play(b):
        await b.start()
        stream = await connected(b)
        assert await asked(stream, b"a") == b"a"
        await ControllerFaults(b.controller).stop_program()
        await stream.send(b"b")
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(5):
                await stream.receive(10)
        await b.start()
        assert await stream.receive(10) == b"b"

    on_faulty(bench).run(play)


def test_a_restart_closes_the_sockets(bench):
    async def play(b):
        await b.start()
        stream = await connected(b)
        assert await asked(stream, b"a") == b"a"
        await ControllerFaults(b.controller).restart()
        assert await stream.receive(10) == b""
        await b.start()
        assert await asked(await connected(b), b"b") == b"b"

    on_faulty(bench).run(play)


MOVING = """
  PROC main()
    MoveAbsJ HOME, v1000, fine, tTool;
    MoveAbsJ [[60, 0, 0, 0, 90, 0], NONE], v1000, fine, tTool;
    phase := 99;
    EXIT;
  ERROR
    errno_seen := ERRNO;
    EXIT;
  ENDPROC
"""


def test_an_emergency_stop_can_be_ordered_in_a_move(bench):
    async def play(b):
        await b.start()
        await ControllerFaults(b.controller).stop_in_move()
        await asyncio.sleep(0.5)
        assert b.controller.state == "emergencystop"
        assert 0 < b.world.arm.measured_rad[0] < 1

    bench(MOVING).run(play)


def test_a_collision_can_be_ordered_in_a_move(bench):
    async def play(b):
        await b.start()
        await ControllerFaults(b.controller).collide_in_move()
        await b.ended()
        assert b.value("errno_seen") == b.value("ERR_MOTIONSUP")

    bench(MOVING).run(play)


def test_segments_are_cut_to_size_and_a_cancelled_receive_loses_nothing(bench):
    async def play(b):
        network = b.network
        listener = await network.listen("192.168.125.1", 4000)
        client = await network._inner.connect("192.168.125.1", 4000)
        stream = await listener.accept()
        network.cut_bytes = 2
        await client.send(b"abcde")
        assert [await stream.receive(100) for _ in range(3)] == [b"ab", b"cd", b"e"]
        waiting = asyncio.ensure_future(stream.receive(100))
        await asyncio.sleep(0.01)
        waiting.cancel()
        await client.send(b"xy")
        assert await stream.receive(1) == b"x"
        assert stream.pending() == 1
        stream.close()
        listener.close()

    on_faulty(bench).run(play)
