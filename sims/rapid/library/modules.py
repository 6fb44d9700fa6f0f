"""Modules that a program loads while it runs: Load, UnLoad, StartLoad, WaitLoad."""

from sims.rapid.builtin import Ref, TaskContext, builtin, opaque
from sims.rapid.disk import locate
from sims.rapid.errors import RapidError, Severity
from sims.rapid.host import EventKind
from sims.rapid.parser import parse_file
from sims.rapid.task import task_of

MAX_LOADED = 64
PROGRAM_DOMAIN = 4

opaque("loadsession")


class Loaded:
    """Which modules came from which file."""

    def __init__(self) -> None:
        self.by_path: dict[str, list[str]] = {}


def _load(task: TaskContext, path: str, file: str | None) -> None:
    program = task_of(task).program
    place = locate(task.host, path) if file is None else locate(task.host, path, file)
    if not place.is_file():
        raise RapidError("ERR_FILNOTFND", f"there is no file {place.name}")
    loaded = task_of(task).common_service(Loaded).by_path
    key = f"{task.name}:{place}"
    if key in loaded:
        raise RapidError("ERR_LOADED", f"{place.name} is loaded already")
    if len(loaded) >= MAX_LOADED:
        raise RapidError("ERR_PRGMEMFULL", f"{MAX_LOADED} modules are loaded: UnLoad some")
    trees, problems = parse_file(place)
    names = [tree.name for tree in trees]
    if any(name.lower() in program.modules for name in names):
        raise RapidError("ERR_LOADED", f"a module of {place.name} is loaded already")
    wrong = [one for one in problems if one.severity is Severity.ERROR]
    if not wrong:
        wrong = [one for one in program.add(trees) if one.severity is Severity.ERROR]
    if wrong:
        for name in names:
            program.remove(name)
        cause = [str(one)[:200] for one in wrong[:5]]
        task.host.log.write(
            EventKind.ERROR, PROGRAM_DOMAIN, 40_030, f"{place.name} cannot be loaded", cause
        )
        raise RapidError("ERR_SYNTAX", str(wrong[0]))
    loaded[key] = names


def _unload(task: TaskContext, path: str, file: str | None) -> None:
    program = task_of(task).program
    place = locate(task.host, path) if file is None else locate(task.host, path, file)
    names = task_of(task).common_service(Loaded).by_path.pop(f"{task.name}:{place}", None)
    if names is None:
        raise RapidError("ERR_UNLOAD", f"{place.name} was not loaded by Load")
    busy = {frame.routine.module.name for frame in task_of(task).machine.frames}
    if busy & set(names):
        raise RapidError("ERR_UNLOAD", f"{place.name} is being executed")
    for name in names:
        program.remove(name)


@builtin("PROC Load(\\switch Dynamic, string FilePath \\string File \\switch CheckRef)")
def load(
    task: TaskContext, *, dynamic: bool, filepath: str, file: str | None, checkref: bool
) -> None:
    """Load a file below HOME. ERR_FILNOTFND, ERR_LOADED, ERR_SYNTAX, ERR_PRGMEMFULL."""
    del dynamic, checkref
    _load(task, filepath, file)


@builtin("PROC UnLoad(\\switch ErrIfChanged | switch Save, string FilePath \\string File)")
def unload(
    task: TaskContext, *, errifchanged: bool, save: bool, filepath: str, file: str | None
) -> None:
    """Forget what was loaded. ERR_UNLOAD."""
    del errifchanged, save
    _unload(task, filepath, file)


@builtin("PROC StartLoad(\\switch Dynamic, string FilePath \\string File, VAR loadsession LoadNo)")
def start_load(
    task: TaskContext, *, dynamic: bool, filepath: str, file: str | None, loadno: Ref
) -> None:
    """Begin to load; WaitLoad ends it. ERR_FILNOTFND."""
    del dynamic
    place = locate(task.host, filepath) if file is None else locate(task.host, filepath, file)
    if not place.is_file():
        raise RapidError("ERR_FILNOTFND", f"there is no file {place.name}")
    loadno.set((filepath, file))


@builtin(
    "PROC WaitLoad(\\string UnloadPath \\string UnloadFile, VAR loadsession LoadNo "
    "\\switch CheckRef)"
)
def wait_load(
    task: TaskContext,
    *,
    unloadpath: str | None,
    unloadfile: str | None,
    loadno: Ref,
    checkref: bool,
) -> None:
    """Load what StartLoad began, and forget another file first."""
    del checkref
    session: tuple[str, str | None] | None = loadno.get()
    if session is None:
        raise RapidError("ERR_LOADNO_NOUSE", "StartLoad has not begun to load")
    if unloadpath is not None:
        _unload(task, unloadpath, unloadfile)
    loadno.set(None)
    _load(task, *session)


@builtin("PROC CancelLoad(VAR loadsession LoadNo)")
def cancel_load(task: TaskContext, *, loadno: Ref) -> None:
    """Do not load what StartLoad began."""
    del task
    loadno.set(None)


@builtin("PROC EraseModule(string ModuleName)")
def erase_module(task: TaskContext, *, modulename: str) -> None:
    """Forget a module. ERR_MODULE."""
    busy = {frame.routine.module.name.lower() for frame in task_of(task).machine.frames}
    if modulename.lower() in busy or not task_of(task).program.remove(modulename):
        raise RapidError("ERR_MODULE", f"{modulename} is not loaded, or is being executed")


@builtin("FUNC num ModTime(string Object)")
@builtin("FUNC dnum ModTimeDnum(string Object)")
def mod_time(task: TaskContext, *, object_: str) -> float:
    """When the file of a module was changed; seconds since it was loaded are not known."""
    if object_.lower() not in task_of(task).program.modules:
        raise RapidError("ERR_MOD_NOTLOADED", f"{object_} is not loaded")
    return 0.0


@builtin("FUNC bool ModExist(string ModuleName)")
def mod_exist(task: TaskContext, *, modulename: str) -> bool:
    """Whether a module is loaded."""
    return modulename.lower() in task_of(task).program.modules
