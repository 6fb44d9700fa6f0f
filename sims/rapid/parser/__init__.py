"""RAPID source to trees: whole modules, the heads of routines, single expressions."""

import re
from functools import lru_cache
from pathlib import Path

from sims.rapid.ast import Expr, Module, Place, RoutineDecl
from sims.rapid.errors import Diagnostic, RapidLoadError, Severity
from sims.rapid.lexer import tokenize
from sims.rapid.parser.cursor import MAX_NESTING, Cursor, RapidSyntaxError, TooManyDiagnosticsError
from sims.rapid.parser.declarations import routine_head
from sims.rapid.parser.expressions import MAX_STRING, expression
from sims.rapid.parser.modules import MAX_CHARS, modules_of

__all__ = [
    "MAX_CHARS",
    "MAX_NESTING",
    "MAX_STRING",
    "decode",
    "parse_expression",
    "parse_file",
    "parse_routine_head",
    "parse_text",
]

_UTF8_BOM = b"\xef\xbb\xbf"
_IDEOGRAPHIC_SPACE = b"\xe3\x80\x80"
_CONTROLS = re.compile(rb"[\x00-\x08\x0e-\x19\x1b-\x1f\x7f]")


def parse_text(text: str, source: str) -> tuple[list[Module], list[Diagnostic]]:
    """Return the modules of a text and all that is wrong with it. Never raises.

    ``source`` is the name that diagnostics and places carry. A module with errors is returned
    as far as it makes sense. Nesting, strings and the number of diagnostics are bounded.
    """
    return modules_of(text, source)


def parse_file(path: Path | str) -> tuple[list[Module], list[Diagnostic]]:
    """Parse a file in Latin-1, or in UTF-8 with a byte order mark; see ``parse_text``.

    A file that cannot be read, or that is no text (an encoded module), is one diagnostic.
    """
    source = str(path)
    try:
        with Path(path).open("rb") as file:
            data = file.read(MAX_CHARS + 1)
    except OSError as error:
        return [], [Diagnostic(Place(source, 1, 1), f"cannot be read: {error.strerror}")]
    text = decode(data)
    if text is None:
        why = (
            "not text but binary: an encoded module; save it as text with its key, or leave it out"
        )
        return [], [Diagnostic(Place(source, 1, 1), why)]
    return modules_of(text, source)


def decode(data: bytes) -> str | None:
    """Text of a source file; None for binary data. Each byte is one character of Latin-1."""
    if data.startswith(_UTF8_BOM):
        return data[len(_UTF8_BOM) :].decode("utf-8", "replace")
    head = data[:65536]
    if b"\0" in head or len(_CONTROLS.findall(head)) * 20 > len(head):
        return None
    return data.replace(_IDEOGRAPHIC_SPACE, b"   ").decode("latin-1")


@lru_cache(maxsize=2048)
def parse_routine_head(text: str) -> RoutineDecl:
    r"""Parse a built-in's declaration: ``PROC MoveL(\switch Conc, robtarget ToPoint)``.

    Raises ``RapidLoadError``. The mode ``REF`` is understood beside ``VAR PERS INOUT``.
    """
    cursor = Cursor(tokenize(text, "<built-in>"))
    try:
        if cursor.kind not in ("PROC", "FUNC", "TRAP"):
            cursor.refuse("expected PROC, FUNC or TRAP")
        found = routine_head(cursor)
        if cursor.kind != "end":
            cursor.refuse("expected nothing more")
    except RapidSyntaxError as fault:
        cursor.diagnostics.append(Diagnostic(fault.at, fault.message))
    if cursor.diagnostics:
        raise RapidLoadError(cursor.diagnostics)
    return found


def parse_expression(text: str, source: str = "<expression>") -> Expr:
    """Parse one expression that is all of ``text``. Raises ``RapidLoadError``."""
    cursor = Cursor(tokenize(text, source))
    try:
        found = expression(cursor)
        if cursor.kind != "end":
            cursor.refuse("expected the end of the expression")
    except RapidSyntaxError as fault:
        raise RapidLoadError([Diagnostic(fault.at, fault.message)]) from None
    except TooManyDiagnosticsError:
        pass
    wrong = [item for item in cursor.diagnostics if item.severity is Severity.ERROR]
    if cursor.placeholder is not None:
        wrong.append(Diagnostic(Place(source, 1, 1), f"unfinished: {cursor.placeholder}"))
    if wrong:
        raise RapidLoadError(wrong)
    return found
