"""What a controller is made of: from a backup folder, from module files, or by hand."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from drivers.arms import ARMS, ArmModel
from hal.errors import ConfigError
from sims.controller.backup import (
    Backup,
    CrossConnection,
    EventRoutine,
    SignalConfig,
    SystemInput,
    SystemOutput,
)
from sims.controller.cfg import Cfg
from sims.controller.frames import bounded
from sims.rapid.ast import DataDecl, Module
from sims.rapid.builtin import TaskKind
from sims.rapid.errors import Diagnostic, RapidLoadError, Severity
from sims.rapid.host import SignalKind
from sims.rapid.parser import parse_file

__all__ = ["Setup", "TaskSetup", "arm_of", "cell_signals", "modules_of"]

STATEMENT_NS = 5_000
EPOCH_S = 1_767_225_600.0
FAMILY = "1200"


@dataclass(frozen=True, eq=False)
class TaskSetup:
    """A task and the modules that are loaded into it."""

    name: str
    modules: Sequence[Module]
    kind: TaskKind = TaskKind.NORMAL
    has_motion: bool = True
    entry: str = "main"


@dataclass(frozen=True, eq=False)
class Setup:
    """Everything that the controller's configuration says.

    ``overrides`` replace the values of constants and persistents by name, as RAPID text.
    ``home`` is the folder behind ``HOME:``; None: no disk. ``arm`` has the joint bounds; None:
    the world's. ``info`` answers GetSysInfo, by lower-case switch.
    """

    tasks: Sequence[TaskSetup]
    signals: Sequence[SignalConfig] = ()
    crosses: Sequence[CrossConnection] = ()
    system_inputs: Sequence[SystemInput] = ()
    system_outputs: Sequence[SystemOutput] = ()
    event_routines: Sequence[EventRoutine] = ()
    cfgs: Mapping[str, Cfg] = field(default_factory=dict)
    overrides: Mapping[str, str] = field(default_factory=dict)
    info: Mapping[str, str] = field(default_factory=dict)
    arm: ArmModel | None = None
    home: Path | None = None
    epoch_s: float = EPOCH_S
    statement_ns: int = STATEMENT_NS

    @classmethod
    def from_backup(cls, backup: Backup, arm: ArmModel) -> "Setup":
        """The controller that a backup was taken of, with ``arm_of`` for its arm; without a disk.

        Raises
        ------
        RapidLoadError
            A module cannot be parsed.
        """
        tasks = [
            TaskSetup(task.name, modules_of(task.modules), task.kind, task.has_motion, task.entry)
            for task in backup.tasks
        ]
        return cls(
            tasks=tasks,
            signals=_with_cell(backup.signals),
            crosses=backup.crosses,
            system_inputs=backup.system_inputs,
            system_outputs=backup.system_outputs,
            event_routines=backup.event_routines,
            cfgs=backup.cfgs,
            info={"systemname": backup.system, "swversion": backup.robotware}
            if backup.robotware
            else {},
            arm=arm,
        )

    @classmethod
    def from_files(cls, files: Iterable[Path], *, name: str = "T_ROB1") -> "Setup":
        """One NORMAL task with motion, and the cell's signals.

        Raises
        ------
        RapidLoadError
            A module cannot be parsed.
        """
        return cls(tasks=[TaskSetup(name, modules_of(files))], signals=cell_signals())

    def overrides_of(self, task: TaskSetup) -> dict[str, str]:
        """The overrides of data that a task declares.

        Raises
        ------
        ConfigError
            No task declares data that is to be overridden.
        """
        known = {name for one in self.tasks for name in _declared(one.modules)}
        for name in self.overrides:
            if name.lower() not in known:
                raise ConfigError(f"no task declares data of this name: {name}", key="override")
        own = set(_declared(task.modules))
        return {name: text for name, text in self.overrides.items() if name.lower() in own}

    def info_of(self, arm: ArmModel) -> dict[str, str]:
        """The answers of GetSysInfo."""
        usual = {
            "serialno": "1200-000001",
            "swversion": "6.15.0000",
            "robottype": arm.model,
            "ctrlid": "binpick",
            "lanip": "192.168.125.1",
            "ctrllang": "en",
            "systemname": "binpick",
        }
        return {**usual, **self.info}

    def changed(self, **changes: object) -> "Setup":
        """The same with other values."""
        return replace(self, **changes)  # type: ignore[arg-type]


def modules_of(files: Iterable[Path]) -> list[Module]:
    """Parse module files.

    Raises
    ------
    RapidLoadError
        With all that is wrong in any of them.
    """
    modules: list[Module] = []
    wrong: list[Diagnostic] = []
    for path in files:
        found, diagnostics = parse_file(path)
        modules += found
        wrong += [d for d in diagnostics if d.severity is Severity.ERROR]
    if wrong:
        raise RapidLoadError(wrong)
    return modules


def _declared(modules: Iterable[Module]) -> Iterator[str]:
    """Names of module data, lower-case, with and without the module's."""
    for module in modules:
        for decl in module.declarations:
            if isinstance(decl, DataDecl):
                yield decl.name.lower()
                yield f"{module.name}:{decl.name}".lower()


def cell_signals() -> tuple[SignalConfig, ...]:
    """The cabinet's own: di1 to di8 and do1 to do8."""
    return tuple(
        SignalConfig(f"{kind.lower()}{k}", kind)
        for kind in (SignalKind.DI, SignalKind.DO)
        for k in range(1, 9)
    )


def _with_cell(signals: Sequence[SignalConfig]) -> tuple[SignalConfig, ...]:
    names = {signal.name.lower() for signal in signals}
    return (*signals, *(s for s in cell_signals() if s.name not in names))


def arm_of(backup: Backup) -> ArmModel:
    """The arm a backup was taken of, with the joint bounds it says.

    Raises
    ------
    ConfigError
        It is of a type that is not known here.
    """
    # Types are written in many ways: IRB 1200-5/0.9, ROB1_1200_0.9_5, 1200_09_5.
    digits = "".join(ch for ch in backup.motion.robot_type if ch.isdigit())
    _, family, variant = digits.partition(FAMILY)
    for name, arm in ARMS.items():
        reach = name.rpartition("-")[2].replace(".", "")
        if not backup.motion.robot_type or (family and reach in variant):
            return _with_bounds(arm, backup)
    raise ConfigError(
        f"the robot type {backup.motion.robot_type!r} is not simulated; choose one of "
        f"{', '.join(ARMS)} by --arm",
        source=str(backup.folder),
    )


def _with_bounds(arm: ArmModel, backup: Backup) -> ArmModel:
    bounds = backup.motion.joint_bounds_rad
    if bounds is None:
        return arm
    return bounded(
        arm, np.array([low for low, _ in bounds]), np.array([high for _, high in bounds])
    )
