"""What RAPID source says, as values: the tree that the parser builds and all else reads.

Names keep the spelling of the source; compare them with ``.lower()``. Every node says where it
stands. Nodes are frozen and compare by value.
"""

from dataclasses import dataclass, field
from enum import StrEnum

__all__ = [
    "Aggregate",
    "AliasDecl",
    "Argument",
    "Assign",
    "Binary",
    "BoolLiteral",
    "Call",
    "Connect",
    "DataDecl",
    "DataKind",
    "Declaration",
    "Exit",
    "Expr",
    "Field",
    "For",
    "Goto",
    "Handler",
    "If",
    "Index",
    "Label",
    "LateCall",
    "Mode",
    "Module",
    "Name",
    "Number",
    "Param",
    "Place",
    "Placeholder",
    "ProcCall",
    "Raise",
    "RecordDecl",
    "Retry",
    "Return",
    "RoutineDecl",
    "RoutineKind",
    "Scope",
    "Statement",
    "StringLiteral",
    "Test",
    "TryNext",
    "Unary",
    "While",
]


@dataclass(frozen=True, slots=True)
class Place:
    """A point in a source: ``line`` and ``column`` count from 1."""

    source: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.source}:{self.line}:{self.column}"


# Expressions.


@dataclass(frozen=True, slots=True)
class Number:
    """``.5``, ``1E3``; a literal without sign. ``text`` is as written."""

    at: Place
    value: float
    text: str


@dataclass(frozen=True, slots=True)
class StringLiteral:
    r"""Doubled quotes and ``\HH`` are resolved; characters are Latin-1."""

    at: Place
    value: str


@dataclass(frozen=True, slots=True)
class BoolLiteral:
    """``TRUE`` or ``FALSE``."""

    at: Place
    value: bool


@dataclass(frozen=True, slots=True)
class Name:
    """Data, or a signal."""

    at: Place
    name: str


@dataclass(frozen=True, slots=True)
class Aggregate:
    """``[a, b, [c, d]]``."""

    at: Place
    items: "tuple[Expr, ...]"


@dataclass(frozen=True, slots=True)
class Field:
    """``base.name``."""

    at: Place
    base: "Expr"
    name: str


@dataclass(frozen=True, slots=True)
class Index:
    """``base{i, j}``; an index of None is ``*``."""

    at: Place
    base: "Expr"
    indices: "tuple[Expr | None, ...]"


@dataclass(frozen=True, slots=True)
class Unary:
    """``op``: ``-``, ``+`` or ``NOT``."""

    at: Place
    op: str
    operand: "Expr"


@dataclass(frozen=True, slots=True)
class Binary:
    """``op``: ``+ - * / = <> < <= > >=`` or upper-case ``AND OR XOR DIV MOD``."""

    at: Place
    op: str
    left: "Expr"
    right: "Expr"


@dataclass(frozen=True, slots=True)
class Argument:
    r"""``value``, ``\name``, ``\name:=value`` or ``\name?condition``.

    ``name`` is None for a required argument. ``condition`` names the caller's own optional
    parameter: the argument is given if that one is present, with its value. A required argument
    may be named too (``name:=value``): then ``is_optional`` is False.
    """

    at: Place
    name: "str | None"
    value: "Expr | None"
    is_optional: bool = False
    condition: "Name | None" = None


@dataclass(frozen=True, slots=True)
class Call:
    """A function call in an expression."""

    at: Place
    name: str
    arguments: tuple[Argument, ...]


Expr = (
    Number | StringLiteral | BoolLiteral | Name | Aggregate | Field | Index | Unary | Binary | Call
)


# Statements. Each stands for one program-pointer position.


@dataclass(frozen=True, slots=True)
class Assign:
    """``target := value;``."""

    at: Place
    target: Expr
    value: Expr


@dataclass(frozen=True, slots=True)
class ProcCall:
    """An instruction or procedure call."""

    at: Place
    name: str
    arguments: tuple[Argument, ...]


@dataclass(frozen=True, slots=True)
class LateCall:
    """``%expr% args;``."""

    at: Place
    name: Expr
    arguments: tuple[Argument, ...]


@dataclass(frozen=True, slots=True)
class If:
    """``branches`` are (condition, body); the compact form is an ``If`` with one branch."""

    at: Place
    branches: "tuple[tuple[Expr, tuple[Statement, ...]], ...]"
    otherwise: "tuple[Statement, ...]" = ()


@dataclass(frozen=True, slots=True)
class For:
    """``FOR variable FROM first TO last STEP step DO``."""

    at: Place
    variable: str
    first: Expr
    last: Expr
    step: Expr | None
    body: "tuple[Statement, ...]"


@dataclass(frozen=True, slots=True)
class While:
    """``WHILE condition DO``."""

    at: Place
    condition: Expr
    body: "tuple[Statement, ...]"


@dataclass(frozen=True, slots=True)
class Test:
    """``TEST subject``; each case is (values, body); ``default`` is None where there is none."""

    at: Place
    subject: Expr
    cases: "tuple[tuple[tuple[Expr, ...], tuple[Statement, ...]], ...]"
    default: "tuple[Statement, ...] | None" = None


@dataclass(frozen=True, slots=True)
class Goto:
    """``GOTO label;``."""

    at: Place
    label: str


@dataclass(frozen=True, slots=True)
class Label:
    """``label:``."""

    at: Place
    name: str


@dataclass(frozen=True, slots=True)
class Return:
    """``RETURN;`` or ``RETURN value;``."""

    at: Place
    value: Expr | None = None


@dataclass(frozen=True, slots=True)
class Raise:
    """``RAISE;`` or ``RAISE number;``."""

    at: Place
    value: Expr | None = None


@dataclass(frozen=True, slots=True)
class Retry:
    """``RETRY;``."""

    at: Place


@dataclass(frozen=True, slots=True)
class TryNext:
    """``TRYNEXT;``."""

    at: Place


@dataclass(frozen=True, slots=True)
class Exit:
    """``EXIT;``."""

    at: Place


@dataclass(frozen=True, slots=True)
class Connect:
    """``CONNECT target WITH trap;``."""

    at: Place
    target: Expr
    trap: str


@dataclass(frozen=True, slots=True)
class Placeholder:
    """``<SMT>`` and its like, left by an editor; running into one is an error."""

    at: Place
    text: str


Statement = (
    Assign
    | ProcCall
    | LateCall
    | If
    | For
    | While
    | Test
    | Goto
    | Label
    | Return
    | Raise
    | Retry
    | TryNext
    | Exit
    | Connect
    | Placeholder
)


# Declarations.


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
