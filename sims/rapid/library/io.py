"""Signals: writing and reading them, pulses, aliases."""

import asyncio
from collections.abc import Callable
from typing import Any

from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.errors import RapidError
from sims.rapid.host import Signal, SignalKind
from sims.rapid.task import task_of

HIGH, LOW = 1.0, 0.0
MIN_PULSE_S, MAX_PULSE_S = 0.001, 2000.0
NOT_DEFINED, CONFIGURED, ALIASED = 0.0, 1.0, 2.0


class _Later:
    """Delayed writes of one task's program; they are dropped when it starts anew."""

    def __init__(self) -> None:
        self._handles: dict[int, asyncio.TimerHandle] = {}

    def after(self, signal: Signal, delay_s: float, action: Callable[[], None]) -> None:
        """Do it later instead of what was to be done with this signal."""
        self.cancel(signal)
        loop = asyncio.get_running_loop()
        self._handles[id(signal)] = loop.call_later(delay_s, action)

    def cancel(self, signal: Signal) -> None:
        """Forget what was to be done with it."""
        handle = self._handles.pop(id(signal), None)
        if handle is not None:
            handle.cancel()

    def close(self) -> None:
        """Forget all."""
        for handle in self._handles.values():
            handle.cancel()
        self._handles.clear()


def _write(task: TaskContext, signal: Signal, value: float, delay_s: float | None = None) -> None:
    later = task_of(task).service(_Later)
    if delay_s:
        if not 0.0 <= delay_s <= MAX_PULSE_S:
            raise RapidError("ERR_ARGVALERR", f"a delay of {delay_s:g} s is not possible")
        later.after(signal, delay_s, lambda: signal.set(value))
        return
    later.cancel(signal)
    signal.set(value)


@builtin("PROC Set(signaldo Signal)")
def set_(task: TaskContext, *, signal: Signal) -> None:
    """To 1."""
    _write(task, signal, HIGH)


@builtin("PROC Reset(signaldo Signal)")
def reset(task: TaskContext, *, signal: Signal) -> None:
    """To 0."""
    _write(task, signal, LOW)


@builtin("PROC InvertDO(signaldo Signal)")
def invert_do(task: TaskContext, *, signal: Signal) -> None:
    """To the other value."""
    _write(task, signal, HIGH - signal.value)


@builtin("PROC SetDO(\\num SDelay | switch Sync, signaldo Signal, dionum Value)")
def set_do(
    task: TaskContext, *, sdelay: float | None, sync: bool, signal: Signal, value: float
) -> None:
    """Write a digital output, now or later."""
    del sync
    _write(task, signal, HIGH if value else LOW, sdelay)


@builtin("PROC SetAO(signalao Signal, num Value)")
def set_ao(task: TaskContext, *, signal: Signal, value: float) -> None:
    """Write an analog output."""
    _write(task, signal, value)


@builtin("PROC SetGO(\\num SDelay, signalgo Signal, dnum Value)")
def set_go(task: TaskContext, *, sdelay: float | None, signal: Signal, value: float) -> None:
    """Write a group of outputs."""
    _write(task, signal, value, sdelay)


@builtin("PROC PulseDO(\\switch High \\num PLength, signaldo Signal)")
def pulse_do(task: TaskContext, *, high: bool, plength: float | None, signal: Signal) -> None:
    """Change an output for a while, 0.2 s if not said."""
    length_s = 0.2 if plength is None else plength
    if not MIN_PULSE_S <= length_s <= MAX_PULSE_S:
        raise RapidError("ERR_ARGVALERR", f"a pulse of {length_s:g} s is not possible")
    after = LOW if high else signal.value
    later = task_of(task).service(_Later)
    later.cancel(signal)
    signal.set(HIGH if high else HIGH - signal.value)
    later.after(signal, length_s, lambda: signal.set(after))


def _add_reading(name: str, kind: str, result: str) -> None:
    @builtin(f"FUNC {result} {name}(signal{kind} Signal)")
    def read(task: TaskContext, *, signal: Signal) -> float:
        del task
        return signal.value


for _name, _kind, _result in (
    ("DInput", "di", "dionum"),
    ("DOutput", "do", "dionum"),
    ("AInput", "ai", "num"),
    ("AOutput", "ao", "num"),
    ("GInput", "gi", "num"),
    ("GOutput", "go", "num"),
    ("GInputDnum", "gi", "dnum"),
    ("GOutputDnum", "go", "dnum"),
):
    _add_reading(_name, _kind, _result)


@builtin("FUNC bool TestDI(signaldi Signal)")
def test_di(task: TaskContext, *, signal: Signal) -> bool:
    """Whether it is 1."""
    del task
    return signal.value == HIGH


@builtin("PROC AliasIO(REF anytype FromSignal, REF anytype ToSignal)")
def alias_io(task: TaskContext, *, fromsignal: Ref, tosignal: Ref) -> None:
    """Connect a signal variable with a signal, named or given. ERR_ALIASIO_DEF, _TYPE."""
    found: Any = fromsignal.get()
    if isinstance(found, str):
        found = task.host.signals.get(found.lower())
    if found is None:
        raise RapidError("ERR_ALIASIO_DEF", f"there is no signal {fromsignal.get()}")
    if tosignal.type not in {"signalxx", f"signal{SignalKind(found.kind).value.lower()}"}:
        raise RapidError("ERR_ALIASIO_TYPE", f"{found.name} is no {tosignal.type}")
    tosignal.set(found)


@builtin("PROC AliasIOReset(REF anytype Signal)")
def alias_io_reset(task: TaskContext, *, signal: Ref) -> None:
    """Disconnect a signal variable."""
    del task
    signal.set(None)


@builtin("FUNC signalorigin GetSignalOrigin(REF anytype Signal, VAR string SignalName)")
def get_signal_origin(task: TaskContext, *, signal: Ref, signalname: Ref) -> float:
    """Whether a signal is configured, an alias or neither; and its name."""
    del task
    found: Any = signal.get()
    signalname.set("" if found is None else found.name)
    if found is None:
        return NOT_DEFINED
    return ALIASED if signal.name else CONFIGURED


@builtin("FUNC bool ValidIO(REF anytype Signal)")
def valid_io(task: TaskContext, *, signal: Ref) -> bool:
    """Whether a signal can be used."""
    del task
    return signal.get() is not None


def _add_unit(name: str) -> None:
    @builtin(f"PROC {name}(string UnitName, num MaxTime)")
    async def switch_unit(task: TaskContext, *, unitname: str, maxtime: float) -> None:
        """Nothing to do: simulated units are always there."""
        del task, unitname, maxtime


_add_unit("IOEnable")
_add_unit("IODisable")
