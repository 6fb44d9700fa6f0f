"""Places in a source, and what has a value."""

from dataclasses import dataclass

__all__ = [
    "Aggregate",
    "Argument",
    "Binary",
    "BoolLiteral",
    "Call",
    "Expr",
    "Field",
    "Index",
    "Name",
    "Number",
    "Place",
    "StringLiteral",
    "Unary",
]


@dataclass(frozen=True, slots=True)
class Place:
    """A point in a source: ``line`` and ``column`` count from 1."""

    source: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.source}:{self.line}:{self.column}"


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
