"""Ordering interrupts: by signals, time, persistents, events; and what a trap can read."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.data import Pers
from sims.rapid.errors import RapidError
from sims.rapid.host import EventKind, Signal
from sims.rapid.queues import queues_of
from sims.rapid.task import task_of

Cancel = Callable[[], None]
EDGE = 2.0
MIN_TIMER_S = 0.01
COMMON_ERR = 0.0
_TYPES = {EventKind.STATE: 1.0, EventKind.WARNING: 2.0, EventKind.ERROR: 3.0}
TYPE_ALL = 0.0
AIO_ALWAYS = 7.0


def _order(task: TaskContext, interrupt: Ref, begin: Callable[[int], Cancel], single: bool) -> None:
    number = interrupt.get()
    interrupts = task_of(task).machine.interrupts
    interrupts.order(number, lambda: begin(int(number)), is_single=single)


def _add_digital(name: str, kind: str, is_group: bool) -> None:
    value = "" if is_group else ", dionum TriggValue"

    @builtin(
        f"PROC {name}(\\switch Single | switch SingleSafe, signal{kind} Signal{value}, "
        "VAR intnum Interrupt \\switch Safe)"
    )
    def isignal(task: TaskContext, **arguments: Any) -> None:
        signal: Signal = arguments["signal"]
        wanted: float = arguments.get("triggvalue", EDGE)

        def begin(number: int) -> Cancel:
            def changed(now: float) -> None:
                if wanted in {EDGE, now}:
                    task.fire(number)

            return signal.watch(changed)

        _order(task, arguments["interrupt"], begin, arguments["single"] or arguments["singlesafe"])


for _name, _kind, _group in (
    ("ISignalDI", "DI", False),
    ("ISignalDO", "DO", False),
    ("ISignalGI", "GI", True),
    ("ISignalGO", "GO", True),
):
    _add_digital(_name, _kind, _group)


@dataclass
class _Band:
    """When an analog signal interrupts, as AIO_* says."""

    condition: float
    high: float
    low: float
    delta: float
    last: float

    def fires(self, now: float) -> bool:
        """Whether this value interrupts."""
        zone = {
            1.0: now > self.high,
            2.0: now < self.high,
            3.0: now > self.low,
            4.0: now < self.low,
            5.0: self.low <= now <= self.high,
            6.0: not self.low <= now <= self.high,
            AIO_ALWAYS: True,
        }.get(self.condition, False)
        if not zone or abs(now - self.last) < self.delta:
            return False
        self.last = now
        return True


def _add_analog(name: str, kind: str) -> None:
    @builtin(
        f"PROC {name}(\\switch Single | switch SingleSafe, signal{kind} Signal, "
        "aiotrigg Condition, num HighValue, num LowValue, num DeltaValue "
        "\\switch DPos | switch DNeg, VAR intnum Interrupt)"
    )
    def isignal(task: TaskContext, **arguments: Any) -> None:
        signal: Signal = arguments["signal"]
        band = _Band(
            arguments["condition"],
            arguments["highvalue"],
            arguments["lowvalue"],
            arguments["deltavalue"],
            signal.value,
        )

        def begin(number: int) -> Cancel:
            def changed(now: float) -> None:
                rises = now > band.last
                if (arguments["dpos"] and not rises) or (arguments["dneg"] and rises):
                    return
                if band.fires(now):
                    task.fire(number)

            return signal.watch(changed)

        _order(task, arguments["interrupt"], begin, arguments["single"] or arguments["singlesafe"])


_add_analog("ISignalAI", "AI")
_add_analog("ISignalAO", "AO")


class _Timer:
    """Fires once or again and again, on the loop's time."""

    def __init__(self, fire: Callable[[], None], time_s: float, *, is_single: bool) -> None:
        self._fire = fire
        self._time_s = time_s
        self._is_single = is_single
        self._loop = asyncio.get_running_loop()
        self._due_s = self._loop.time() + time_s
        self._handle = self._loop.call_at(self._due_s, self._ring)

    def _ring(self) -> None:
        if not self._is_single:
            self._due_s += self._time_s
            self._handle = self._loop.call_at(self._due_s, self._ring)
        self._fire()

    def cancel(self) -> None:
        """No more."""
        self._handle.cancel()


@builtin("PROC ITimer(\\switch Single | switch SingleSafe, num Time, VAR intnum Interrupt)")
def itimer(
    task: TaskContext, *, single: bool, singlesafe: bool, time: float, interrupt: Ref
) -> None:
    """After a time, or each time it has passed. ERR_ARGVALERR: too short."""
    is_single = single or singlesafe
    if time < MIN_TIMER_S:
        raise RapidError("ERR_ARGVALERR", f"ITimer: {time:g} s is below {MIN_TIMER_S:g} s")
    _order(
        task,
        interrupt,
        lambda number: _Timer(lambda: task.fire(number), time, is_single=is_single).cancel,
        is_single,
    )


