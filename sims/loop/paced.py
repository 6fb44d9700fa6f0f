"""The event loop whose time is the wall's, with the world running behind it."""

import asyncio
import selectors
import threading
import time
from dataclasses import dataclass
from typing import Any

from sims.loop.ticker import Ticker

__all__ = ["PaceReport", "PacedLoop"]

NS_PER_S = 1_000_000_000


@dataclass(frozen=True)
class PaceReport:
    """How well the world kept up.

    ``realtime_factor`` is loop time over wall time; ``lateness_s`` the worst delay of a tick
    behind its time, ``slipped_s`` the time that was given up because the world was too slow.
    """

    realtime_factor: float
    ticks: int
    late_ticks: int
    lateness_s: float
    slipped_s: float


class _Selector(selectors.DefaultSelector):
    """Wakes for files, timers and the world's next tick, whichever is first."""

    loop: "PacedLoop | None" = None

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        if self.loop is None:
            return super().select(timeout)
        ready = super().select(self.loop.wall_wait_s(timeout))
        self.loop.catch_up()
        return ready


class PacedLoop(asyncio.SelectorEventLoop):
    """Loop time is wall time x ``speed``; the world is stepped at every tick that has passed.

    A world that is too slow is never run more than ``catch_up_s`` behind: what is more is
    given up, so that loop time and the world's stay together, and is counted.
    """

    # Until asyncio has made the loop there is nothing to close.
    _closed = True

    def __init__(self, world: Ticker, *, speed: float = 1.0, catch_up_s: float = 0.1) -> None:
        if not speed > 0:
            raise ValueError(f"speed must be positive, got {speed:g}")
        self.world = world
        self.speed = speed
        self._catch_up_ns = round(catch_up_s * NS_PER_S)
        self._began = time.monotonic_ns()
        self._slipped_ns = 0
        self._ticks = 0
        self._late_ticks = 0
        self._latest_ns = 0
        selector = _Selector()
        super().__init__(selector)
        selector.loop = self

    @property
    def now_ns(self) -> int:
        """Loop time in nanoseconds."""
        wall_ns = time.monotonic_ns() - self._began
        return round(wall_ns * self.speed) - self._slipped_ns

    def time(self) -> float:
        """Loop time in seconds."""
        return self.now_ns / NS_PER_S

    def wall_wait_s(self, timeout_s: float | None) -> float:
        """How long to sleep: until the timer or the next tick."""
        to_tick_s = ((self._ticks + 1) * self.world.tick_ns - self.now_ns) / NS_PER_S
        wait_s = to_tick_s if timeout_s is None else min(to_tick_s, timeout_s)
        return max(0.0, wait_s / self.speed)

    def catch_up(self) -> None:
        """Step the world to now; give up what is too far behind."""
        tick_ns = self.world.tick_ns
        limit_ns = self.now_ns
        while (self._ticks + 1) * tick_ns <= limit_ns:
            self._ticks += 1
            self.world.step()
            behind_ns = self.now_ns - self._ticks * tick_ns
            self._latest_ns = max(self._latest_ns, behind_ns)
            self._late_ticks += behind_ns > tick_ns
            if behind_ns > self._catch_up_ns:
                self._slipped_ns += behind_ns - self._catch_up_ns
                limit_ns = min(limit_ns, self.now_ns)

    def report(self) -> PaceReport:
        """How it went so far."""
        wall_s = (time.monotonic_ns() - self._began) / NS_PER_S
        return PaceReport(
            realtime_factor=self.time() / wall_s,
            ticks=self._ticks,
            late_ticks=self._late_ticks,
            lateness_s=self._latest_ns / NS_PER_S,
            slipped_s=self._slipped_ns / NS_PER_S,
        )

    def event(self) -> "PacedEvent":
        """Return an event that threads may wait for."""
        return PacedEvent(self)

    def thread_sleep(self, duration_s: float) -> None:
        """Sleep in a thread, in loop time."""
        time.sleep(duration_s / self.speed)

    def thread_wait(self, event: "PacedEvent", timeout_s: float | None = None) -> bool:
        """Wait in a thread; False when the loop time was up first."""
        return event.wait(timeout_s)


class PacedEvent(threading.Event):
    """A thread's event whose time-outs are in loop time."""

    def __init__(self, loop: PacedLoop) -> None:
        super().__init__()
        self._loop: Any = loop

    def wait(self, timeout: float | None = None) -> bool:
        """Wait; False when the time was up."""
        return super().wait(None if timeout is None else timeout / self._loop.speed)
