"""What a backup says about a controller."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from sims.controller.cfg import Cfg
from sims.rapid.builtin import TaskKind
from sims.rapid.errors import Diagnostic
from sims.rapid.host import SignalKind

__all__ = [
    "Backup",
    "BackupTask",
    "CrossConnection",
    "Event",
    "EventRoutine",
    "MotionConfig",
    "SignalConfig",
    "SystemInput",
    "SystemOutput",
]


class Event(StrEnum):
    """When an event routine runs."""

    POWER_ON = "POWERON"
    START = "START"
    STOP = "STOP"
    QSTOP = "QSTOP"
    RESTART = "RESTART"
    RESET = "RESET"
    STEP = "STEP"


@dataclass(frozen=True, slots=True)
class BackupTask:
    """One task. ``modules`` are to be loaded, in this order; ``entry`` is the first routine.

    ``trust_level`` is as SYS.cfg has it (``SysFail``, ``SysHalt``, ``SysStop``, ``NoSafety``).
    ``number`` is that of the folder ``RAPID/TASKn``, 0 where there is none.
    """

    name: str
    kind: TaskKind
    has_motion: bool
    entry: str = "main"
    modules: tuple[Path, ...] = ()
    trust_level: str = "SysFail"
    number: int = 0


@dataclass(frozen=True, slots=True)
class SignalConfig:
    """One signal of EIO.cfg. ``bits`` counts those of a group; logical bounds are of analogues."""

    name: str
    kind: SignalKind
    device: str = ""
    device_map: str = ""
    access: str = ""
    label: str = ""
    default: float = 0.0
    bits: int = 1
    is_inverted: bool = False
    logical_min: float = 0.0
    logical_max: float = 0.0


@dataclass(frozen=True, slots=True)
class CrossConnection:
    """``result`` follows the actors; ``operators`` (AND, OR) stand between them, left to right.

    An actor is a signal's name and whether it is inverted.
    """

    result: str
    actors: tuple[tuple[str, bool], ...]
    operators: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class SystemInput:
    """A signal that asks for ``action`` (``Start``, ``MotorOn``, ``PPMain`` ...)."""

    signal: str
    action: str
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class SystemOutput:
    """A signal that tells ``status`` (``MotorOn``, ``CycleOn``, ``EmStop`` ...)."""

    status: str
    signal: str
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class EventRoutine:
    """``routine`` runs at ``event`` in ``task``, in all tasks if that is empty, by ``sequence``."""

    event: Event
    routine: str
    task: str = ""
    sequence: int = 0


@dataclass(frozen=True, slots=True)
class MotionConfig:
    """What MOC.cfg says of the first robot; None and empty where it does not say.

    ``joint_bounds_rad`` are (lower, upper) of axes 1 to 6. The base frame is in the world.
    """

    robot_type: str = ""
    joint_bounds_rad: tuple[tuple[float, float], ...] | None = None
    base_position_m: tuple[float, float, float] | None = None
    base_orientation: tuple[float, float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Backup:
    """A whole backup. ``rest`` names what is there and was not understood or not loaded."""

    folder: Path
    system: str = ""
    robotware: str = ""
    home: Path | None = None
    tasks: tuple[BackupTask, ...] = ()
    signals: tuple[SignalConfig, ...] = ()
    crosses: tuple[CrossConnection, ...] = ()
    system_inputs: tuple[SystemInput, ...] = ()
    system_outputs: tuple[SystemOutput, ...] = ()
    event_routines: tuple[EventRoutine, ...] = ()
    motion: MotionConfig = field(default_factory=MotionConfig)
    cfgs: Mapping[str, Cfg] = field(default_factory=dict)
    rest: tuple[str, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()
