"""The names of one task's program: modules, data, routines, and what a name means where."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum, auto
from functools import cache
from keyword import iskeyword
from typing import TYPE_CHECKING, Any

from sims.rapid.ast import (
    AliasDecl,
    DataDecl,
    DataKind,
    Mode,
    Module,
    Param,
    Place,
    RecordDecl,
    RoutineDecl,
    RoutineKind,
    Scope,
)
from sims.rapid.builtin import BUILTINS, Builtin
from sims.rapid.data import Cell, Constant, Pers
from sims.rapid.errors import Diagnostic
from sims.rapid.host import Signal
from sims.rapid.parser import parse_routine_head
from sims.rapid.types import ANY, Shape, Type, TypeTable
from sims.rapid.values import copy, default

if TYPE_CHECKING:
    from sims.rapid.program import Program

__all__ = [
    "BuiltinRoutine",
    "Datum",
    "LinkError",
    "MissingError",
    "ModuleScope",
    "ParamInfo",
    "Routine",
    "builtin_routines",
]

MAX_ELEMENTS = 1_000_000


class LinkError(Exception):
    """The program cannot be linked; ``diagnostic`` says why and where."""

    def __init__(self, at: Place, message: str) -> None:
        super().__init__(message)
        self.diagnostic = Diagnostic(at, message)


class MissingError(LinkError):
    """A routine is not there; it may be loaded later, so reaching the call is the error."""


@dataclass(frozen=True, slots=True)
class ParamInfo:
    """A parameter, its type found. ``keyword`` is the Python name in a built-in."""

    name: str
    shape: Shape
    mode: Mode
    is_optional: bool
    is_switch: bool
    group: int = 0
    keyword: str = ""


@dataclass(slots=True)
class Routine:
    """A routine of the program. ``code`` is made at the first call."""

    decl: RoutineDecl
    module: ModuleScope
    params: tuple[ParamInfo, ...]
    result: Shape | None
    code: Any = None

    @property
    def name(self) -> str:
        """As declared."""
        return self.decl.name


@dataclass(frozen=True, slots=True)
class BuiltinRoutine:
    """An instruction or function in Python."""

    decl: RoutineDecl
    params: tuple[ParamInfo, ...]
    result: Shape | None
    builtin: Builtin
    is_async: bool

    @property
    def name(self) -> str:
        """As declared."""
        return self.decl.name


class _State(Enum):
    NEW = auto()
    BUSY = auto()
    READY = auto()


class Datum:
    """Data of a module. The cell is made when it is first asked for, so order is no matter."""

    __slots__ = ("_cell", "_state", "decl", "initial", "module", "shape_known")

    def __init__(self, decl: DataDecl, module: ModuleScope) -> None:
        self.decl = decl
        self.module = module
        self.initial: Any = None
        self.shape_known: Shape | None = None
        self._cell: Cell | None = None
        self._state = _State.NEW

    @property
    def shape(self) -> Shape:
        """Type and dimensions. Raises ``LinkError``."""
        if self.shape_known is None:
            self.shape_known = self.module.shape(self.decl.type, self.decl.dims, self.decl.at)
        return self.shape_known

    @property
    def cell(self) -> Cell:
        """Where the value is. Raises ``LinkError``."""
        if self._cell is None:
            if self._state is _State.BUSY:
                raise LinkError(
                    self.decl.at, f"the value of {self.decl.name} depends on itself: give it one"
                )
            self._state = _State.BUSY
            try:
                self._cell = self._make()
            finally:
                self._state = _State.READY if self._cell is not None else _State.NEW
        return self._cell

    def reset(self) -> None:
        """Give a variable its initial value again; others keep theirs."""
        if self._cell is not None and self.decl.kind is DataKind.VAR:
            initial = self.initial
            if initial is None:
                initial = default(self.shape)
            self._cell.value = copy(initial) if type(initial) is list else initial

    def _make(self) -> Cell:
        decl, shape = self.decl, self.shape
        expr = self.module.program.override(decl, self.module.name) or decl.value
        value = None
        if expr is not None:
            value = self.module.program.evaluate(expr, self.module, shape)
        if decl.kind is DataKind.CONST:
            if value is None:
                raise LinkError(decl.at, f"the constant {decl.name} has no value: give it one")
            return Constant(decl.name, shape, value)
        if decl.kind is DataKind.PERS:
            return self._pers(shape, value)
        self.initial = value
        if value is None:
            value = default(shape)
        return Cell(decl.name, shape, copy(value) if type(value) is list else value)

    def _pers(self, shape: Shape, value: Any) -> Cell:
        decl = self.decl
        fresh = Pers(decl.name, shape, default(shape) if value is None else value)
        if decl.scope is not Scope.GLOBAL or self.module.is_predefined:
            return fresh
        return self.module.program.share(fresh, decl.at, has_value=value is not None)


@dataclass(eq=False)
class ModuleScope:
    """The names of one module."""

    tree: Module
    program: Program
    is_predefined: bool = False
    data: dict[str, Datum] = field(default_factory=dict)
    routines: dict[str, Routine] = field(default_factory=dict)
    types: TypeTable = field(init=False)

    def __post_init__(self) -> None:
        self.types = TypeTable(self.program.types)

    @property
    def name(self) -> str:
        """As declared."""
        return self.tree.name

    def find_type(self, name: str, at: Place) -> Type:
        """Return a type by its name here. Raises ``LinkError``."""
        found = self.types.find(name)
        if found is None:
            raise LinkError(at, f"the type {name} is not known: declare it, or load its module")
        return found

    def shape(self, type_name: str, dims: Sequence[Any], at: Place) -> Shape:
        """Return the shape of a declaration. Raises ``LinkError``."""
        kind = self.find_type(type_name, at)
        sizes = tuple(self._dim(dim, at) for dim in dims)
        shape = Shape(kind, sizes, type_name.lower())
        if len(sizes) > 3 or shape.size > MAX_ELEMENTS:
            raise LinkError(
                at, f"an array has at most 3 dimensions and {MAX_ELEMENTS} values: {shape}"
            )
        return shape

    def _dim(self, expr: Any, at: Place) -> int:
        value = self.program.evaluate_number(expr, self)
        if value != int(value) or value < 1:
            raise LinkError(at, f"a dimension is a whole number from 1, not {value:g}")
        return int(value)

    def params(self, params: Sequence[Param]) -> tuple[ParamInfo, ...]:
        """Return the parameters with their types. Raises ``LinkError``."""
        return tuple(_param(param, self.find_type(param.type, param.at)) for param in params)

    def declarations(self) -> Iterator[DataDecl | RecordDecl | AliasDecl | RoutineDecl]:
        """Return what the module declares, in order."""
        return iter(self.tree.declarations)

    def find_data(self, name: str) -> Datum | None:
        """Data by lower-case name: of this module, then of the task."""
        return self.data.get(name) or self.program.data.get(name)

    def find_routine(self, name: str) -> Routine | BuiltinRoutine | None:
        """A routine by lower-case name: of this module, of the task, then built in.

        ``module:routine`` names a module's own, a LOCAL one too.
        """
        where, colon, own = name.partition(":")
        if colon:
            scope = self.program.modules.get(where.strip())
            return scope.routines.get(own.strip()) if scope is not None else None
        return (
            self.routines.get(name)
            or self.program.routines.get(name)
            or self.program.builtins.get(name)
        )

    def find_signal(self, name: str) -> Signal | None:
        """A signal by lower-case name."""
        return self.program.signals.get(name)


def _param(param: Param, kind: Type, keyword: str = "") -> ParamInfo:
    return ParamInfo(
        param.name.lower(),
        Shape(kind, (0,) * param.rank, param.type.lower()),
        param.mode,
        param.is_optional,
        param.type.lower() == "switch",
        param.group,
        keyword,
    )


def builtin_routines(types: TypeTable) -> Mapping[str, BuiltinRoutine]:
    """Return all built-ins by lower-case name; a type that is not known takes any value."""
    found = {}
    for entry in BUILTINS:
        decl = parse_routine_head(entry.declaration)
        keywords = _keywords(entry.call)
        params = tuple(
            _param(
                param,
                types.find(param.type) or ANY,
                _keyword(keywords, param.name.lower(), entry.declaration),
            )
            for param in decl.params
        )
        result = None
        if decl.kind is RoutineKind.FUNC and decl.type is not None:
            result = Shape(types.find(decl.type) or ANY, (), decl.type.lower())
        is_async = inspect.iscoroutinefunction(entry.call)
        found[decl.name.lower()] = BuiltinRoutine(decl, params, result, entry, is_async)
    return found


@cache
def _keywords(call: Callable[..., Any]) -> tuple[frozenset[str], bool]:
    """The names that a function takes, and whether it takes any."""
    parameters = inspect.signature(call).parameters
    takes_any = any(one.kind is inspect.Parameter.VAR_KEYWORD for one in parameters.values())
    return frozenset(parameters), takes_any


def _keyword(names: tuple[frozenset[str], bool], name: str, declaration: str) -> str:
    known, takes_any = names
    if takes_any and name not in known:
        return name + "_" if iskeyword(name) else name
    for candidate in (name, name + "_"):
        if candidate in known:
            return candidate
    raise TypeError(f"no Python parameter for {name} of {declaration}")
