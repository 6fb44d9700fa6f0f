"""Save: a module as it is now, with the values of its persistents, into a file."""

import re
from itertools import accumulate

from sims.rapid.ast import DataDecl, DataKind
from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.disk import Device, locate
from sims.rapid.errors import RapidError
from sims.rapid.formats import value_text
from sims.rapid.symbols import ModuleScope
from sims.rapid.task import task_of

__all__: list[str] = []

_STEPS = re.compile(r'"[^"\n]*"|![^\n]*|;')


@builtin(
    "PROC Save(\\VAR taskid TaskRef | \\string TaskName, string ModuleName \\string FilePath "
    "\\string File)"
)
def save(
    task: TaskContext,
    *,
    taskref: Ref | None,
    taskname: str | None,
    modulename: str,
    filepath: str | None,
    file: str | None,
) -> None:
    """Write a module of this task into a file below HOME.

    ERR_MODULE: it is not loaded; ERR_PATH: no path was given; ERR_FILEACC.
    """
    if taskref is not None or (taskname is not None and taskname.lower() != task.name.lower()):
        raise RapidError("ERR_TASKNAME", "Save writes modules of its own task here")
    scope = task_of(task).program.modules.get(modulename.lower())
    if scope is None or scope.is_predefined or not scope.tree.lines:
        raise RapidError("ERR_MODULE", f"the module {modulename} is not loaded")
    if filepath is None:
        raise RapidError("ERR_PATH", f"Save {modulename} needs \\FilePath:=")
    device = Device(locate(task.host, filepath, file or ""), "w")
    try:
        device.write(_source(scope).encode("latin-1", "replace"))
    finally:
        device.close()


def _source(scope: ModuleScope) -> str:
    """The module's text, in which persistents begin with the values they have."""
    lines = scope.tree.lines
    starts = list(accumulate((len(line) + 1 for line in lines), initial=0))
    text = "\n".join(lines) + "\n"
    for decl in reversed(scope.tree.declarations):
        if isinstance(decl, DataDecl) and decl.kind is DataKind.PERS and decl.value is not None:
            value = value_text(scope.data[decl.name.lower()].cell.get())
            begin = text.index(":=", starts[decl.at.line - 1] + decl.at.column - 1) + 2
            text = f"{text[:begin]} {value}{text[_semicolon(text, begin) :]}"
    return text


def _semicolon(text: str, begin: int) -> int:
    """Where a declaration ends, outside strings and comments."""
    return next(m.start() for m in _STEPS.finditer(text, begin) if m[0] == ";")
