import asyncio
import hashlib
import random
import socket
import threading
import time

import pytest

from sims.loop import HungParticipantError, LockstepError, LockstepLoop, NoWorld


def run(main, world=None, **options):
    loop = LockstepLoop(world or NoWorld(), **options)
    try:
        return loop.run_until_complete(main(loop))
    finally:
        loop.close()


def test_a_thousand_waits_of_five_microseconds_cost_five_milliseconds():
    world = NoWorld()

    async def main(loop):
        for _ in range(1000):
            await asyncio.sleep(5e-6)
        return loop.now_ns

    assert run(main, world) == 5_000_000
    assert world.ticks == 2


def test_the_world_steps_exactly_on_its_ticks():
    seen = []

    class Watching(NoWorld):
        def step(self):
            super().step()
            seen.append((self.ticks, asyncio.get_running_loop().now_ns))

    async def main(loop):
        await asyncio.sleep(0.0031)
        await asyncio.sleep(0.0029)
        return loop.now_ns

    assert run(main, Watching()) == 6_000_000
    assert seen == [(1, 2_000_000), (2, 4_000_000), (3, 6_000_000)]


def test_a_callback_made_ready_by_a_step_runs_at_that_tick():
    class Promising(NoWorld):
        future = None

        def step(self):
            super().step()
            if self.ticks == 3:
                self.future.set_result(None)

    world = Promising()

    async def main(loop):
        world.future = loop.create_future()
        loop.call_later(1.0, lambda: None)
        await world.future
        return loop.now_ns

    assert run(main, world) == 6_000_000


def test_timers_for_the_same_instant_fire_in_the_order_they_were_set():
    async def main(loop):
        fired = []
        for k in range(50):
            loop.call_at(0.01, fired.append, k)
        await asyncio.sleep(0.02)
        return fired

    assert run(main) == list(range(50))


def test_a_charged_job_overlaps_motion_and_ends_exactly_on_time():
    world = NoWorld()

    async def main(loop):
        job = loop.run_charged(lambda: time.sleep(0.05) or 7, charge_s=0.25, name="see")
        await asyncio.sleep(0.1)
        ticks_meanwhile = world.ticks
        return await job, ticks_meanwhile, loop.now_ns

    assert run(main, world) == (7, 50, 250_000_000)


def test_a_charged_job_that_is_early_on_the_wall_is_not_early_in_virtual_time():
    async def main(loop):
        await loop.run_charged(lambda: None, charge_s=3.0)
        return loop.now_ns

    assert run(main) == 3_000_000_000


def test_jobs_side_by_side_complete_in_the_order_they_were_submitted():
    rng = random.Random(1)

    async def main(loop):
        done = []

        async def one(k, charge_s):
            await loop.run_charged(lambda: time.sleep(rng.random() * 0.02), charge_s=charge_s)
            done.append((k, loop.now_ns))

        await asyncio.gather(*(one(k, 0.1) for k in range(6)), *(one(k, 0.0) for k in range(6, 9)))
        return done

    done = run(main)
    assert [k for k, _ in done] == [6, 7, 8, 0, 1, 2, 3, 4, 5]
    assert {t for k, t in done if k < 6} == {100_000_000}


def test_what_a_job_raises_reaches_whoever_awaits_it():
    def fail():
        raise KeyError("broken")

    async def main(loop):
        with pytest.raises(KeyError, match="broken"):
            await loop.run_charged(fail, charge_s=0.1)
        with pytest.raises(KeyError, match="broken"):
            await asyncio.to_thread(fail)
        return True

    assert run(main)


def trace_of_two_readers_and_a_thinker(seed):
    """Two reader threads wait for frames, a third computes; all dawdle at random."""
    rng = random.Random(seed)
    trace = []

    async def main(loop):
        frames = {name: loop.event() for name in ("left", "right")}

        def reader(name):
            for k in range(20):
                assert frames[name].wait(timeout_s=1.0)
                frames[name].clear()
                time.sleep(rng.random() * 0.002)
                loop.call_soon_threadsafe(trace.append, (name, k, loop.now_ns))
                loop.thread_sleep(0.0013)
                loop.call_soon_threadsafe(trace.append, (name, "slept", loop.now_ns))

        def think(k):
            time.sleep(rng.random() * 0.004)
            return k * k

        async def expose():
            for _ in range(20):
                await asyncio.sleep(0.05)
                for event in frames.values():
                    event.set()

        async def compute():
            for k in range(20):
                trace.append(("thought", await asyncio.to_thread(think, k), loop.now_ns))
                await loop.run_charged(lambda k=k: think(k), charge_s=0.021)
                trace.append(("charged", k, loop.now_ns))
                await asyncio.sleep(0.007)

        await asyncio.gather(
            expose(),
            compute(),
            loop.run_in_executor(None, reader, "left"),
            loop.run_in_executor(None, reader, "right"),
        )

    run(main)
    return hashlib.sha256(repr(trace).encode()).hexdigest(), len(trace)


