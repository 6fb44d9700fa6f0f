"""Waiting for time, signals, flags and other tasks."""

import asyncio
import math
from collections.abc import Callable
from typing import Any

from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.data import Pers
from sims.rapid.errors import RapidError
from sims.rapid.host import Signal
from sims.rapid.task import task_of

WAIT_MAX = 9_999_999.0
_UI = (
    "\\switch Visualize \\string Header \\string Message | string MsgArray{*} \\switch Wrap "
    "\\icondata Icon \\string Image \\num VisualizeTime \\VAR signaldo UIActiveSignal "
    "\\num ErrorNumber"
)


@builtin("PROC WaitTime(\\switch InPos, num Time)")
async def wait_time(task: TaskContext, *, inpos: bool, time: float) -> None:
    r"""Let time pass; with ``\\InPos`` from standstill on."""
    owner = task_of(task)
    if inpos and owner.settled is not None:
        await owner.settled()
    await asyncio.sleep(max(0.0, time) + owner.take_debt_s())


class Poll:
    """A WaitUntil: when it looks again and when it gives up. Compiled code drives it."""

    def __init__(
        self,
        task: TaskContext,
        max_time: float | None,
        flag: Ref | None,
        poll: float | None,
        *,
        in_position: bool,
    ) -> None:
        self._task = task_of(task)
        self._settled = self._task.settled if in_position else None
        self._pause_s = min(max(0.1 if poll is None else poll, 0.004), 86_400.0)
        self._deadline_s = math.inf if max_time is None else self._task.now_s() + max_time
        if max_time is not None and max_time >= WAIT_MAX:
            self._deadline_s = math.inf
        self._flag = flag

    def is_over(self) -> bool:
        """Whether time is up. ERR_WAIT_MAXTIME without a flag."""
        if self._task.now_s() < self._deadline_s:
            return False
        _time_is_up(self._flag, "WaitUntil")
        return True

    def done(self) -> bool:
        r"""Whether the wait ends, for the condition is met; ``\\InPos`` at standstill only."""
        if self._settled is not None:
            return False
        if self._flag is not None:
            self._flag.set(False)
        return True

    async def pause(self) -> None:
        """Until it is time to look again."""
        if self._settled is not None:
            settled, self._settled = self._settled, None
            await settled()
            return
        left_s = self._deadline_s - self._task.now_s()
        await asyncio.sleep(max(0.0, min(self._pause_s, left_s)))


@builtin(
    f"PROC WaitUntil(\\switch InPos, bool Cond \\num MaxTime \\VAR bool TimeFlag "
    f"\\num PollRate {_UI})"
)
def wait_until(task: TaskContext, **arguments: Any) -> Poll:
    """Give what the compiler needs to look at the condition again and again."""
    return Poll(
        task,
        arguments["maxtime"],
        arguments["timeflag"],
        arguments["pollrate"],
        in_position=arguments["inpos"],
    )


@builtin("FUNC bool TestAndSet(INOUT bool Object)")
def test_and_set(task: TaskContext, *, object_: Ref) -> bool:
    """Whether it was FALSE; it is TRUE now."""
    del task
    was_set = object_.get()
    object_.set(True)
    return not was_set


@builtin("PROC WaitTestAndSet(PERS bool Object)")
async def wait_test_and_set(task: TaskContext, *, object_: Ref) -> None:
    """Until it is FALSE; then make it TRUE at once."""
    del task
    root: Any = getattr(object_, "root", object_)
    changed = asyncio.Event()
    cancel = root.watch(changed.set) if isinstance(root, Pers) else None
    try:
        while object_.get():
            changed.clear()
            await changed.wait()
        object_.set(True)
    finally:
        if cancel is not None:
            cancel()


