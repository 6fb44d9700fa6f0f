import asyncio
import time

import pytest

from sims.loop import NoWorld, PacedLoop


def run(main, world=None, **options):
    loop = PacedLoop(world or NoWorld(), **options)
    try:
        return loop.run_until_complete(main(loop))
    finally:
        loop.close()


def test_the_world_follows_the_wall_times_speed():
    world = NoWorld()

    async def main(loop):
        began = time.monotonic()
        await asyncio.sleep(1.0)
        report = loop.report()
        return time.monotonic() - began, report, world.ticks, loop.time()

    wall_s, report, ticks, loop_s = run(main, world, speed=5.0)
    # A busy machine wakes late and lets time slip; what never happens is running ahead.
    assert wall_s >= 0.2 - 1e-3
    assert report.ticks == ticks
    assert 500 <= ticks <= loop_s / 0.002 + 1
    assert report.realtime_factor <= 5.001
    assert loop_s == pytest.approx(5.0 * wall_s - report.slipped_s, abs=0.1 + 0.05 * wall_s)


def test_real_sockets_work():
    async def main(loop):
        async def echo(reader, writer):
            writer.write(await reader.readline())
            await writer.drain()
            writer.close()
            await writer.wait_closed()

        server = await asyncio.start_server(echo, "127.0.0.1", 0)
        async with server:
            port = server.sockets[0].getsockname()[1]
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(b"hello\n")
            line = await reader.readline()
            writer.close()
            await writer.wait_closed()
        return line

    assert run(main) == b"hello\n"


def test_a_world_that_is_too_slow_makes_time_slip_and_says_so():
    class Slow(NoWorld):
        def step(self):
            super().step()
            time.sleep(0.006)

    world = Slow()

    async def main(loop):
        began = time.monotonic()
        await asyncio.sleep(0.3)
        return loop.report(), time.monotonic() - began, loop.time()

    report, wall_s, loop_s = run(main, world, catch_up_s=0.02)
    assert wall_s > 0.6
    assert report.slipped_s > 0.3
    assert report.realtime_factor < 0.6
    assert report.late_ticks > 50
    assert world.ticks * 0.002 <= loop_s + 0.002


def test_threads_wait_in_loop_time():
    async def main(loop):
        event = loop.event()
        loop.call_later(0.1, event.set)
        was_set = await asyncio.to_thread(loop.thread_wait, event, 5.0)
        await asyncio.to_thread(loop.thread_sleep, 0.1)
        timed_out = await asyncio.to_thread(loop.thread_wait, loop.event(), 0.1)
        return was_set, timed_out, loop.time()

    was_set, timed_out, loop_s = run(main, speed=4.0)
    assert was_set
    assert not timed_out
    assert loop_s >= 0.3 - 1e-3


def test_speed_must_be_positive():
    with pytest.raises(ValueError, match="speed"):
        PacedLoop(NoWorld(), speed=0.0)
