"""Ending, repeating and choosing: Stop, ExitCycle, CallByVar, TryInt."""

from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.errors import RapidError
from sims.rapid.host import EventKind
from sims.rapid.machine import Halt
from sims.rapid.task import task_of

RAPID_DOMAIN = 8


@builtin("PROC Stop(\\switch NoRegain | switch AllMoveTasks)")
def stop(task: TaskContext, *, noregain: bool, allmovetasks: bool) -> None:
    """Stop; a start goes on behind it."""
    del noregain, allmovetasks
    task_of(task).machine.request(Halt.STOP)


@builtin("PROC Break()")
def break_(task: TaskContext) -> None:
    """Stop at once, for debugging."""
    task_of(task).machine.request(Halt.STOP)


@builtin("PROC ExitCycle()")
def exit_cycle(task: TaskContext) -> None:
    """Leave the cycle; the next one begins at main, variables keep their values."""
    task_of(task).machine.request(Halt.EXIT_CYCLE)


@builtin("PROC SystemStopAction(\\switch Stop | switch StopBlock | switch Halt)")
def system_stop_action(task: TaskContext, *, stop: bool, stopblock: bool, halt: bool) -> None:
    """Stop the tasks; StopBlock and Halt lose the program pointer."""
    task.host.log.write(
        EventKind.STATE, RAPID_DOMAIN, 80_000, "SystemStopAction", [f"Task {task.name}"]
    )
    del stop
    task_of(task).machine.request(Halt.EXIT if stopblock or halt else Halt.STOP)


@builtin("PROC CallByVar(string Name, num Number)")
def call_by_var(task: TaskContext, *, name: str, number: float) -> str:
    """Give the name of the procedure; the compiler makes the call of it."""
    del task
    return f"{name}{number:g}"


@builtin("PROC TryInt(REF anytype DataObj)")
def try_int(task: TaskContext, *, dataobj: Ref) -> None:
    """Check that a number is whole. ERR_INT_NOTVAL."""
    del task
    value = dataobj.get()
    if value != int(value):
        raise RapidError("ERR_INT_NOTVAL", f"{value:g} is not whole")
