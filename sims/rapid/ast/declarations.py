"""What is declared: modules, data, types, routines."""

from dataclasses import dataclass, field
from enum import StrEnum

from sims.rapid.ast.expressions import Expr, Place
from sims.rapid.ast.statements import Statement

__all__ = [
    "AliasDecl",
    "DataDecl",
    "DataKind",
    "Declaration",
    "Handler",
    "Mode",
    "Module",
    "Param",
    "RecordDecl",
    "RoutineDecl",
    "RoutineKind",
    "Scope",
]


class Scope(StrEnum):
    """Who sees a name."""

    GLOBAL = ""
    LOCAL = "LOCAL"
    TASK = "TASK"


class DataKind(StrEnum):
    """How data is stored."""

    VAR = "VAR"
    PERS = "PERS"
    CONST = "CONST"


class RoutineKind(StrEnum):
    """What a routine is."""

    PROC = "PROC"
    FUNC = "FUNC"
    TRAP = "TRAP"


class Mode(StrEnum):
    """How a parameter is passed. REF is for built-in routines: any data object, as it is."""

    IN = ""
    VAR = "VAR"
    PERS = "PERS"
    INOUT = "INOUT"
    REF = "REF"


@dataclass(frozen=True, slots=True)
class DataDecl:
    """``dims`` are the expressions in ``{}``; empty: a scalar."""

    at: Place
    scope: Scope
    kind: DataKind
    type: str
    name: str
    dims: tuple[Expr, ...] = ()
    value: Expr | None = None


@dataclass(frozen=True, slots=True)
class RecordDecl:
    """``fields`` are (type, name)."""

    at: Place
    scope: Scope
    name: str
    fields: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class AliasDecl:
    """``ALIAS type name;``."""

    at: Place
    scope: Scope
    type: str
    name: str


@dataclass(frozen=True, slots=True)
class Param:
    r"""A parameter. ``type`` is ``switch`` for a switch; ``rank`` counts the ``*`` in ``{*}``.

    Optional parameters that exclude each other (``\a | \b``) share a ``group`` number, which
    no other parameter of the routine has.
    """

    at: Place
    name: str
    type: str
    mode: Mode = Mode.IN
    rank: int = 0
    is_optional: bool = False
    group: int = 0


@dataclass(frozen=True, slots=True)
class Handler:
    """One ``ERROR`` clause. ``numbers`` empty: all errors.

    ``has_long_jump``: the list holds ``LONG_JMP_ALL_ERR`` (which is not among ``numbers``).
    """

    at: Place
    numbers: tuple[Expr, ...]
    body: tuple[Statement, ...]
    has_long_jump: bool = False


@dataclass(frozen=True, slots=True)
class RoutineDecl:
    """A procedure, function or trap. Clauses that are not there are None or empty."""

    at: Place
    scope: Scope
    kind: RoutineKind
    name: str
    type: str | None
    params: tuple[Param, ...]
    data: tuple[DataDecl, ...]
    body: tuple[Statement, ...]
    handlers: tuple[Handler, ...] = ()
    undo: tuple[Statement, ...] | None = None
    backward: tuple[Statement, ...] | None = None
    end: Place | None = field(default=None, compare=False)


Declaration = DataDecl | RecordDecl | AliasDecl | RoutineDecl


@dataclass(frozen=True, slots=True)
class Module:
    """``attributes`` are upper-case: SYSMODULE, NOSTEPIN, NOVIEW, VIEWONLY, READONLY.

    ``lines`` are the source's, for the pendant's view.
    """

    at: Place
    name: str
    attributes: frozenset[str]
    declarations: tuple[Declaration, ...]
    lines: tuple[str, ...] = field(default=(), compare=False, repr=False)
