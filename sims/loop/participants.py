"""Threads that take part in virtual time, and the barrier at which they meet.

A participant is busy or blocked. Time stands while one is busy. Whatever a participant says
(posts, events) waits until all are blocked, and is then delivered in the order of participants,
each one's own in the order it said them; so thread scheduling cannot be seen. A blocked
participant is marked busy before it wakes, and the next one wakes only when it is blocked again.
"""

import asyncio
import sys
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Barrier", "HungParticipantError", "LockstepError", "Participant", "SimEvent"]

LOOP = -1
WALL_SLICE_S = 0.1


class LockstepError(RuntimeError):
    """Something that cannot be in lock-step."""


class HungParticipantError(LockstepError):
    """A thread neither blocked nor ended; ``stack`` shows where it is."""

    def __init__(self, name: str, guard_s: float, stack: str) -> None:
        super().__init__(
            f"{name} has neither blocked nor ended for {guard_s:g} s of wall time; "
            f"it is at\n{stack}"
        )
        self.stack = stack


@dataclass(eq=False)
class Participant:
    """A thread, from the start of its job to its end."""

    number: int
    name: str
    thread_id: int = 0
    is_busy: bool = True
    is_charged: bool = False
    deadline_ns: int | None = None
    event: "SimEvent | None" = None
    due: tuple[int, int] | None = None  # when it may wake, and in which order
    wake: threading.Semaphore = field(default_factory=lambda: threading.Semaphore(0))
    said: int = 0


class SimEvent:
    """A flag for participants; it changes only while all of them are blocked."""

    def __init__(self, barrier: "Barrier") -> None:
        self._barrier = barrier
        self.is_up = False

    def is_set(self) -> bool:
        """Whether it is set, as of the last barrier."""
        return self.is_up

    def set(self) -> None:
        """Set it at the next barrier; from any participant or the loop."""
        self._barrier.post(lambda: self._barrier.raise_event(self))

    def clear(self) -> None:
        """Clear it at the next barrier."""
        self._barrier.post(lambda: self._barrier.clear_event(self))

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait in a participant's thread; False when the time was up first."""
        return self._barrier.wait(self, timeout_s)