def test_threads_with_random_delays_leave_the_same_trace_every_time():
    traces = {trace_of_two_readers_and_a_thinker(seed) for seed in range(12)}
    assert len(traces) == 1
    assert traces.pop()[1] == 120


def test_a_thread_that_waits_for_the_world_does_not_stop_it():
    world = NoWorld()

    async def main(loop):
        await loop.run_in_executor(None, loop.thread_sleep, 0.05)
        return loop.now_ns

    assert run(main, world) == 50_000_000
    assert world.ticks == 25


def test_a_threads_wait_says_whether_the_time_was_up():
    async def main(loop):
        event = loop.event()
        late = await loop.run_in_executor(None, event.wait, 0.02)
        loop.call_later(0.01, event.set)
        early = await loop.run_in_executor(None, loop.thread_wait, event, 0.5)
        return late, early, loop.now_ns

    assert run(main) == (False, True, 30_000_000)


def test_threads_that_are_due_together_wake_one_at_a_time_in_order():
    running, most, order = [0], [0], []

    async def main(loop):
        def sleeper(k):
            loop.thread_sleep(0.01)
            running[0] += 1
            most[0] = max(most[0], running[0])
            time.sleep(0.002)
            order.append(k)
            running[0] -= 1
            loop.thread_sleep(0.01)

        await asyncio.gather(*(loop.run_in_executor(None, sleeper, k) for k in range(5)))

    run(main)
    assert most == [1]
    assert order == [0, 1, 2, 3, 4]


def test_events_change_only_while_every_participant_is_blocked():
    async def main(loop):
        event = loop.event()

        def look():
            before = event.is_set()
            time.sleep(0.02)
            return before, event.is_set()

        job = loop.run_in_executor(None, look)
        event.set()
        seen = await job
        return seen, event.is_set()

    assert run(main) == ((False, False), True)


def test_a_participant_that_hangs_is_named_with_its_stack():
    release = threading.Event()

    def stuck_in_the_driver():
        release.wait(10)

    async def main(loop):
        await asyncio.to_thread(stuck_in_the_driver)

    with pytest.raises(HungParticipantError, match="stuck_in_the_driver") as caught:
        run(main, guard_s=0.2)
    assert "release.wait(10)" in caught.value.stack
    release.set()


def test_a_charged_job_that_hangs_is_named_when_it_is_due():
    release = threading.Event()

    async def main(loop):
        job = loop.run_charged(lambda: release.wait(10), charge_s=0.5, name="depth")
        await asyncio.sleep(0.4)
        assert loop.now_ns == 400_000_000
        await job

    with pytest.raises(HungParticipantError, match="depth"):
        run(main, guard_s=0.2)
    release.set()


def test_a_timeout_cancels_in_virtual_time():
    async def main(loop):
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.123):
                await loop.create_future()
        first = loop.now_ns
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.1):
                await loop.run_charged(lambda: time.sleep(0.01), charge_s=5.0)
        await asyncio.sleep(0.01)
        return first, loop.now_ns

    assert run(main) == (123_000_000, 233_000_000)


def test_sockets_are_refused_with_the_way_out():
    async def main(loop):
        with socket.socket() as ours, pytest.raises(LockstepError, match="paced mode"):
            loop.add_reader(ours, lambda: None)
        return True

    assert run(main)


def test_waiting_for_what_never_comes_is_an_error_and_not_for_ever():
    async def main(loop):
        await loop.create_future()

    with pytest.raises(LockstepError, match="nothing is due"):
        run(main)


def test_a_stranger_thread_may_not_speak():
    async def main(loop):
        said = []

        def stranger():
            try:
                loop.call_soon_threadsafe(lambda: None)
            except LockstepError as error:
                said.append(str(error))

        thread = threading.Thread(target=stranger)
        thread.start()
        thread.join()
        return said

    assert "no participant" in run(main)[0]


def test_a_charged_job_may_not_wait_for_virtual_time():
    async def main(loop):
        with pytest.raises(LockstepError, match="may not wait"):
            await loop.run_charged(lambda: loop.thread_sleep(0.1), charge_s=0.1)
        return True

    assert run(main)


def test_a_thread_that_still_waits_is_told_when_the_loop_closes():
    told = threading.Event()

    async def main(loop):
        def waiter():
            try:
                loop.event().wait()
            except LockstepError:
                told.set()

        loop.run_in_executor(None, waiter)
        await asyncio.sleep(0.01)

    run(main)
    assert told.wait(5)


def test_asyncio_run_works_with_it():
    async def main():
        await asyncio.sleep(1.5)
        return await asyncio.to_thread(lambda: asyncio.__name__)

    with asyncio.Runner(loop_factory=lambda: LockstepLoop(NoWorld())) as runner:
        assert runner.run(main()) == "asyncio"
