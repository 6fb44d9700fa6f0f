"""VelSet, AccSet, ConfL and the other instructions that set how later moves are driven."""

from typing import Any

import numpy as np

from hal import Load
from sims.controller.frames import MM
from sims.controller.instructions.common import Setup, instruction, mechanics_of, value_of
from sims.rapid.builtin import Legal, Ref, TaskContext, builtin
from sims.rapid.errors import RapidError

__all__: list[str] = []

UNNAMED = {"tooldata": "tool0", "wobjdata": "wobj0", "loaddata": "load0"}
LEAST_ACC_SHARE = 0.2
LEAST_RAMP_SHARE = 0.1
LEAST_PATH_MPS2 = 0.1


@builtin("PROC ConfL(\\switch On | \\switch Off)", Legal.MOTION)
def conf_l(task: TaskContext, *, on: bool = False, off: bool = False) -> None:
    """Check the configuration at the end of lines and circles, or not."""
    del on
    mechanics_of(task).settings.checks_conf_linear = not off


@builtin("PROC ConfJ(\\switch On | \\switch Off)", Legal.MOTION)
def conf_j(task: TaskContext, *, on: bool = False, off: bool = False) -> None:
    """Go to the programmed configuration, or to the nearest."""
    del on
    mechanics_of(task).settings.checks_conf_joint = not off


@instruction(
    "PROC SingArea(\\switch Wrist | \\switch LockAxis4 | \\switch Arm | \\switch Off)",
    Legal.MOTION,
)
def sing_area(task: TaskContext, *, wrist: bool = False, **_: Any) -> None:
    r"""With ``\Wrist`` lines may turn the tool a little otherwise near the wrist singularity."""
    mechanics_of(task).settings.wrist_interpolation = wrist


@instruction("PROC VelSet(num Override, num Max)", Legal.MOTION)
def vel_set(task: TaskContext, **given: float) -> None:
    """Scale programmed speeds (per cent) and bound the tool's (mm/s)."""
    override, most = given["override"], given["max"]
    if not 0 <= override <= 100 or not most > 0:
        raise RapidError("ERR_ARGVALERR", f"VelSet {override:g}, {most:g}")
    settings = mechanics_of(task).settings
    settings.speed_share = max(override, 0.1) / 100
    settings.most_mps = most * MM


@builtin("PROC AccSet(num Acc, num Ramp \\num FinePointRamp)", Legal.MOTION)
def acc_set(task: TaskContext, *, acc: float, ramp: float, finepointramp: float = 100) -> None:
    """Scale accelerations and how fast they rise (per cent)."""
    del finepointramp
    if not (np.isfinite(acc) and np.isfinite(ramp)):
        raise RapidError("ERR_ARGVALERR", f"AccSet {acc:g}, {ramp:g}")
    settings = mechanics_of(task).settings
    settings.acceleration_share = min(max(acc / 100, LEAST_ACC_SHARE), 1.0)
    settings.ramp_share = min(max(ramp / 100, LEAST_RAMP_SHARE), 1.0)


@builtin(
    "PROC PathAccLim(bool AccLim \\num AccMax, bool DecelLim \\num DecelMax)",
    Legal.MOTION,
)
def path_acc_lim(
    task: TaskContext,
    *,
    acclim: bool,
    decellim: bool,
    accmax: float | None = None,
    decelmax: float | None = None,
) -> None:
    """Bound the tool's acceleration along the path (m/s2)."""
    settings = mechanics_of(task).settings
    settings.path_mps2 = _limit(acclim, accmax)
    settings.path_brake_mps2 = _limit(decellim, decelmax)


def _limit(is_on: bool, most: float | None) -> float | None:
    if not is_on:
        return None
    if most is None or not most >= LEAST_PATH_MPS2:
        raise RapidError("ERR_ACC_TOO_LOW", f"an acceleration limit below {LEAST_PATH_MPS2} m/s2")
    return most


@builtin("PROC WorldAccLim(\\switch On | \\switch Off \\num AccMax)", Legal.MOTION)
def world_acc_lim(
    task: TaskContext, *, on: bool = False, off: bool = False, accmax: float | None = None
) -> None:
    """Bound the tool's acceleration in space (m/s2)."""
    del off
    settings = mechanics_of(task).settings
    settings.path_mps2 = settings.path_brake_mps2 = _limit(on, accmax)


@builtin("PROC SpeedRefresh(num Override)", Legal.MOTION)
def speed_refresh(task: TaskContext, *, override: float) -> None:
    """Scale the speed of the motion under way and of all that follow (per cent)."""
    if not 0 <= override <= 100:
        raise RapidError("ERR_SPEED_REFRESH_LIM", f"SpeedRefresh {override:g}")
    mechanics = mechanics_of(task)
    mechanics.refresh(override / 100)


@builtin("FUNC num CSpeedOverride(\\switch CTask)")
def c_speed_override(task: TaskContext, *, ctask: bool = False) -> float:
    """The operator's override, or this task's (per cent)."""
    mechanics = mechanics_of(task)
    return 100 * (mechanics.refresh_share if ctask else mechanics.operator_share)


@builtin("FUNC num MaxRobSpeed()")
def max_rob_speed(task: TaskContext) -> float:
    """The tool's greatest speed (mm/s)."""
    return mechanics_of(task).settings.most_mps / MM