class Barrier:
    """Who is busy, what was said, who wakes next. Times are the loop's, in nanoseconds."""

    def __init__(self, now_ns: Callable[[], int], guard_s: float) -> None:
        self._now_ns = now_ns
        self._guard_s = guard_s
        self._changed = threading.Condition(threading.RLock())
        self._participants: dict[int, Participant] = {}
        self._by_thread: dict[int, Participant] = {}
        self._posts: list[tuple[int, int, Callable[[], None]]] = []
        self._numbers = 0
        self._loop_said = 0
        self._order = 0
        self._is_closed = False

    # For the loop.

    def join(self, name: str, *, is_charged: bool = False) -> Participant:
        """Count a new participant as busy; a charged one never holds time up here."""
        with self._changed:
            self._numbers += 1
            newcomer = Participant(self._numbers, name, is_charged=is_charged)
            if not is_charged:
                self._participants[newcomer.number] = newcomer
            return newcomer

    def wait_until_blocked(self, is_interrupted: Callable[[], bool]) -> bool:
        """Wait on the wall until nobody is busy; False if interrupted by a signal.

        Raises
        ------
        HungParticipantError
            Somebody took too long.
        """
        return self.wait_on_wall(
            lambda: next((p for p in self._participants.values() if p.is_busy), None),
            is_interrupted,
        )

    def wait_on_wall(
        self, whom: Callable[[], Participant | None], is_interrupted: Callable[[], bool]
    ) -> bool:
        """Wait until ``whom`` names nobody any more; the guard names the one it waits for."""
        limit = time.monotonic() + self._guard_s
        with self._changed:
            while (awaited := whom()) is not None:
                if is_interrupted():
                    return False
                if time.monotonic() > limit:
                    self._forget(awaited)
                    raise HungParticipantError(awaited.name, self._guard_s, _stack(awaited))
                self._changed.wait(min(WALL_SLICE_S, self._guard_s))
        return True

    @property
    def has_posts(self) -> bool:
        """Whether something waits to be delivered."""
        return bool(self._posts)

    def deliver(self) -> bool:
        """Carry out everything that was said, in order; whether there was anything."""
        with self._changed:
            posts, self._posts = sorted(self._posts, key=lambda post: post[:2]), []
        for _, _, action in posts:
            action()
        return bool(posts)

    def release_next(self) -> bool:
        """Wake the blocked participant that is due first; whether there was one."""
        now_ns = self._now_ns()
        with self._changed:
            best: tuple[tuple[int, int, int], Participant] | None = None
            for participant in self._participants.values():
                due = participant.due
                if due is None and participant.deadline_ns is not None:
                    due = (participant.deadline_ns, 0)
                if due is None or due[0] > now_ns:
                    continue
                key = (*due, participant.number)
                if best is None or key < best[0]:
                    best = (key, participant)
            if best is None:
                return False
            best[1].is_busy = True
            best[1].wake.release()
            return True

    def next_deadline_ns(self) -> int | None:
        """When the first blocked participant's time is up."""
        with self._changed:
            deadlines = [
                p.deadline_ns for p in self._participants.values() if p.deadline_ns is not None
            ]
        return min(deadlines, default=None)

    def raise_event(self, event: SimEvent) -> None:
        """Set an event, and make whoever waits for it due, in the order of their numbers."""
        event.is_up = True
        self._order += 1
        for participant in self._participants.values():
            if participant.event is event and participant.due is None:
                participant.due = (self._now_ns(), self._order)

    def clear_event(self, event: SimEvent) -> None:
        """Clear an event; whoever it already made due stays due."""
        event.is_up = False

    def close(self) -> None:
        """Wake everybody that waits, to be told that the loop is gone."""
        with self._changed:
            self._is_closed = True
            for participant in self._participants.values():
                if not participant.is_busy:
                    participant.is_busy = True
                    participant.wake.release()

    # For threads.

    def enter(self, participant: Participant) -> None:
        """The job's thread begins."""
        with self._changed:
            participant.thread_id = threading.get_ident()
            self._by_thread[participant.thread_id] = participant

    def leave(self, participant: Participant, last_words: Callable[[], None]) -> None:
        """The job's thread ends; a participant that dies must not stop time for ever."""
        with self._changed:
            self._say(participant, last_words)
            self._forget(participant)
            self._changed.notify_all()

    def current(self) -> Participant | None:
        """The participant whose thread this is."""
        return self._by_thread.get(threading.get_ident())

    def post(self, action: Callable[[], None]) -> None:
        """Say something, from a participant's thread or the loop's."""
        with self._changed:
            participant = self.current()
            if participant is None:
                self._loop_said += 1
                self._posts.append((LOOP, self._loop_said, action))
            else:
                self._say(participant, action)

    def wait(self, event: SimEvent | None, timeout_s: float | None) -> bool:
        """Block this thread until the event is set (True) or the time is up (False)."""
        participant = self.current()
        if participant is None or participant.is_charged:
            raise LockstepError(
                f"thread {threading.current_thread().name} may not wait for virtual time: start it "
                "with loop.run_in_executor or asyncio.to_thread"
            )
        with self._changed:
            self._check_open()
            if event is not None and event.is_up:
                return True
            participant.event = event
            participant.deadline_ns = (
                None if timeout_s is None else self._now_ns() + round(timeout_s * 1e9)
            )
            participant.due = None
            participant.is_busy = False
            self._changed.notify_all()
        participant.wake.acquire()
        with self._changed:
            was_set = participant.due is not None
            participant.event = participant.deadline_ns = participant.due = None
            self._check_open()
            return was_set

    def _check_open(self) -> None:
        if self._is_closed:
            raise LockstepError("the loop is closed")

    def _say(self, participant: Participant, action: Callable[[], None]) -> None:
        participant.said += 1
        self._posts.append((participant.number, participant.said, action))

    def _forget(self, participant: Participant) -> None:
        self._participants.pop(participant.number, None)
        self._by_thread.pop(participant.thread_id, None)


def _stack(participant: Participant) -> str:
    frame = sys._current_frames().get(participant.thread_id)
    return "".join(traceback.format_stack(frame)) if frame is not None else "(not started)"


def settle(future: "asyncio.Future[Any]", result: Any, error: BaseException | None) -> None:
    """Hand a job's end to its future, unless nobody wants it any more."""
    if future.done():
        return
    if error is not None:
        future.set_exception(error)
    else:
        future.set_result(result)
