"""What a program can ask about the controller and its tasks."""

from typing import Any

from sims.rapid.builtin import Ref, TaskContext, TaskKind, builtin
from sims.rapid.errors import RapidError
from sims.rapid.task import task_of

_INFO = (
    "\\switch SerialNo | switch SWVersion | switch RobotType | switch CtrlId | switch LanIp "
    "| switch CtrlLang | switch SystemName | switch SWVersionName"
)
_MODES = {"OP_UNDEF": 0.0, "OP_AUTO": 1.0, "OP_MAN_PROG": 2.0, "OP_MAN_TEST": 3.0}
_RUN_MODES = {"RUN_UNDEF": 0.0, "RUN_CONT_CYCLE": 1.0}


@builtin(f"FUNC string GetSysInfo({_INFO})")
def get_sys_info(task: TaskContext, **asked: bool) -> str:
    """One thing about the controller; the serial number if nothing is said."""
    name = next((name for name, is_asked in asked.items() if is_asked), "serialno")
    return task.host.info.get(name, "")[:80]


@builtin("FUNC bool IsSysId(string SystemId)")
def is_sys_id(task: TaskContext, *, systemid: str) -> bool:
    """Whether this is the controller with that serial number."""
    return task.host.info.get("serialno", "").lower() == systemid.lower()


@builtin("FUNC string Type(REF anytype Data \\switch BaseName)")
def type_(task: TaskContext, *, data: Ref, basename: bool) -> str:
    """The type of data as declared, or what an alias stands for."""
    del task
    return data.base if basename else data.type


@builtin("FUNC bool NonMotionMode(\\switch Main)")
def non_motion_mode(task: TaskContext, *, main: bool) -> bool:
    """Programs are never run without motion here."""
    del task, main
    return False


@builtin("FUNC bool PFRestart(\\switch Base | switch Irrev)")
def pf_restart(task: TaskContext, *, base: bool, irrev: bool) -> bool:
    """Whether the power failed on the way: never here."""
    del task, base, irrev
    return False


@builtin("FUNC symnum OpMode()")
def op_mode(task: TaskContext) -> float:
    """``OP_AUTO`` and so on."""
    return _MODES[task.host.op_mode]


@builtin("FUNC symnum RunMode(\\switch Main)")
def run_mode(task: TaskContext, *, main: bool) -> float:
    """``RUN_CONT_CYCLE`` while programs run."""
    del main
    return _RUN_MODES[task.host.run_mode]


@builtin("FUNC string GetTaskName(\\INOUT num TaskNo | INOUT num MecTaskNo)")
def get_task_name(task: TaskContext, *, taskno: Ref | None, mectaskno: Ref | None) -> str:
    """The task's name, and its number among all, or among those with a robot."""
    owner = task_of(task)
    peers = list(owner.peers.values())
    if taskno is not None:
        taskno.set(float(peers.index(owner) + 1))
    if mectaskno is not None:
        moving = [peer for peer in peers if peer.has_motion]
        mectaskno.set(float(moving.index(owner) + 1) if owner in moving else 0.0)
    return task.name


@builtin("FUNC bool TaskRunRob()")
def task_run_rob(task: TaskContext) -> bool:
    """Whether the task moves a robot."""
    return task.has_motion


@builtin("FUNC bool TaskRunMec()")
def task_run_mec(task: TaskContext) -> bool:
    """Whether the task moves a mechanical unit."""
    return task.has_motion


@builtin("FUNC bool TaskIsActive(string TaskName)")
def task_is_active(task: TaskContext, *, taskname: str) -> bool:
    """Whether a NORMAL task is selected. ERR_TASKNAME."""
    return _peer(task, taskname).kind is TaskKind.NORMAL


@builtin("FUNC bool TaskIsExecuting(string TaskName)")
def task_is_executing(task: TaskContext, *, taskname: str) -> bool:
    """Whether a task executes. ERR_TASKNAME."""
    return bool(task_of(_peer(task, taskname)).is_running)


@builtin("FUNC bool IsStopStateEvent(\\switch PPMoved | switch PPToMain)")
def is_stop_state_event(task: TaskContext, *, ppmoved: bool, pptomain: bool) -> bool:
    """Whether the pointer was moved since the last start."""
    del ppmoved, pptomain
    return not task_of(task).has_begun


@builtin("FUNC event_type EventType()")
def event_type(task: TaskContext) -> float:
    """Which event routine runs, 0: none."""
    return task_of(task).event


@builtin("FUNC exec_level ExecLevel()")
def exec_level(task: TaskContext) -> float:
    """Whether a trap runs."""
    return 1.0 if task_of(task).machine.interrupts.in_trap else 0.0


@builtin("FUNC handler_type ExecHandler()")
def exec_handler(task: TaskContext) -> float:
    """Whether an error handler runs."""
    return 2.0 if task_of(task).machine.frame.error is not None else 0.0


@builtin("PROC ReadCfgData(string InstancePath, string Attribute, INOUT anytype CfgData)")
def read_cfg_data(task: TaskContext, *, instancepath: str, attribute: str, cfgdata: Ref) -> None:
    """Read a system parameter. ERR_CFG_NOTFND, ERR_CFG_ILLTYPE."""
    try:
        found: Any = task.host.cfg(instancepath.strip("/"), attribute)
    except KeyError:
        raise RapidError("ERR_CFG_NOTFND", f"there is no {instancepath} {attribute}") from None
    try:
        cfgdata.set(float(found) if type(found) is int else found)
    except RapidError as error:
        raise RapidError("ERR_CFG_ILLTYPE", f"{attribute} is no {cfgdata.type}") from error


def _peer(task: TaskContext, name: str) -> TaskContext:
    for other in task_of(task).peers.values():
        if other.name.lower() == name.lower():
            return other
    raise RapidError("ERR_TASKNAME", f"there is no task {name}")
