"""The controller with our own RAPID package on it, as its configuration files say."""

from collections.abc import Mapping
from pathlib import Path

from drivers.abb import package_files
from drivers.arms import ArmModel
from hal.errors import ConfigError
from sims.controller.backup.sections import (
    crosses_of,
    event_routines_of,
    signals_of,
    system_inputs_of,
    system_outputs_of,
)
from sims.controller.cfg import Cfg, Instance, read_cfg
from sims.controller.setup import Setup, TaskSetup, modules_of
from sims.rapid.builtin import TaskKind

__all__ = ["package_setup"]


def package_setup(
    *, arm: ArmModel | None = None, overrides: Mapping[str, str] | None = None
) -> Setup:
    """Tasks, signals and system outputs of the shipped package.

    Raises
    ------
    ConfigError, RapidLoadError
        The package is damaged.
    """
    files = package_files()
    folder = next(iter(files.values()))[0].parent
    sys, eio = _cfg(folder / "SYS.cfg"), _cfg(folder / "EIO.cfg")
    rest: list[str] = []
    return Setup(
        tasks=[_task(item, files[item.name]) for item in sys.section("CAB_TASKS")],
        signals=signals_of(eio, rest),
        crosses=crosses_of(eio),
        system_inputs=system_inputs_of(eio),
        system_outputs=system_outputs_of(eio),
        event_routines=event_routines_of(sys, rest),
        cfgs={"SYS": sys, "EIO": eio},
        overrides=overrides or {},
        arm=arm,
    )


def _task(item: Instance, files: list[Path]) -> TaskSetup:
    return TaskSetup(
        item.name,
        modules_of(files),
        TaskKind(item.text("Type", "NORMAL").upper()),
        item.flag("MotionTask"),
        item.text("Entry", "main"),
    )


def _cfg(path: Path) -> Cfg:
    cfg, wrong = read_cfg(path)
    if wrong:
        raise ConfigError(str(wrong[0]), source=str(path))
    return cfg
