"""What is done: each statement stands for one position of the program pointer."""

from dataclasses import dataclass

from sims.rapid.ast.expressions import Argument, Expr, Place

__all__ = [
    "Assign",
    "Connect",
    "Exit",
    "For",
    "Goto",
    "If",
    "Label",
    "LateCall",
    "Placeholder",
    "ProcCall",
    "Raise",
    "Retry",
    "Return",
    "Statement",
    "Test",
    "TryNext",
    "While",
]


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
