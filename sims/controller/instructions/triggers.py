"""TriggIO, TriggEquip, TriggInt, TriggCheckIO: what is to happen on the way of a later move."""

import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, cast

from sims.controller.frames import MM
from sims.controller.instructions.common import (
    STOP_MOVE,
    instruction,
    mechanics_of,
    not_supported,
)
from sims.controller.queue import Happening
from sims.rapid.builtin import Legal, Ref, TaskContext, builtin, opaque
from sims.rapid.errors import RapidError
from sims.rapid.host import EventKind, Signal, SignalKind

__all__ = ["Trigger", "happening_of", "output_at", "signal_of", "told"]

opaque("triggdata")

LONGEST_EARLY_S = 0.5
# By the value of the constants LT to GT.
RELATIONS = {
    1.0: operator.lt,
    2.0: operator.le,
    3.0: operator.eq,
    4.0: operator.ne,
    5.0: operator.ge,
    6.0: operator.gt,
}


@dataclass(frozen=True, eq=False)
class Trigger:
    """A triggdata: ``act`` is called ``lead_s`` before the place is reached.

    The place is ``distance_m`` before the end of the move, or after its start.
    """

    act: Callable[[TaskContext], None]
    distance_m: float
    lead_s: float
    is_from_start: bool


def happening_of(trigger: Trigger, task: TaskContext) -> Happening:
    """A trigger for one move of a task."""

    def act() -> None:
        told(task, lambda: trigger.act(task))

    return Happening(act, trigger.distance_m, trigger.lead_s, trigger.is_from_start)


def told(task: TaskContext, act: Callable[[], None]) -> None:
    """Do something on the way; what it refuses is logged, for no instruction waits for it."""
    try:
        act()
    except RapidError as error:
        cause = [f"Task {task.name}", str(error)]
        task.host.log.write(EventKind.ERROR, 4, 40223, "Trigger failed", cause)


def signal_of(given: Any) -> Signal:
    """A signal argument, by value or by reference."""
    return cast(Signal, given.get() if hasattr(given, "get") else given)


def _setting(given: dict[str, Any]) -> Callable[[TaskContext], None]:
    signals = [given[key] for key in ("dop", "gop", "aop") if given.get(key) is not None]
    if not signals:
        if given.get("procid") is not None:
            raise not_supported("a trigger with \\ProcID")
        raise RapidError("ERR_ARGVALERR", "a trigger needs \\DOp, \\GOp or \\AOp", is_fatal=True)
    signal, value = signal_of(signals[0]), float(given["setvalue"])
    return lambda _: signal.set(value)


@instruction(
    "PROC TriggIO(VAR triggdata TriggData, num Distance \\switch Start | \\switch Time "
    "\\signaldo DOp | \\signalgo GOp | \\signalao AOp | \\string ProcID, "
    "num SetValue \\num DODelay)",
    Legal.MOTION,
)
def trigg_io(task: TaskContext, **given: Any) -> None:
    """Set an output at a fixed place, or a time before the end."""
    del task
    given["triggdata"].set(_placed(given, _setting(given), -float(given.get("dodelay") or 0)))


@instruction(
    "PROC TriggEquip(VAR triggdata TriggData, num Distance \\switch Start, num EquipLag "
    "\\signaldo DOp | \\signalgo GOp | \\signalao AOp | \\string ProcID, "
    "num SetValue \\switch Inhib)",
    Legal.MOTION,
)
def trigg_equip(task: TaskContext, **given: Any) -> None:
    """Set an output at a place, earlier by the lag of what it switches."""
    del task
    lag_s = float(given["equiplag"])
    if abs(lag_s) > 1.0:
        raise RapidError("ERR_ARGVALERR", f"TriggEquip with an EquipLag of {lag_s:g} s")
    given["triggdata"].set(_placed(given, _setting(given), lag_s))


