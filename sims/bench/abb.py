"""``binpick bench abb``: the wire, RAPID, the interpreter, and how exactly the arm is driven."""

import asyncio
import multiprocessing
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from drivers.abb import RapidRobot
from drivers.abb.session import MONITOR_PORT, Session
from drivers.transports import TcpConnector
from hal import Figure
from sims.bench import abb_stops as stops
from sims.bench import controller as driving
from sims.bench import rapid as interpreter
from sims.bench.abb_wire import round_trips
from sims.controller.loopback import LOOPBACK, loopback_controller
from sims.loop import PacedLoop
from sims.world import World

__all__ = ["run"]

QUESTIONS = 2000
STATES_S = 20.0
STATE_PERIOD_S = 0.04


def run(*, seeds: Sequence[int], part: Any, count: int) -> list[Figure]:
    """All figures; ``part`` and ``count`` do not matter here."""
    del part, count
    return [
        *round_trips(),
        *through_rapid(),
        *interpreter.run(),
        *driving.run(seeds=seeds),
        *stops.run(),
    ]


def through_rapid() -> list[Figure]:
    """Questions answered by the RAPID program in another process, and the beat of its states."""
    with controller_process() as ports:
        return asyncio.run(_ask(ports))


@contextmanager
def controller_process() -> Iterator[dict[int, int]]:
    """Run a controller with the shipped package; yields its ports."""
    ours, theirs = multiprocessing.Pipe()
    context = multiprocessing.get_context("spawn")
    process = context.Process(target=_serve, args=(theirs,), daemon=True)
    process.start()
    theirs.close()  # so that its end is seen here
    try:
        yield ours.recv()
    finally:
        process.kill()
        process.join()


def _serve(pipe: Connection) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the bench ends it
    world = World()
    loop = PacedLoop(world)
    controller, connector = loopback_controller(world)

    async def main() -> None:
        async with controller:
            await controller.start()
            while len(connector.ports) < 2:
                await asyncio.sleep(0.05)
            pipe.send(connector.ports)
            await asyncio.Event().wait()

    loop.run_until_complete(main())


async def _ask(ports: dict[int, int]) -> list[Figure]:
    connector = TcpConnector(LOOPBACK, ports)
    robot = RapidRobot(connector)
    times = []
    async with robot:
        for _ in range(QUESTIONS):
            began = time.perf_counter()
            await robot.state()
            times.append(time.perf_counter() - began)
            # Not in step with the controller's own beat.
            await asyncio.sleep(0.0013)
        idle = await _beat(connector)
    return [
        Figure.median("abb.rapid_round_trip_median", times, "s"),
        Figure(
            "abb.rapid_round_trip_p99",
            float(np.percentile(times, 99)),
            "s",
            len(times),
            min(times),
            max(times),
        ),
        Figure("abb.state_rate", 1 / float(np.mean(idle)), "1/s", len(idle)),
        Figure(
            "abb.state_jitter_p99",
            float(np.percentile(np.abs(np.array(idle) - STATE_PERIOD_S), 99)),
            "s",
            len(idle),
        ),
    ]


async def _beat(connector: TcpConnector) -> list[float]:
    """Wall times between states that came unasked."""
    session = await Session.join(connector, "bench", MONITOR_PORT)
    stamps: list[float] = []
    end_s = time.perf_counter() + STATES_S
    while time.perf_counter() < end_s:
        await session.reached(lambda _: True)
        stamps.append(time.perf_counter())
    await session.leave()
    return np.diff(stamps).tolist()
