"""Whole modules: one or several in a text, whatever stands around them."""

from sims.rapid.ast import Declaration, Module
from sims.rapid.errors import Diagnostic
from sims.rapid.lexer import tokenize
from sims.rapid.parser.cursor import (
    MAX_DIAGNOSTICS,
    Cursor,
    RapidSyntaxError,
    TooManyDiagnosticsError,
)
from sims.rapid.parser.declarations import DECLARATION_STARTS, declaration

__all__ = ["MAX_CHARS", "modules_of"]

# The largest modules seen hold 2 MB of taught targets.
MAX_CHARS = 8_000_000

_ATTRIBUTES = ("SYSMODULE", "NOSTEPIN", "NOVIEW", "VIEWONLY", "READONLY")
_MODULE_ENDS = frozenset({"ENDMODULE", "MODULE", "end"})
_ROUTINE_LASTS = frozenset({"ENDPROC", "ENDFUNC", "ENDTRAP", "ENDRECORD"})


def modules_of(text: str, source: str) -> tuple[list[Module], list[Diagnostic]]:
    """All modules of a text and all that is wrong with it, in the order of the text."""
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    cursor = Cursor(tokenize(text[:MAX_CHARS], source))
    lines = tuple(text.split("\n"))
    found: list[Module] = []
    try:
        if len(text) > MAX_CHARS:
            cursor.report(cursor.place, f"a module of more than {MAX_CHARS} characters: split it")
        _to_module(cursor, is_first=True)
        while cursor.kind != "end":
            found.append(_module(cursor, lines))
            _to_module(cursor, is_first=False)
    except TooManyDiagnosticsError:
        cursor.diagnostics.append(
            Diagnostic(cursor.place, f"{MAX_DIAGNOSTICS} diagnostics: the rest is not looked at")
        )
    return found, sorted(cursor.diagnostics, key=lambda item: (item.at.line, item.at.column))


def _to_module(cursor: Cursor, *, is_first: bool) -> None:
    """Skip what is around modules: a MODULE counts where it begins a line or follows another."""
    begin = cursor.place
    while cursor.kind != "end":
        is_begin = cursor.kind == "MODULE" and cursor.peek() in ("name", "placeholder")
        if is_begin and (cursor.peek(-1) == "ENDMODULE" or cursor.begins_line):
            break
        cursor.advance()
    if is_first and cursor.kind == "end":
        cursor.report(begin, "no MODULE here: this is not RAPID, or its first line is missing")
    elif is_first and cursor.index:
        cursor.warn(begin, "the text before MODULE is left out")


def _module(cursor: Cursor, lines: tuple[str, ...]) -> Module:
    cursor.advance()
    at = cursor.place
    name = cursor.new_name("the name of the module")
    attributes = _attributes(cursor)
    declarations: list[Declaration] = []
    while cursor.kind not in _MODULE_ENDS:
        cursor.placeholder = None
        begin = cursor.index
        where = cursor.place
        try:
            declared = _declared(cursor)
        except RapidSyntaxError as fault:
            declared = None
            if cursor.placeholder is None:
                cursor.report(fault.at, fault.message)
            _resume(cursor, begin)
        if cursor.placeholder is not None:
            cursor.warn(where, f"a declaration is left unfinished: {cursor.placeholder}")
        elif declared is not None:
            declarations.append(declared)
    if not cursor.accept("ENDMODULE"):
        cursor.report(cursor.place, f"ENDMODULE is missing at the end of MODULE {name}")
    return Module(at, name, attributes, tuple(declarations), lines)


def _attributes(cursor: Cursor) -> frozenset[str]:
    found: set[str] = set()
    try:
        if cursor.accept("("):
            while True:
                if cursor.kind not in _ATTRIBUTES:
                    cursor.refuse(f"expected one of {' '.join(_ATTRIBUTES)}")
                found.add(cursor.kind)
                cursor.advance()
                if not cursor.accept(","):
                    break
            cursor.expect(")", "after the attributes of the module")
    except RapidSyntaxError as fault:
        cursor.report(fault.at, fault.message)
        cursor.skip_to(DECLARATION_STARTS | _MODULE_ENDS | {")"})
        cursor.accept(")")
    return frozenset(found)


def _declared(cursor: Cursor) -> Declaration | None:
    if cursor.kind == "placeholder":
        cursor.name("a declaration")
        cursor.accept(";")
        return None
    if cursor.kind == ";":
        cursor.warn(cursor.place, "a semicolon with nothing before it: remove it")
        cursor.advance()
        return None
    return declaration(cursor)


def _resume(cursor: Cursor, begin: int) -> None:
    """Go on with the next declaration, behind the end of a broken one."""
    cursor.nesting = 0
    cursor.open_ends.clear()
    if cursor.index == begin:
        cursor.advance()
    cursor.skip_to(DECLARATION_STARTS | _MODULE_ENDS | _ROUTINE_LASTS | {";"})
    if cursor.kind == ";" or cursor.kind in _ROUTINE_LASTS:
        cursor.advance()
