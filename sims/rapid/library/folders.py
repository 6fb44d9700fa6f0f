"""Folders and files as wholes: list, copy, rename, remove."""

import shutil
from collections.abc import Callable
from pathlib import Path

from sims.rapid.builtin import Ref, TaskContext, builtin, opaque
from sims.rapid.disk import Directory, check_room, locate
from sims.rapid.errors import RapidError

__all__: list[str] = []

opaque("dir")


def _do(what: Callable[[], object], name: str) -> None:
    try:
        what()
    except FileExistsError:
        raise RapidError("ERR_FILEEXIST", f"{name} is there already") from None
    except OSError as error:
        raise RapidError("ERR_FILEACC", f"{name}: {error.strerror}") from None


def _below_home(task: TaskContext, name: str) -> Path:
    path = locate(task.host, name)
    if task.host.home is not None and path == task.host.home.resolve():
        raise RapidError("ERR_FILEACC", f"{name} is HOME: itself")
    return path


@builtin("PROC MakeDir(string Path)")
def make_dir(task: TaskContext, *, path: str) -> None:
    """Make a folder."""
    target = _below_home(task, path)
    check_room(target)
    _do(target.mkdir, path)


@builtin("PROC RemoveDir(string Path)")
def remove_dir(task: TaskContext, *, path: str) -> None:
    """Remove an empty folder."""
    _do(_below_home(task, path).rmdir, path)


@builtin("PROC RemoveFile(string Path)")
def remove_file(task: TaskContext, *, path: str) -> None:
    """Remove a file."""
    _do(_below_home(task, path).unlink, path)


@builtin("PROC RenameFile(string OldPath, string NewPath)")
def rename_file(task: TaskContext, *, oldpath: str, newpath: str) -> None:
    """Rename a file. ERR_FILEEXIST: the new name is taken."""
    old, new = _below_home(task, oldpath), _below_home(task, newpath)
    if new.exists():
        raise RapidError("ERR_FILEEXIST", f"{newpath} is there already")
    check_room(new)
    _do(lambda: old.rename(new), oldpath)


@builtin("PROC CopyFile(string OldPath, string NewPath)")
def copy_file(task: TaskContext, *, oldpath: str, newpath: str) -> None:
    """Copy a file. ERR_FILEEXIST: the new name is taken."""
    old, new = _below_home(task, oldpath), _below_home(task, newpath)
    if new.exists():
        raise RapidError("ERR_FILEEXIST", f"{newpath} is there already")
    check_room(new)
    _do(lambda: shutil.copyfile(old, new), oldpath)


@builtin(
    "FUNC bool IsFile(string Path \\switch Directory \\switch Fifo \\switch RegFile "
    "\\switch BlockSpec \\switch CharSpec)"
)
def is_file(
    task: TaskContext,
    *,
    path: str,
    directory: bool = False,
    fifo: bool = False,
    regfile: bool = False,
    blockspec: bool = False,
    charspec: bool = False,
) -> bool:
    """Whether there is a file, or one of the kinds asked for."""
    target = locate(task.host, path)
    if not (directory or fifo or regfile or blockspec or charspec):
        return target.exists()
    return (directory and target.is_dir()) or (regfile and target.is_file())


@builtin("FUNC num FileSize(string Path)")
@builtin("FUNC dnum FileSizeDnum(string Path)")
def file_size(task: TaskContext, *, path: str) -> float:
    """Size in bytes. ERR_FILEACC: there is no such file."""
    try:
        return float(locate(task.host, path).stat().st_size)
    except OSError as error:
        raise RapidError("ERR_FILEACC", f"{path}: {error.strerror}") from None


@builtin(
    "FUNC num FileTime(string Path \\switch ModifyTime | switch AccessTime | switch StatCTime)"
)
@builtin(
    "FUNC dnum FileTimeDnum(string Path \\switch ModifyTime | switch AccessTime | switch StatCTime)"
)
def file_time(
    task: TaskContext,
    *,
    path: str,
    modifytime: bool = False,
    accesstime: bool = False,
    statctime: bool = False,
) -> float:
    """Seconds since 1970 of the last change, or of what is asked for. ERR_FILEACC: no such file."""
    del modifytime
    try:
        status = locate(task.host, path).stat()
    except OSError as error:
        raise RapidError("ERR_FILEACC", f"{path}: {error.strerror}") from None
    return status.st_atime if accesstime else status.st_ctime if statctime else status.st_mtime


@builtin("PROC OpenDir(VAR dir Dev, string Path)")
def open_dir(task: TaskContext, *, dev: Ref, path: str) -> None:
    """List a folder for ReadDir."""
    if isinstance(dev.get(), Directory):
        raise RapidError("ERR_FILEOPEN", f"{dev.name} is open already: CloseDir it first")
    dev.set(Directory(locate(task.host, path)))


@builtin("FUNC bool ReadDir(VAR dir Dev, VAR string FileName)")
def read_dir(task: TaskContext, *, dev: Ref, filename: Ref) -> bool:
    """Return the next name, ``.`` and ``..`` first; FALSE behind the last."""
    del task
    directory = dev.get()
    if not isinstance(directory, Directory):
        raise RapidError("ERR_FILEACC", f"{dev.name} is not open")
    name = directory.next_name()
    if name is None:
        return False
    filename.set(name)
    return True


@builtin("PROC CloseDir(VAR dir Dev)")
def close_dir(task: TaskContext, *, dev: Ref) -> None:
    """Forget the list."""
    del task
    dev.set(None)