@builtin("PROC IPers(\\switch Single | switch SingleSafe, PERS anytype Name, VAR intnum Interrupt)")
def ipers(task: TaskContext, *, single: bool, singlesafe: bool, name: Ref, interrupt: Ref) -> None:
    """When a persistent gets another value."""
    root: Any = getattr(name, "root", name)
    if not isinstance(root, Pers):
        raise RapidError("ERR_ARGNOTPER", f"IPers: {name.name} is no PERS")
    pers: Pers = root
    _order(
        task,
        interrupt,
        lambda number: pers.watch(lambda: task.fire(number)),
        single or singlesafe,
    )


@dataclass(frozen=True)
class TrapData:
    """What caused an interrupt; an event log entry, for IError."""

    entry: Any = None


@builtin(
    "PROC IError(errdomain ErrorDomain \\num ErrorId, errtype ErrorType, VAR intnum Interrupt)"
)
def ierror(
    task: TaskContext,
    *,
    errordomain: float,
    errorid: float | None,
    errortype: float,
    interrupt: Ref,
) -> None:
    """When an entry of a kind is written into the event log."""
    machine = task_of(task).machine

    def begin(number: int) -> Cancel:
        def written(entry: Any) -> None:
            if errordomain not in {COMMON_ERR, float(entry.domain)}:
                return
            if errorid is not None and errorid != entry.number % 10_000:
                return
            if errortype in {TYPE_ALL, _TYPES.get(entry.kind)}:
                machine.interrupts.fire(number, TrapData(entry))

        return task.host.log.watch(written)

    _order(task, interrupt, begin, single=False)


@builtin("PROC IRMQMessage(REF anytype InterruptDataType, VAR intnum Interrupt)")
def irmq_message(task: TaskContext, *, interruptdatatype: Ref, interrupt: Ref) -> None:
    """When a message of a type arrives in the task's queue."""
    queue = queues_of(task.host).of(task.name)
    _order(
        task,
        interrupt,
        lambda number: queue.watch(interruptdatatype.type, lambda: task.fire(number)),
        single=False,
    )


@builtin("PROC IDelete(VAR intnum Interrupt)")
def idelete(task: TaskContext, *, interrupt: Ref) -> None:
    """Forget an interrupt."""
    task_of(task).machine.interrupts.delete(interrupt.get())


@builtin("PROC ISleep(VAR intnum Interrupt)")
def isleep(task: TaskContext, *, interrupt: Ref) -> None:
    """Ignore an interrupt until IWatch."""
    task_of(task).machine.interrupts.sleep(interrupt.get())


@builtin("PROC IWatch(VAR intnum Interrupt)")
def iwatch(task: TaskContext, *, interrupt: Ref) -> None:
    """Heed it again."""
    task_of(task).machine.interrupts.watch(interrupt.get())


@builtin("PROC IDisable()")
def idisable(task: TaskContext) -> None:
    """Queue all interrupts until IEnable."""
    task_of(task).machine.interrupts.disable()


@builtin("PROC IEnable()")
def ienable(task: TaskContext) -> None:
    """Serve those that were queued."""
    task_of(task).machine.interrupts.enable()


@builtin("PROC GetTrapData(VAR trapdata TrapEvent)")
def get_trap_data(task: TaskContext, *, trapevent: Ref) -> None:
    """Keep what caused the interrupt."""
    trapevent.set(task_of(task).machine.interrupts.data or TrapData())


@builtin(
    "PROC ReadErrData(VAR trapdata TrapEvent, VAR errdomain ErrorDomain, VAR num ErrorId, "
    "VAR errtype ErrorType \\VAR string Title \\VAR string Str1 \\VAR string Str2 "
    "\\VAR string Str3 \\VAR string Str4 \\VAR string Str5)"
)
def read_err_data(task: TaskContext, **arguments: Any) -> None:
    """Take an event apart: domain, number within it, kind, title, cause."""
    del task
    held: TrapData | None = arguments["trapevent"].get()
    if held is None or held.entry is None:
        raise RapidError("ERR_ARGVALERR", "ReadErrData: no event has caused this interrupt")
    entry = held.entry
    arguments["errordomain"].set(float(entry.domain))
    arguments["errorid"].set(float(entry.number % 10_000))
    arguments["errortype"].set(_TYPES.get(entry.kind, TYPE_ALL))
    texts = [entry.title, *entry.cause, "", "", "", "", ""]
    for name, text in zip(("title", "str1", "str2", "str3", "str4", "str5"), texts, strict=False):
        if arguments[name] is not None:
            arguments[name].set(str(text)[:80])
