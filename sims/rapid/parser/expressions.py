"""Expressions, data references and argument lists.

Priorities, strongest first: ``* / DIV MOD``; ``+ -``; comparisons; ``AND``; ``OR XOR NOT``. So
``NOT a AND b`` is ``NOT (a AND b)``.
"""

import math
import re

from sims.rapid.ast import (
    Aggregate,
    Argument,
    Binary,
    BoolLiteral,
    Call,
    Expr,
    Field,
    Index,
    Name,
    Number,
    Place,
    StringLiteral,
    Unary,
)
from sims.rapid.parser.cursor import MAX_NESTING, Cursor, RapidSyntaxError

__all__ = ["MAX_STRING", "arguments", "expression", "reference"]

MAX_STRING = 80

_OR, _AND, _COMPARE, _ADD, _MULTIPLY = 1, 2, 3, 4, 5

_LEVELS = {
    "OR": _OR,
    "XOR": _OR,
    "AND": _AND,
    **dict.fromkeys(("=", "<>", "<", "<=", ">", ">="), _COMPARE),
    **dict.fromkeys("+-", _ADD),
    **dict.fromkeys(("*", "/", "DIV", "MOD"), _MULTIPLY),
}

_ESCAPE = re.compile(r"\\([0-9A-Fa-f]{2}|\\)|\"\"")


def expression(cursor: Cursor) -> Expr:
    """One expression; ``cursor.height`` is then that of its tree.

    A fault leaves ``cursor.nesting`` as it was inside: who catches it puts it back.
    """
    if cursor.nesting >= MAX_NESTING:
        raise RapidSyntaxError(cursor.place, _too_deep())
    cursor.nesting += 1
    found = _binary(cursor, _OR)
    cursor.nesting -= 1
    return found


def reference(cursor: Cursor) -> Expr:
    """``name``, ``name{i}.field{j}``: a data object or a part of one."""
    at = cursor.place
    cursor.height = 1
    return _parts(cursor, Name(at, cursor.name("the name of data")))


def arguments(cursor: Cursor, end: str) -> tuple[Argument, ...]:
    r"""Arguments up to ``end``, which stays: required ones after commas, ``\options`` anywhere."""
    found: list[Argument] = []
    height = 0
    while cursor.kind != end:
        if found and cursor.kind != "\\":
            cursor.expect(",", f"or {end!r} after an argument")
        found.append(_option(cursor) if cursor.kind == "\\" else _required(cursor))
        height = max(height, cursor.height)
    cursor.height = height
    return tuple(found)


def _binary(cursor: Cursor, least: int) -> Expr:
    left = _prefixed(cursor, least)
    while (level := _LEVELS.get(cursor.kind, 0)) >= least:
        at, op, height = cursor.place, cursor.kind, cursor.height
        cursor.advance()
        right = _binary(cursor, level + 1)
        _grow(cursor, max(height, cursor.height), at)
        left = Binary(at, op, left, right)
    return left


def _prefixed(cursor: Cursor, least: int) -> Expr:
    kind = cursor.kind
    if kind not in ("NOT", "-", "+"):
        return _primary(cursor)
    at = cursor.place
    if cursor.nesting >= MAX_NESTING:
        raise RapidSyntaxError(at, _too_deep())
    cursor.advance()
    cursor.nesting += 1
    operand = _binary(cursor, max(least, _AND if kind == "NOT" else _MULTIPLY))
    cursor.nesting -= 1
    _grow(cursor, cursor.height, at)
    return Unary(at, kind, operand)


def _primary(cursor: Cursor) -> Expr:
    kind, at = cursor.kind, cursor.place
    cursor.height = 1
    if kind == "name":
        return _named(cursor, at)
    if kind == "number":
        return _number(cursor, at)
    if kind == "string":
        return _string(cursor, at)
    if kind in ("TRUE", "FALSE"):
        cursor.advance()
        return BoolLiteral(at, kind == "TRUE")
    if kind == "[":
        return _aggregate(cursor, at)
    if kind == "placeholder":
        return Name(at, cursor.name("a value"))
    if kind != "(":
        cursor.refuse("expected a value")
    cursor.advance()
    inner = expression(cursor)
    cursor.expect(")", "to close the parenthesis")
    return inner


