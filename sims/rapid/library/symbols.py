"""Data by name: GetDataVal and its kin; and what a routine can ask about its own data."""

import re
from collections.abc import Iterator
from typing import Any

from sims.rapid.ast import DataKind
from sims.rapid.builtin import Ref, TaskContext, builtin, opaque
from sims.rapid.data import Cell
from sims.rapid.errors import RapidError
from sims.rapid.symbols import Datum
from sims.rapid.task import task_of
from sims.rapid.types import Kind
from sims.rapid.values import copy

opaque("datapos")


@builtin("FUNC num Dim(REF anytype ArrPar, num DimNo)")
def dim(task: TaskContext, *, arrpar: Ref, dimno: float) -> float:
    """How many elements an array has in a dimension. ERR_ILLDIM."""
    del task
    value = arrpar.get()
    if not 1 <= dimno <= arrpar.rank or dimno != int(dimno):
        raise RapidError("ERR_ILLDIM", f"{arrpar.name} has no dimension {dimno:g}")
    for _ in range(int(dimno) - 1):
        value = value[0]
    return float(len(value))


@builtin("FUNC bool IsPers(REF anytype DatObj)")
def is_pers(task: TaskContext, *, datobj: Ref) -> bool:
    """Whether it is a persistent, or a parameter that stands for one."""
    del task
    return getattr(datobj, "kind", None) is DataKind.PERS


@builtin("FUNC bool IsVar(REF anytype DatObj)")
def is_var(task: TaskContext, *, datobj: Ref) -> bool:
    """Whether it is a variable."""
    del task
    return getattr(datobj, "kind", None) is DataKind.VAR


class Search:
    """What SetDataSearch looks for, and how far GetNextSym has come."""

    def __init__(self) -> None:
        self.found: Iterator[Datum] = iter(())


def _data(
    task: TaskContext,
    *,
    type_name: str = "",
    name: str | None = None,
    module: str | None = None,
    kinds: frozenset[DataKind] = frozenset(DataKind),
) -> Iterator[Datum]:
    """The task's own data that fits; names are regular expressions, as on a controller."""
    wanted = _pattern(name)
    home = _pattern(module)
    for scope in tuple(task_of(task).program.modules.values()):
        if scope.is_predefined or not home.fullmatch(scope.name):
            continue
        for datum in tuple(scope.data.values()):
            is_typed = not type_name or datum.decl.type.lower() == type_name.lower()
            if is_typed and datum.decl.kind in kinds and wanted.fullmatch(datum.decl.name):
                yield datum


def _pattern(text: str | None) -> re.Pattern[str]:
    """Only ``.``, ``*``, ``+``, ``?``, ``^`` and ``$`` are taken; a pattern cannot run away."""
    if text is None or not text:
        return re.compile(".*", re.IGNORECASE)
    kept = re.sub(r"[^\w.*+?$^]", lambda match: re.escape(match[0]), text)
    kept = re.sub(r"([*+?])[*+?]+", r"\1", kept)
    if sum(kept.count(mark) for mark in "*+?") > 4:
        raise RapidError("ERR_ARGVALERR", f"the pattern {text} is too complex")
    try:
        return re.compile(kept, re.IGNORECASE)
    except re.error as error:
        raise RapidError("ERR_ARGVALERR", f"the pattern {text} is wrong: {error}") from error


@builtin(
    "PROC SetDataSearch(string Type \\symnum TypeMod \\string Object \\switch PersSym "
    "\\switch VarSym \\switch ConstSym \\switch InTask | string InMod \\switch GlobalSym "
    "| switch LocalSym)"
)
def set_data_search(task: TaskContext, **arguments: Any) -> None:
    """Look for data of a type; GetNextSym gives what is found, one after the other."""
    chosen = {
        DataKind.PERS: arguments["perssym"],
        DataKind.VAR: arguments["varsym"],
        DataKind.CONST: arguments["constsym"],
    }
    kinds = frozenset(kind for kind, is_on in chosen.items() if is_on) or frozenset(DataKind)
    task_of(task).service(Search).found = _data(
        task,
        type_name=arguments["type"],
        name=arguments["object"],
        module=arguments["inmod"],
        kinds=kinds,
    )


@builtin("FUNC bool GetNextSym(VAR string Object, VAR datapos Block \\switch Recursive)")
def get_next_sym(task: TaskContext, *, object_: Ref, block: Ref, recursive: bool) -> bool:
    """Whether there is another one; its name, and where it is."""
    del recursive
    datum = next(task_of(task).service(Search).found, None)
    if datum is None:
        return False
    object_.set(datum.decl.name)
    block.set(datum)
    return True


def _cell(task: TaskContext, name: str, block: Ref | None) -> Cell:
    datum: Datum | None = block.get() if block is not None else None
    if datum is not None:
        return datum.cell
    cell = task_of(task).program.find_cell(name)
    if cell is None:
        raise RapidError("ERR_SYM_ACCESS", f"there is no data {name}")
    return cell


def _same_type(cell: Cell, value: Ref) -> None:
    if cell.base != value.base or cell.rank != value.rank:
        raise RapidError("ERR_SYMBOL_TYPE", f"{cell.name} is a {cell.shape}, not a {value.type}")


@builtin(
    "PROC GetDataVal(string Object \\VAR datapos Block | VAR taskid TaskRef | string TaskName, "
    "INOUT anytype Value)"
)
def get_data_val(task: TaskContext, **arguments: Any) -> None:
    """Read data by its name. ERR_SYM_ACCESS, ERR_SYMBOL_TYPE, ERR_TASKNAME."""
    cell = _cell(_peer(task, arguments), arguments["object"], arguments["block"])
    _same_type(cell, arguments["value"])
    arguments["value"].set(cell.get())


@builtin(
    "PROC SetDataVal(string Object \\VAR datapos Block | VAR taskid TaskRef | string TaskName, "
    "REF anytype Value)"
)
def set_data_val(task: TaskContext, **arguments: Any) -> None:
    """Write data by its name. ERR_SYM_ACCESS (also: a constant), ERR_SYMBOL_TYPE."""
    cell = _cell(_peer(task, arguments), arguments["object"], arguments["block"])
    _same_type(cell, arguments["value"])
    if cell.kind is DataKind.CONST:
        raise RapidError("ERR_SYM_ACCESS", f"{cell.name} is a constant")
    cell.set(arguments["value"].get())


@builtin(
    "PROC SetAllDataVal(string Type \\symnum TypeMod \\string Object \\switch Hidden, "
    "REF anytype Value)"
)
def set_all_data_val(task: TaskContext, **arguments: Any) -> None:
    """Write all data of a type that is not constant. ERR_SYMBOL_TYPE."""
    value: Ref = arguments["value"]
    kinds = frozenset({DataKind.VAR, DataKind.PERS})
    name = arguments["object"]
    for datum in _data(task, type_name=arguments["type"], name=name, kinds=kinds):
        if datum.shape.dims or datum.shape.type.kind is Kind.OPAQUE:
            continue
        _same_type(datum.cell, value)
        held = value.get()
        datum.cell.set(copy(held) if type(held) is list else held)


def _peer(task: TaskContext, arguments: dict[str, Any]) -> TaskContext:
    reference: Ref | None = arguments["taskref"]
    name = arguments["taskname"] if reference is None else reference.name
    if not name:
        return task
    for other in task_of(task).peers.values():
        if name.lower() in {other.name.lower(), f"{other.name.lower()}id"}:
            return other
    raise RapidError("ERR_TASKNAME", f"there is no task {name}")
