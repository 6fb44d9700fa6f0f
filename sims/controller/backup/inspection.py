"""RAPID files, folders and backups, checked without a controller."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from hal.errors import ConfigError
from sims.controller import instructions
from sims.controller.backup.folder import is_backup, read_backup
from sims.controller.backup.sections import signals_of
from sims.controller.backup.values import Backup
from sims.controller.cfg import read_cfg
from sims.rapid import library
from sims.rapid.ast import Module
from sims.rapid.builtin import TaskKind
from sims.rapid.check import check
from sims.rapid.errors import Diagnostic, Severity
from sims.rapid.parser import parse_file

__all__ = ["Inspection", "inspect"]

_SUFFIXES = (".mod", ".sys", ".modx", ".sysx")
_MAX_FILES = 5000


@dataclass(slots=True)
class Inspection:
    """What was looked at and what is wrong with it, file by file."""

    files: int = 0
    modules: int = 0
    lines: int = 0
    diagnostics: list[Diagnostic] = field(default_factory=list)
    rest: list[str] = field(default_factory=list)

    @property
    def errors(self) -> int:
        """How many of the diagnostics are errors."""
        return sum(item.severity is Severity.ERROR for item in self.diagnostics)

    @property
    def warnings(self) -> int:
        """How many are not."""
        return len(self.diagnostics) - self.errors


def inspect(
    paths: Sequence[Path], *, kind: TaskKind = TaskKind.NORMAL, has_motion: bool = True
) -> Inspection:
    """Check files, all modules of a folder, or the tasks of a backup folder.

    ``kind`` and ``has_motion`` are of the task in which modules outside a backup would run.

    Raises
    ------
    ConfigError
        A path that is not there, or a folder without RAPID.
    """
    library.register()
    instructions.register()
    found = Inspection()
    loose: list[Path] = []
    searched: set[Path] = set()
    for path in paths:
        if path.is_dir() and is_backup(path):
            _inspect_backup(read_backup(path), found)
        elif path.is_dir():
            inside = _modules_in(path)
            searched.update(inside)
            loose += inside
        elif path.exists():
            loose.append(path)
        else:
            raise ConfigError("is not there", source=str(path))
    modules = _parse(dict.fromkeys(loose), searched, found)
    if found.errors == 0:
        signals = _signals_beside(paths)
        found.diagnostics += check(
            modules, kind=kind, has_motion=has_motion, signals=signals, same_task=False
        )
    found.diagnostics = _each_once(found.diagnostics)
    return found


def _signals_beside(paths: Sequence[Path]) -> list[str] | None:
    """Names of signals by the EIO.cfg files in the folders; None where there is none."""
    names: list[str] = []
    files = [file for path in paths if path.is_dir() for file in sorted(path.rglob("EIO.cfg"))]
    for file in files:
        cfg, _ = read_cfg(file)
        names += [signal.name for signal in signals_of(cfg, [])]
    return names or None


def _each_once(diagnostics: Sequence[Diagnostic]) -> list[Diagnostic]:
    """The same warning at many places of a file is one, at the first, with the count."""
    groups: dict[tuple[str, str, Severity], list[Diagnostic]] = {}
    for item in dict.fromkeys(diagnostics):
        groups.setdefault((item.at.source, item.message, item.severity), []).append(item)
    found: list[Diagnostic] = []
    for (_, message, severity), items in groups.items():
        if severity is Severity.ERROR or len(items) == 1:
            found += items
        else:
            found.append(replace(items[0], message=f"{message} ({len(items)} places)"))
    return found


def _modules_in(folder: Path) -> list[Path]:
    inside = [p for p in folder.rglob("*") if p.suffix.lower() in _SUFFIXES and p.is_file()]
    if not inside:
        raise ConfigError(f"no {' '.join(_SUFFIXES)} file in it", source=str(folder))
    if len(inside) > _MAX_FILES:
        raise ConfigError(f"{len(inside)} modules; {_MAX_FILES} are possible", source=str(folder))
    return sorted(inside)


def _parse(paths: "dict[Path, None]", searched: set[Path], into: Inspection) -> list[Module]:
    """Parse files; one of another language that a search found is only a warning."""
    found: list[Module] = []
    for path in paths:
        modules, wrong = parse_file(path)
        if not modules and path in searched:
            wrong = [replace(item, severity=Severity.WARNING) for item in wrong]
        into.files += 1
        into.modules += len(modules)
        into.lines += max((len(module.lines) for module in modules), default=0)
        into.diagnostics += wrong
        found += modules
    return found


def _inspect_backup(backup: Backup, into: Inspection) -> None:
    into.rest += backup.rest
    into.diagnostics += backup.diagnostics
    before = into.errors
    tasks = {
        task.name: (task, _parse(dict.fromkeys(task.modules), set(), into)) for task in backup.tasks
    }
    if into.errors > before:
        return
    for name, (task, modules) in tasks.items():
        others = {other: theirs for other, (_, theirs) in tasks.items() if other != name}
        into.diagnostics += check(
            modules,
            kind=task.kind,
            has_motion=task.has_motion,
            signals=_signals(backup),
            others=others,
            extra=["ROB_1", f"{name}Id", *(f"{other}Id" for other in others)],
        )


def _signals(backup: Backup) -> list[str] | None:
    """Return all names of signals; None where modules that may declare a name are missing."""
    is_partial = any("not there" in item or "not in the backup" in item for item in backup.rest)
    if "EIO" not in backup.cfgs or is_partial:
        return None
    return [signal.name for signal in backup.signals]
