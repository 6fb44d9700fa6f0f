"""The cycle: look, choose, pick, lay down, until nothing graspable is left.

    capture -> rectify -> depth -> cloud -> segment -> pose -> to base frame
            -> grasp -> motion -> grip -> place

The left half is ``cell.eyes``, one call here; the right half is this page. The next look
overlaps with laying down: the arm is clear of the view as soon as it is over the tray.
"""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from cell.attempt import Attempt, Ending, Outcome
from cell.choose import Seen, look_and_choose
from cell.fetch import get_ready, lay_down, pick
from cell.line import Line
from cell.planning.pick import PickPlan
from hal.errors import CellError

__all__ = ["empty_the_bin"]


async def empty_the_bin(line: Line) -> Outcome:
    """Run the cycle once through the bin.

    Raises
    ------
    DeviceError
        A device failed in a way that no next attempt mends.
    SafetyError
        A stop came; the queue is dropped and nothing moves again by itself.
    PerceptionError
        The images cannot be used.
    """
    await get_ready(line)
    seen = await look_and_choose(line)
    while (plan := (seen := await _with_room(line, seen)).choice.plan) is not None:
        with _counted(line, plan):
            attempt = await pick(line, plan, number=len(line.attempts) + 1)
        looking = asyncio.create_task(look_and_choose(line), name="look")
        try:
            if attempt.is_held:
                with _counted(line, plan, attempt):
                    attempt = await lay_down(line, plan, attempt)
            seen = await looking
        finally:
            looking.cancel()
        _count(line, attempt)
        if line.memory.consecutive_misses >= line.config.grasp.max_consecutive_misses:
            return _end(line, Ending.TOO_MANY_MISSES, seen)
    return _end(line, _why_over(line, seen), seen)


def _count(line: Line, attempt: Attempt) -> None:
    line.attempts.append(attempt)
    line.note("attempt", **attempt.as_json())


@contextmanager
def _counted(line: Line, plan: PickPlan, attempt: Attempt | None = None) -> Iterator[None]:
    """Count a pick that an error cuts short, too."""
    try:
        yield
    except CellError as error:
        begun = attempt or Attempt.begun(plan, number=len(line.attempts) + 1)
        _count(line, replace(begun, miss=f"aborted: {error}"))
        raise


async def _with_room(line: Line, seen: Seen) -> Seen:
    """Have a full tray exchanged if somebody is there to do it, and look again."""
    is_blocked = line.next_slot() is None and bool(seen.scene.objects)
    if not is_blocked or line.exchange_tray is None:
        return seen
    async with line.phase("exchange tray"):
        await line.exchange_tray()
    line.slots_used = 0
    line.laid_down.clear()
    return await look_and_choose(line)


def _why_over(line: Line, seen: Seen) -> Ending:
    if seen.scene.is_empty:
        return Ending.EMPTY
    return Ending.TRAY_FULL if line.next_slot() is None else Ending.NONE_GRASPABLE


def _end(line: Line, ending: Ending, seen: Seen) -> Outcome:
    left = seen.left_reasons()
    line.note("end", ending=str(ending), left_reasons=left)
    return Outcome(ending, tuple(line.attempts), left)
