"""The event loop whose time is the world's.

Time is whole nanoseconds. It stands while a callback is ready or a participant is busy, and
then goes straight to whatever is due next: a timer, a thread's deadline, a charged job. On the
way the world is stepped at every tick it passes; a step that makes a callback ready ends the
way there. So the same program does the same, however the threads are scheduled, and faster
than the wall.
"""

import asyncio
import heapq
import selectors
import threading
from collections.abc import Callable
from contextvars import Context
from dataclasses import dataclass
from typing import Any, TypeVar

from sims.loop.participants import (
    Barrier,
    LockstepError,
    Participant,
    SimEvent,
    settle,
)
from sims.loop.ticker import Ticker
from sims.loop.workers import Workers

__all__ = ["LockstepLoop"]

R = TypeVar("R")

NS_PER_S = 1_000_000_000
IDLE_LIMIT_S = 600.0


@dataclass(eq=False)
class _Charge:
    """A job whose result is due at an instant of virtual time."""

    due_ns: int
    participant: Participant
    future: "asyncio.Future[Any]"
    is_done: bool = False
    result: Any = None
    error: BaseException | None = None


class _Timer(asyncio.TimerHandle):
    """Timers due at the same instant fire in the order they were set."""

    __slots__ = ("order",)
    order: int

    def __lt__(self, other: object) -> bool:
        if not isinstance(other, _Timer):
            return NotImplemented
        return (self.when(), self.order) < (other.when(), other.order)


class _Selector(selectors.DefaultSelector):
    """Refuses everything but the loop's own wake-up, and lets the loop advance instead."""

    def __init__(self) -> None:
        super().__init__()
        self.advance: Callable[[], None] | None = None

    def register(self, fileobj: Any, events: int, data: Any = None) -> selectors.SelectorKey:
        if self.advance is not None:
            raise LockstepError(
                "bytes in flight in the kernel look idle to lock-step: sockets, ptys and pipes "
                "need paced mode (PacedLoop)"
            )
        return super().register(fileobj, events, data)

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        if timeout is None or timeout > 0:
            assert self.advance is not None
            self.advance()
        return super().select(0)