def _named(cursor: Cursor, at: Place) -> Expr:
    name = cursor.text
    cursor.advance()
    if cursor.kind != "(":
        return _parts(cursor, Name(at, name))
    cursor.advance()
    given = arguments(cursor, ")")
    cursor.advance()
    _grow(cursor, cursor.height, at)
    if cursor.kind == "{":
        raise RapidSyntaxError(
            cursor.place,
            f"the result of {name} has to be stored in data before an element of it can be read",
        )
    call = Call(at, name, given)
    if cursor.kind != ".":
        return call
    cursor.warn(
        cursor.place,
        f"a controller may refuse to take a component of a call: store the result of {name} first",
    )
    return _parts(cursor, call)


def _parts(cursor: Cursor, base: Expr) -> Expr:
    at = base.at
    while True:
        if cursor.accept("."):
            base = Field(at, base, cursor.name("the name of a component after '.'"))
        elif cursor.accept("{"):
            height = cursor.height
            base = Index(at, base, _indices(cursor))
            cursor.height = max(height, cursor.height)
        else:
            return base
        _grow(cursor, cursor.height, at)


def _indices(cursor: Cursor) -> tuple[Expr | None, ...]:
    found: list[Expr | None] = []
    height = 0
    while True:
        if cursor.accept("*"):
            found.append(None)
        else:
            found.append(expression(cursor))
            height = max(height, cursor.height)
        if not cursor.accept(","):
            break
    cursor.expect("}", "to close the index")
    cursor.height = height
    return tuple(found)


def _aggregate(cursor: Cursor, at: Place) -> Expr:
    cursor.advance()
    items: list[Expr] = []
    height = 0
    while True:
        items.append(expression(cursor))
        height = max(height, cursor.height)
        if not cursor.accept(","):
            break
    cursor.expect("]", "to close the aggregate")
    _grow(cursor, height, at)
    return Aggregate(at, tuple(items))


def _option(cursor: Cursor) -> Argument:
    at = cursor.place
    cursor.advance()
    name = cursor.name("the name of an optional argument after '\\'")
    cursor.height = 1
    if cursor.accept(":="):
        return Argument(at, name, expression(cursor), is_optional=True)
    if cursor.accept("?"):
        where = cursor.place
        condition = Name(where, cursor.name("the name of an optional parameter after '?'"))
        return Argument(at, name, None, is_optional=True, condition=condition)
    return Argument(at, name, None, is_optional=True)


def _required(cursor: Cursor) -> Argument:
    at = cursor.place
    if cursor.kind == "name" and cursor.peek() == ":=":
        name = cursor.name("the name of a parameter")
        cursor.advance()
        return Argument(at, name, expression(cursor))
    return Argument(at, None, expression(cursor))


def _number(cursor: Cursor, at: Place) -> Expr:
    text = cursor.text
    try:
        value = float(int(text, 0)) if text[1:2] in "xXoObB" and text[1:] else float(text)
    except OverflowError:
        value = math.inf
    if math.isinf(value):
        raise RapidSyntaxError(at, f"the number {text[:24]} is too large even for a dnum")
    cursor.advance()
    return Number(at, value, text)


def _string(cursor: Cursor, at: Place) -> Expr:
    value = _ESCAPE.sub(_unescaped, cursor.text[1:-1])
    if len(value) > MAX_STRING:
        cursor.report(
            at,
            f"the string has {len(value)} characters and a string holds {MAX_STRING}: shorten it "
            "or split it",
        )
        value = value[:MAX_STRING]
    if not value.isascii() and any(ord(char) > 0xFF for char in value):
        cursor.warn(at, "a controller keeps strings in Latin-1: replace the other characters")
        value = value.encode("latin-1", "replace").decode("latin-1")
    cursor.advance()
    return StringLiteral(at, value)


def _unescaped(match: re.Match[str]) -> str:
    code = match[1]
    if code is None:
        return '"'
    return "\\" if code == "\\" else chr(int(code, 16))


def _grow(cursor: Cursor, height: int, at: Place) -> None:
    cursor.height = height + 1
    if height >= MAX_NESTING:
        raise RapidSyntaxError(at, _too_deep())


def _too_deep() -> str:
    return f"nested deeper than {MAX_NESTING}: split it with data of its own"