@builtin("PROC GripLoad(PERS loaddata Load)", Legal.MOTION)
def grip_load(task: TaskContext, *, load: Ref) -> None:
    """Tell the servo what the gripper carries; the gripper itself it knows."""
    mass_kg, centre = load.get()[0], load.get()[1]
    if not (np.isfinite(mass_kg) and mass_kg >= 0 and np.isfinite(centre).all()):
        raise RapidError("ERR_ARGVALERR", f"a load of {mass_kg:g} kg")
    mechanics = mechanics_of(task)
    tool = mechanics.active.T_flange_tcp
    at = tool[:3, :3] @ (np.array(centre, float) * MM) + tool[:3, 3]
    mechanics.name("loaddata", load)
    mechanics.set_load(Load(mass_kg, (float(at[0]), float(at[1]), float(at[2]))))


@builtin(
    "PROC SetSysData(PERS anytype SourceObject \\string ObjectName)",
    Legal.MOTION,
)
def set_sys_data(task: TaskContext, *, sourceobject: Ref, objectname: str | None = None) -> None:
    """Make tool, object or load the active one."""
    del objectname
    mechanics = mechanics_of(task)
    value, active = value_of(sourceobject), mechanics.active
    if sourceobject.base in ("tooldata", "wobjdata"):
        mechanics.name(sourceobject.base, sourceobject)
    match sourceobject.base.lower():
        case "tooldata":
            frame = Setup.of(value, None).T_flange_tcp
            mechanics.active = Setup(frame, active.T_base_object)
        case "wobjdata":
            frame = Setup.of(None, value).T_base_object
            mechanics.active = Setup(active.T_flange_tcp, frame)
        case "loaddata":
            grip_load(task, load=sourceobject)
        case other:
            raise RapidError("ERR_ARGVALERR", f"SetSysData wants tool, wobj or load, not {other}")


@instruction(
    "PROC CirPathMode(\\switch PathFrame | \\switch ObjectFrame | \\switch CirPointOri | "
    "\\switch Wrist45 | \\switch Wrist46 | \\switch Wrist56)",
    Legal.MOTION,
)
def cir_path_mode(task: TaskContext, **given: Any) -> None:
    """How the tool turns on circles: through the middle point's orientation with CirPointOri."""
    chosen = next((name for name, is_on in given.items() if is_on), "pathframe")
    mechanics_of(task).settings.circle_mode = chosen


@builtin("PROC MotionSup(\\switch On | \\switch Off \\num TuneValue)", Legal.MOTION)
def motion_sup(
    task: TaskContext, *, on: bool = False, off: bool = False, tunevalue: float | None = None
) -> None:
    """Watch for collisions, or not; a higher tune value (per cent) is less sensitive."""
    del on
    if tunevalue is not None and not 0 < tunevalue <= 300:
        raise RapidError("ERR_ARGVALERR", f"MotionSup \\TuneValue:={tunevalue:g}: 1 to 300")
    settings = mechanics_of(task).settings
    settings.supervises = not off
    settings.supervision_share = (tunevalue or 100) / 100


@builtin("PROC GetSysData(VAR anytype DestObject \\VAR string ObjectName)")
def get_sys_data(task: TaskContext, *, destobject: Ref, objectname: Ref | None = None) -> None:
    """Read the active tool, object or load, and its name."""
    name, value = _active(task, destobject.base)
    destobject.set(value)
    if objectname is not None:
        objectname.set(name)


@builtin("FUNC tooldata CTool(\\VAR taskid TaskRef | \\string TaskName)")
def c_tool(task: TaskContext, *, taskref: Ref | None = None, taskname: str | None = None) -> Any:
    """The active tool."""
    del taskref, taskname
    return _active(task, "tooldata")[1]


@builtin("FUNC wobjdata CWObj(\\VAR taskid TaskRef | \\string TaskName)")
def c_w_obj(task: TaskContext, *, taskref: Ref | None = None, taskname: str | None = None) -> Any:
    """The active work object."""
    del taskref, taskname
    return _active(task, "wobjdata")[1]


def _active(task: TaskContext, kind: str) -> tuple[str, Any]:
    usual = UNNAMED.get(kind)
    if usual is None:
        raise RapidError("ERR_ARGVALERR", f"tool, wobj or load can be read, not {kind}")
    given = mechanics_of(task).named.get(kind)
    if given is not None:
        return given
    data = task.find(usual)
    assert data is not None
    return usual, data.get()


@builtin("PROC PathResol(num PathSampleTime)", Legal.MOTION)
def path_resol(task: TaskContext, *, pathsampletime: float) -> None:
    """How finely the path is sampled (25 to 400 per cent); here always to the tick."""
    del task
    if not 25 <= pathsampletime <= 400:
        raise RapidError("ERR_ARGVALERR", f"PathResol {pathsampletime:g}: 25 to 400")


@builtin("PROC CornerPathWarning(bool Active)", Legal.MOTION)
def corner_path_warning(task: TaskContext, *, active: bool) -> None:
    """Whether a corner that could not be driven is written into the event log."""
    mechanics_of(task).settings.warns_of_corners = active


@builtin("PROC ActEventBuffer()", Legal.MOTION)
def act_event_buffer(task: TaskContext) -> None:
    """Events of signals are not buffered here."""
    del task


@builtin("PROC DeactEventBuffer()", Legal.MOTION)
def deact_event_buffer(task: TaskContext) -> None:
    """As it is here always."""
    del task
