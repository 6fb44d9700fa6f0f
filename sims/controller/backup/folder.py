"""The folder of a backup: which files count is said by ``BACKINFO/backinfo.txt``.

``RAPID/TASKn`` may hold more modules than the controller had loaded, even two of one name; those
that backinfo does not list are left out and named. Where it lists none, the folder's count. No
file outside the backup is read.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PureWindowsPath

from hal.errors import ConfigError
from sims.controller.backup.sections import (
    UNDERSTOOD,
    crosses_of,
    event_routines_of,
    motion_of,
    signals_of,
    system_inputs_of,
    system_outputs_of,
)
from sims.controller.backup.values import Backup, BackupTask
from sims.controller.cfg import Cfg, Instance, read_cfg
from sims.rapid.builtin import TaskKind
from sims.rapid.errors import Diagnostic
from sims.rapid.parser import decode

__all__ = ["is_backup", "read_backup"]

_SUFFIXES = (".mod", ".sys", ".modx", ".sysx")
_FOLDERS = ("PROGMOD", "SYSMOD")
_SECTION = re.compile(r">>\s*(\w+)\s*:\s*(.*)")
_MAX_BACKINFO_BYTES = 1_000_000


@dataclass(slots=True)
class _Info:
    """``tasks``: number to (name, listed modules relative to ``RAPID/TASKn``)."""

    texts: dict[str, str] = field(default_factory=dict)
    tasks: dict[int, tuple[str, list[str]]] = field(default_factory=dict)


def is_backup(folder: Path | str) -> bool:
    """Tell a backup from another folder with modules in it."""
    root = Path(folder)
    return any(_within(root, part) is not None for part in ("BACKINFO", "SYSPAR"))


def read_backup(folder: Path | str) -> Backup:
    """Read a backup. Raises ``ConfigError`` when the folder is none.

    What is wrong or not understood in it is in ``rest`` and ``diagnostics``.
    """
    root = Path(folder)
    if not root.is_dir() or not is_backup(root):
        raise ConfigError(
            f"{root} is no backup: neither BACKINFO nor SYSPAR is in it; name the folder that "
            "the controller wrote"
        )
    rest: list[str] = []
    diagnostics: list[Diagnostic] = []
    cfgs = _configurations(root, rest, diagnostics)
    info = _backinfo(root)
    sys, eio, moc = (cfgs.get(name, Cfg("", name)) for name in ("SYS", "EIO", "MOC"))
    return Backup(
        folder=root,
        system=info.texts.get("SYSTEM_ID", ""),
        robotware=info.texts.get("PRODUCTS_ID", ""),
        home=_within(root, "HOME"),
        tasks=_tasks(root, sys, info, rest),
        signals=signals_of(eio, rest),
        crosses=crosses_of(eio),
        system_inputs=system_inputs_of(eio),
        system_outputs=system_outputs_of(eio),
        event_routines=event_routines_of(sys, rest),
        motion=motion_of(moc),
        cfgs=cfgs,
        rest=tuple(rest),
        diagnostics=tuple(diagnostics),
    )


def _configurations(
    root: Path, rest: list[str], diagnostics: list[Diagnostic]
) -> Mapping[str, Cfg]:
    found: dict[str, Cfg] = {}
    folder = _within(root, "SYSPAR")
    for path in sorted(folder.iterdir()) if folder else ():
        if path.suffix.lower() != ".cfg" or not path.is_file():
            continue
        cfg, wrong = read_cfg(path)
        diagnostics.extend(wrong)
        if not cfg.domain:
            continue
        found[cfg.domain] = cfg
        known = UNDERSTOOD.get(cfg.domain, set())
        rest.extend(
            f"{cfg.domain}: {name} ({len(items)})"
            for name, items in cfg.sections.items()
            if name not in known
        )
    return found


def _backinfo(root: Path) -> _Info:
    info = _Info()
    path = _within(root, "BACKINFO", "backinfo.txt")
    if path is None or path.stat().st_size > _MAX_BACKINFO_BYTES:
        return info
    key = ""
    modules: list[str] | None = None
    for line in (decode(path.read_bytes()) or "").splitlines():
        if head := _SECTION.match(line.strip()):
            key, modules = head[1].upper(), None
            if number := re.fullmatch(r"TASK([0-9]{1,4})", key):
                name = head[2].strip().strip("()").split(",")[0].strip()
                modules = []
                info.tasks[int(number[1])] = (name, modules)
        elif modules is not None and line.strip():
            modules.append(line.partition("@")[0].strip())
        elif key and line.strip():
            info.texts.setdefault(key, line.strip())
    return info


def _tasks(root: Path, sys: Cfg, info: _Info, rest: list[str]) -> tuple[BackupTask, ...]:
    numbers = {name.lower(): number for number, (name, _) in info.tasks.items()}
    found: list[BackupTask] = []
    for item in sys.section("CAB_TASKS"):
        number = numbers.pop(item.name.lower(), 0)
        modules = _modules(root, number, info, rest)
        modules += _automatic(root, sys, item.name, modules, rest)
        found.append(_task(item, number, modules))
    if not found:
        for number, (name, _) in info.tasks.items():
            modules = _modules(root, number, info, rest)
            found.append(BackupTask(name, TaskKind.NORMAL, True, modules=modules, number=number))
    else:
        rest.extend(
            f"RAPID/TASK{number}: task {info.tasks[number][0]} is not in SYS.cfg"
            for number in numbers.values()
        )
    return tuple(found)


def _task(item: Instance, number: int, modules: tuple[Path, ...]) -> BackupTask:
    has_motion = item.flag("MotionTask")
    kind = re.sub(r"[\s_]", "", item.text("Type")).upper()
    if kind not in TaskKind.__members__:
        kind = "NORMAL" if has_motion else "SEMISTATIC"
    return BackupTask(
        item.name,
        TaskKind(kind),
        has_motion,
        item.text("Entry", "main"),
        modules,
        item.text("TrustLevel", "SysFail"),
        number,
    )


def _modules(root: Path, number: int, info: _Info, rest: list[str]) -> tuple[Path, ...]:
    if not number:
        return ()
    there: list[Path] = []
    for name in _FOLDERS:
        folder = _within(root, "RAPID", f"TASK{number}", name)
        there += sorted(p for p in folder.iterdir() if _is_module(p)) if folder else []
    found: list[Path] = []
    listed_folders: set[str] = set()
    for listed in info.tasks[number][1]:
        parts = [part for part in re.split(r"[/\\]", listed) if part]
        path = _within(root, "RAPID", f"TASK{number}", *parts)
        listed_folders.add(parts[0].upper() if parts else "")
        if path is None or not path.is_file():
            rest.append(f"RAPID/TASK{number}/{listed}: listed in backinfo.txt and not there")
        elif path not in found:
            found.append(path)
    for path in there:
        if path.parent.name.upper() not in listed_folders:
            found.append(path)
        elif path not in found:
            rest.append(f"{path.relative_to(root)}: not loaded, backinfo.txt does not list it")
    return tuple(found)


def _automatic(
    root: Path, sys: Cfg, task: str, present: tuple[Path, ...], rest: list[str]
) -> tuple[Path, ...]:
    """Modules that SYS.cfg loads at start and that are in the backup's HOME."""
    names = {path.name.lower() for path in present}
    found: list[Path] = []
    for item in sys.section("CAB_TASK_MODULES"):
        meant = item.text("Task").lower()
        name = PureWindowsPath(item.text("File").replace(":", "/", 1)).as_posix()
        parts = [part for part in name.split("/") if part]
        if not parts or (meant != task.lower() and not item.flag("AllTask")):
            continue
        if parts[-1].lower() in names:
            continue
        path = _within(root, *parts)
        if path is None or not path.is_file():
            rest.append(f"CAB_TASK_MODULES {item.text('File')!r}: not in the backup")
        else:
            found.append(path)
    return tuple(found)


def _is_module(path: Path) -> bool:
    return path.suffix.lower() in _SUFFIXES and path.is_file()


def _within(root: Path, *parts: str) -> Path | None:
    """Follow names whatever their case; None when one is missing or leads outside."""
    path = root
    for part in parts:
        low = part.lower()
        if part == ".." or not path.is_dir():
            return None
        match = next((child for child in path.iterdir() if child.name.lower() == low), None)
        if match is None:
            return None
        path = match
    return path if path.resolve().is_relative_to(root.resolve()) else None