async def until(
    signal: Signal,
    is_met: Callable[[float], bool],
    *,
    max_time: float | None,
    flag: Ref | None,
    what: str,
) -> None:
    """Wait for a signal. ERR_WAIT_MAXTIME without a flag."""
    met = asyncio.Event()
    cancel = signal.watch(lambda value: met.set() if is_met(value) else None)
    try:
        if not is_met(signal.value):
            async with asyncio.timeout(None if max_time is None else max(0.0, max_time)):
                await met.wait()
    except TimeoutError:
        _time_is_up(flag, what)
        return
    finally:
        cancel()
    if flag is not None:
        flag.set(False)


def _time_is_up(flag: Ref | None, what: str) -> None:
    if flag is None:
        raise RapidError("ERR_WAIT_MAXTIME", f"{what}: the time is up")
    flag.set(True)


def _add_digital(kind: str, value: str) -> None:
    @builtin(
        f"PROC Wait{kind}(signal{kind} Signal, {value} Value \\num MaxTime \\VAR bool TimeFlag "
        f"{_UI})"
    )
    async def wait_digital(task: TaskContext, **arguments: Any) -> None:
        del task
        wanted = arguments["value"]
        await until(
            arguments["signal"],
            lambda now: now == wanted,
            max_time=arguments["maxtime"],
            flag=arguments["timeflag"],
            what=f"Wait{kind} {arguments['signal'].name}",
        )


def _add_relation(kind: str, extra: str) -> None:
    @builtin(
        f"PROC Wait{kind}(signal{kind} Signal \\switch LT | switch GT{extra}, num Value "
        f"\\num MaxTime \\VAR num ValueAtTimeout \\VAR bool TimeFlag {_UI})"
    )
    async def wait_relation(task: TaskContext, **arguments: Any) -> None:
        del task
        signal: Signal = arguments["signal"]
        wanted: float = arguments["value"]

        def is_met(now: float) -> bool:
            if arguments["lt"]:
                return now < wanted
            if arguments["gt"]:
                return now > wanted
            return (now == wanted) != bool(arguments.get("noteq"))

        try:
            await until(
                signal,
                is_met,
                max_time=arguments["maxtime"],
                flag=arguments["timeflag"],
                what=f"Wait{kind} {signal.name}",
            )
        except RapidError:
            if arguments["valueattimeout"] is not None:
                arguments["valueattimeout"].set(signal.value)
            raise


for _kind in ("DI", "DO"):
    _add_digital(_kind, "dionum")
for _kind in ("AI", "AO"):
    _add_relation(_kind, "")
for _kind in ("GI", "GO"):
    _add_relation(_kind, " | switch NOTEQ")


class Rendezvous:
    """Tasks that wait for each other at a WaitSyncTask."""

    def __init__(self) -> None:
        self._here: dict[str, set[str]] = {}
        self._gone: dict[str, asyncio.Event] = {}

    async def meet(self, name: str, own: str, others: set[str]) -> None:
        """Until all are there."""
        here = self._here.setdefault(name, set())
        event = self._gone.setdefault(name, asyncio.Event())
        here.add(own)
        if here >= others | {own}:
            event.set()
            del self._here[name], self._gone[name]
            return
        try:
            await event.wait()
        finally:
            here.discard(own)


@builtin(
    "PROC WaitSyncTask(\\switch InPos, VAR syncident SyncID, PERS tasks TaskList{*} \\num TimeOut)"
)
async def wait_sync_task(
    task: TaskContext, *, inpos: bool, syncid: Ref, tasklist: Ref, timeout: float | None
) -> None:
    """Until all tasks of the list are at it. ERR_WAITSYNCTASK: the time is up."""
    owner = task_of(task)
    if inpos and owner.settled is not None:
        await owner.settled()
    others = {str(entry[0]).lower() for entry in tasklist.get()}
    meeting = owner.common_service(Rendezvous)
    try:
        async with asyncio.timeout(timeout):
            await meeting.meet(syncid.name.lower(), task.name.lower(), others)
    except TimeoutError:
        raise RapidError("ERR_WAITSYNCTASK", "the other tasks did not come in time") from None