@instruction(
    "PROC TriggInt(VAR triggdata TriggData, num Distance \\switch Start | \\switch Time, "
    "VAR intnum Interrupt)",
    Legal.MOTION,
)
def trigg_int(task: TaskContext, **given: Any) -> None:
    """Let an interrupt happen at a place."""
    del task
    interrupt: Ref = given["interrupt"]
    given["triggdata"].set(_placed(given, lambda where: where.fire(int(interrupt.get())), 0.0))


@instruction(
    "PROC TriggCheckIO(VAR triggdata TriggData, num Distance \\switch Start | \\switch Time, "
    "REF anytype Signal, opnum Relation, num CheckValue \\dnum CheckDvalue \\switch StopMove, "
    "VAR intnum Interrupt)",
    Legal.MOTION,
)
def trigg_check_io(task: TaskContext, **given: Any) -> None:
    r"""At a place compare a signal; an interrupt happens where that is not as it should be.

    With ``\StopMove`` the arm brakes on its path as well.
    """
    del task
    signal, compare = signal_of(given["signal"]), RELATIONS.get(given["relation"])
    if compare is None or not hasattr(signal, "watch"):
        raise RapidError("ERR_ARGVALERR", "TriggCheckIO wants a signal and LT to GT")
    wanted = given["checkvalue"] if given.get("checkdvalue") is None else given["checkdvalue"]
    interrupt: Ref = given["interrupt"]

    def check(where: TaskContext) -> None:
        if not compare(signal.value, wanted):
            if given.get("stopmove"):
                mechanics_of(where).unit.hold(STOP_MOVE)
            where.fire(int(interrupt.get()))

    given["triggdata"].set(_placed(given, check, 0.0))


def output_at(task: TaskContext, record: Sequence[Any]) -> Trigger:
    """The trigger of a triggios, triggstrgo or triggiosdnum. ERR_ARGVALERR."""
    _, distance, is_from_start, lag_s, name, value, _ = record
    signal = task.host.signals.get(name.lower())
    if signal is None or signal.kind not in (SignalKind.DO, SignalKind.GO, SignalKind.AO):
        raise RapidError("ERR_ARGVALERR", f"there is no output {name}")
    if not distance >= 0 or not abs(lag_s) <= 1.0:
        raise RapidError("ERR_ARGVALERR", f"{name}: {distance:g} mm, a lag of {lag_s:g} s")
    if isinstance(value, str) and not value.isdigit():
        raise RapidError("ERR_ARGVALERR", f"{name}: {value!r} is no number")
    number = float(value)
    return Trigger(lambda _: signal.set(number), distance * MM, lag_s, is_from_start)


@builtin("FUNC bool TriggDataValid(VAR triggdata TriggData)")
def trigg_data_valid(task: TaskContext, *, triggdata: Ref) -> bool:
    """Whether a trigger has been set up."""
    del task
    return isinstance(triggdata.get(), Trigger)


@builtin("PROC TriggDataReset(VAR triggdata TriggData)")
def trigg_data_reset(task: TaskContext, *, triggdata: Ref) -> None:
    """Make it none."""
    del task
    triggdata.set(None)


@builtin("PROC TriggDataCopy(VAR triggdata FromTriggData, VAR triggdata ToTriggData)")
def trigg_data_copy(task: TaskContext, *, fromtriggdata: Ref, totriggdata: Ref) -> None:
    """Set another one up in the same way."""
    del task
    totriggdata.set(fromtriggdata.get())


def _placed(given: dict[str, Any], act: Callable[[TaskContext], None], lead_s: float) -> Trigger:
    distance = float(given["distance"])
    if not distance >= 0:
        raise RapidError("ERR_ARGVALERR", f"a trigger at a distance of {distance:g}")
    if given.get("time"):
        return Trigger(act, 0.0, min(distance, LONGEST_EARLY_S) + lead_s, False)
    return Trigger(act, distance * MM, lead_s, bool(given.get("start")))