class LockstepLoop(asyncio.SelectorEventLoop):
    """See the module.

    Parameters
    ----------
    world
        Stepped whenever time passes a multiple of ``tick_ns``.
    guard_s
        Wall time after which a participant that neither blocks nor ends is an error.
    """

    # asyncio keeps these; the type stubs do not tell.
    _ready: Any
    _scheduled: list[asyncio.TimerHandle]
    _clock_resolution: float

    def __init__(self, world: Ticker, *, guard_s: float = 120.0) -> None:
        self.world = world
        self.now_ns = 0
        self._ticks = 0
        self._timers = 0
        self._charges: list[_Charge] = []
        self._workers = Workers("binpick-job")
        self._barrier = Barrier(lambda: self.now_ns, guard_s)
        self._own_thread = threading.get_ident()
        selector = _Selector()
        super().__init__(selector)
        self._clock_resolution = 0.5 / NS_PER_S
        selector.advance = self._advance

    # Time.

    def time(self) -> float:
        """Virtual seconds since the loop was made."""
        return self.now_ns / NS_PER_S

    def call_at(  # type: ignore[override]
        self,
        when: float,
        callback: Callable[..., object],
        *args: Any,
        context: Context | None = None,
    ) -> asyncio.TimerHandle:
        """Schedule at a whole nanosecond; equal times fire in the order they were set."""
        self._check_closed()  # type: ignore[attr-defined]
        timer = _Timer(round(when * NS_PER_S) / NS_PER_S, callback, args, self, context)
        self._timers += 1
        timer.order = self._timers
        heapq.heappush(self._scheduled, timer)
        timer._scheduled = True  # type: ignore[attr-defined]
        return timer

    # Work.

    def run_charged(
        self, job: Callable[[], R], *, charge_s: float, name: str = "job"
    ) -> "asyncio.Future[R]":
        """Start ``job`` in a worker thread; its result is there exactly ``charge_s`` later.

        With a charge of 0 the job is a participant: time stands until it ends, unless it waits
        by ``thread_sleep`` or a ``SimEvent``.
        """
        if not charge_s >= 0:
            raise ValueError(f"a charge of {charge_s:g} s")
        future: asyncio.Future[R] = self.create_future()
        participant = self._barrier.join(name, is_charged=charge_s > 0)
        due_ns = self.now_ns + round(charge_s * NS_PER_S)
        charge = _Charge(due_ns, participant, future)
        if charge_s > 0:
            self._charges.append(charge)
        self._workers.start(lambda: self._work(job, charge))
        return future

    def run_in_executor(  # type: ignore[override]
        self, executor: Any, func: Callable[..., R], *args: Any
    ) -> "asyncio.Future[R]":
        """Run in a worker thread as a participant; ``asyncio.to_thread`` comes here too."""
        if executor is not None:
            raise LockstepError("lock-step has its own workers; pass None as the executor")
        name = getattr(func, "__name__", "job")
        return self.run_charged(lambda: func(*args), charge_s=0.0, name=name)

    async def shutdown_default_executor(self, timeout: float | None = None) -> None:
        """There is none; the workers go home with the loop."""

    def _work(self, job: Callable[[], Any], charge: _Charge) -> None:
        self._barrier.enter(charge.participant)
        try:
            charge.result = job()
        except BaseException as error:
            charge.error = error
        charge.is_done = True
        self._barrier.leave(
            charge.participant,
            (lambda: None)
            if charge.participant.is_charged
            else lambda: settle(charge.future, charge.result, charge.error),
        )

    # Threads.

    def event(self) -> SimEvent:
        """Return an event that participants may wait for."""
        return SimEvent(self._barrier)

    def thread_wait(self, event: SimEvent, timeout_s: float | None = None) -> bool:
        """Wait in a participant's thread; False when the virtual time was up first."""
        return event.wait(timeout_s)

    def thread_sleep(self, duration_s: float) -> None:
        """Sleep in a participant's thread, in virtual time."""
        self._barrier.wait(None, duration_s)

    def call_soon_threadsafe(  # type: ignore[override]
        self, callback: Callable[..., object], *args: Any, context: Context | None = None
    ) -> asyncio.Handle:
        """Call from a participant's thread: at the barrier, in order."""
        if threading.get_ident() == self._own_thread:
            return self.call_soon(callback, *args, context=context)
        if self._barrier.current() is None:
            raise LockstepError(
                f"thread {threading.current_thread().name} is no participant: start it with "
                "loop.run_in_executor or asyncio.to_thread"
            )
        handle = asyncio.Handle(callback, args, self, context)
        self._barrier.post(lambda: self._ready.append(handle))
        return handle

    # Going on.

    def run_forever(self) -> None:
        """Run in this thread."""
        self._own_thread = threading.get_ident()
        super().run_forever()

    def close(self) -> None:
        """End; participants that wait are told."""
        if not self.is_running():
            self._barrier.close()
            self._workers.close()
        super().close()

    def _advance(self) -> None:
        """Nothing is ready: meet at the barrier, then let time pass until something is."""
        while not self._ready:
            if not self._barrier.wait_until_blocked(self._is_interrupted):
                return
            if self._barrier.deliver():
                continue
            if self._barrier.release_next() or self._collect():
                continue
            if not self._pass_time():
                return

    def _is_interrupted(self) -> bool:
        return bool(self._ready)

    def _collect(self) -> bool:
        """Hand over charged jobs that are due now, in the order they were submitted."""
        due = [charge for charge in self._charges if charge.due_ns <= self.now_ns]
        for charge in due:
            if charge.future.done():
                self._charges.remove(charge)
                continue
            if not self._barrier.wait_on_wall(
                lambda charge=charge: None if charge.is_done else charge.participant,  # type: ignore[misc]
                self._is_interrupted,
            ):
                return True
            self._charges.remove(charge)
            settle(charge.future, charge.result, charge.error)
        return bool(due)

    def _pass_time(self) -> bool:
        """Go to whatever is due next; False when that is a timer, which asyncio fires."""
        timer_ns = self._timer_ns()
        if timer_ns is not None and timer_ns <= self.now_ns:
            return False
        others = [charge.due_ns for charge in self._charges if not charge.future.done()]
        deadline_ns = self._barrier.next_deadline_ns()
        others += [] if deadline_ns is None else [deadline_ns]
        due_ns = min([*others, *([] if timer_ns is None else [timer_ns])], default=None)
        goal_ns = self.now_ns + round(IDLE_LIMIT_S * NS_PER_S) if due_ns is None else due_ns
        self._step_to(goal_ns)
        if due_ns is None and self.now_ns >= goal_ns and not self._ready:
            raise LockstepError(
                f"nothing has happened for {IDLE_LIMIT_S:g} s of virtual time and nothing is due: "
                "something waits for what will never come"
            )
        return True

    def _timer_ns(self) -> int | None:
        while self._scheduled and self._scheduled[0].cancelled():
            timer = heapq.heappop(self._scheduled)
            timer._scheduled = False  # type: ignore[attr-defined]
        return round(self._scheduled[0].when() * NS_PER_S) if self._scheduled else None

    def _step_to(self, goal_ns: int) -> None:
        """Step the world through every tick up to the goal, or until something is ready."""
        tick_ns = self.world.tick_ns
        while (self._ticks + 1) * tick_ns <= goal_ns:
            self._ticks += 1
            self.now_ns = self._ticks * tick_ns
            self.world.step()
            if self._ready or self._barrier.has_posts:
                return
        self.now_ns = max(self.now_ns, goal_ns)
