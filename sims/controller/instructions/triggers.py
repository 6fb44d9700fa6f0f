"""TriggIO, TriggEquip, TriggInt: what is to happen on the way of a later move."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

from sims.controller.frames import MM
from sims.controller.instructions.common import instruction, not_supported
from sims.controller.queue import Happening
from sims.rapid.builtin import Legal, Ref, TaskContext, opaque
from sims.rapid.errors import RapidError
from sims.rapid.host import EventKind, Signal

__all__ = ["Trigger", "happening_of", "signal_of", "told"]

opaque("triggdata")

LONGEST_EARLY_S = 0.5


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


def _placed(given: dict[str, Any], act: Callable[[TaskContext], None], lead_s: float) -> Trigger:
    distance = float(given["distance"])
    if not distance >= 0:
        raise RapidError("ERR_ARGVALERR", f"a trigger at a distance of {distance:g}")
    if given.get("time"):
        return Trigger(act, 0.0, min(distance, LONGEST_EARLY_S) + lead_s, False)
    return Trigger(act, distance * MM, lead_s, bool(given.get("start")))
