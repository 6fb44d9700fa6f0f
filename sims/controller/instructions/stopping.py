"""StopMove, StartMove, ClearPath, StorePath, RestoPath, WaitRob."""

from typing import Any

from sims.controller.instructions.common import (
    STOP_MOVE,
    STOP_MOVE_OTHER,
    instruction,
    mechanics_of,
    not_supported,
)
from sims.rapid.builtin import Legal, TaskContext, builtin
from sims.rapid.errors import RapidError

__all__: list[str] = []

MOST_STORED = 5


@builtin("PROC StopMove(\\switch Quick \\switch AllMotionTasks)")
def stop_move(task: TaskContext, *, quick: bool = False, allmotiontasks: bool = False) -> None:
    """Brake on the path and keep it; the program goes on at once."""
    del quick
    reason = _reason(task, allmotiontasks, "StopMove")
    mechanics_of(task).unit.hold(reason)


@builtin("PROC StartMove(\\switch AllMotionTasks)")
def start_move(task: TaskContext, *, allmotiontasks: bool = False) -> None:
    """Go on after StopMove; an arm that was moved away returns to its path slowly."""
    reason = _reason(task, allmotiontasks, "StartMove")
    mechanics_of(task).unit.release(reason)


@builtin("PROC StartMoveRetry(\\switch AllMotionTasks)", Legal.HANDLER)
def start_move_retry(task: TaskContext, *, allmotiontasks: bool = False) -> None:
    """Go on after StopMove; the compiler makes a RETRY follow."""
    start_move(task, allmotiontasks=allmotiontasks)


@builtin("PROC StopMoveReset(\\switch AllMotionTasks)")
def stop_move_reset(task: TaskContext, *, allmotiontasks: bool = False) -> None:
    """Forget that StopMove was called, and the path with it."""
    reason = _reason(task, allmotiontasks, "StopMoveReset")
    unit = mechanics_of(task).unit
    unit.drop()
    unit.release(reason)


def _reason(task: TaskContext, is_for_all: bool, name: str) -> str:
    if task.has_motion:
        return STOP_MOVE
    if not is_for_all:
        raise RapidError(
            "ERR_ARGVALERR",
            f"{task.name} moves nothing: {name} needs \\AllMotionTasks here",
            is_fatal=True,
        )
    return STOP_MOVE_OTHER


@builtin("FUNC bool IsStopMoveAct(\\switch FromMoveTask | \\switch FromNonMoveTask)")
def is_stop_move_act(
    task: TaskContext, *, frommovetask: bool = False, fromnonmovetask: bool = False
) -> bool:
    """Whether StopMove is in force, from whichever kind of task is asked for."""
    holds = mechanics_of(task).unit.holds
    of_move = STOP_MOVE in holds and not fromnonmovetask
    return of_move or (STOP_MOVE_OTHER in holds and not frommovetask)


@builtin("PROC ClearPath()", Legal.MOTION)
def clear_path(task: TaskContext) -> None:
    """Drop what is left of the path; an arm that moves brakes on it first."""
    mechanics_of(task).unit.drop()


@builtin("PROC StorePath(\\switch KeepSync)", Legal.MOTION)
async def store_path(task: TaskContext, *, keepsync: bool = False) -> None:
    """Put the path aside, once the arm stands, so that another one can be driven."""
    if keepsync:
        raise not_supported("StorePath \\KeepSync: coordinated motion")
    unit = mechanics_of(task).unit
    if len(unit.stored) >= MOST_STORED:
        raise RapidError("ERR_PATH_STOP", f"{MOST_STORED} paths are stored already", is_fatal=True)
    unit.hold("StorePath")
    await unit.standing()
    unit.store()
    unit.release("StorePath")
    unit.release(STOP_MOVE)


@builtin("FUNC num PathLevel()")
def path_level(task: TaskContext) -> float:
    """1 on the original path, one more for each that is stored."""
    return 1.0 + len(mechanics_of(task).unit.stored)


@builtin("PROC RestoPath()", Legal.MOTION)
async def resto_path(task: TaskContext) -> None:
    """Take the stored path up again; StartMove or the program's restart drives it on."""
    unit = mechanics_of(task).unit
    if not unit.stored:
        raise RapidError("ERR_PATH_STOP", "RestoPath without StorePath", is_fatal=True)
    await unit.standing()
    unit.hold(STOP_MOVE)
    unit.unstore()


@builtin("PROC WaitRob(\\switch InPos | \\switch ZeroSpeed)", Legal.MOTION)
async def wait_rob(task: TaskContext, *, inpos: bool = False, zerospeed: bool = False) -> None:
    """Wait until the arm stands at the end of its path, or just stands."""
    if not (inpos or zerospeed):
        raise RapidError("ERR_ARGVALERR", "WaitRob needs \\InPos or \\ZeroSpeed", is_fatal=True)
    unit = mechanics_of(task).unit
    if inpos and unit.moves:
        await unit.ended(unit.moves[-1])
    await unit.standing()


def _refused(name: str, declaration: str) -> None:
    @instruction(f"PROC {name}({declaration})")
    def refuse(task: TaskContext, **_: Any) -> None:
        del task
        raise not_supported(name)


for _name, _declaration in (
    ("PathRecStart", "VAR pathrecid ID"),
    ("PathRecStop", "\\switch Clear"),
    ("PathRecMoveBwd", "\\VAR pathrecid ID \\PERS tooldata ToolOffs \\speeddata Speed"),
    ("PathRecMoveFwd", "\\VAR pathrecid ID \\PERS tooldata ToolOffs \\speeddata Speed"),
    ("SyncMoveSuspend", ""),
    ("SyncMoveResume", ""),
    ("SoftAct", "\\VAR mecunit MechUnit, num Axis, num Softness \\num Ramp"),
    ("SoftDeact", "\\num Ramp"),
):
    _refused(_name, _declaration)
