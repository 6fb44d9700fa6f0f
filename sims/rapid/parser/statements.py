"""Statements, and how the parser goes on after a wrong one.

A fault inside a statement is noted and the parser continues behind its semicolon or at the next
word that can only begin or end something. A block that is not closed is noted once, where the
word of an outer block or the end of the routine is met.
"""

from collections.abc import Callable

from sims.rapid.ast import (
    Argument,
    Assign,
    Connect,
    Exit,
    Expr,
    For,
    Goto,
    If,
    Label,
    LateCall,
    Name,
    Place,
    Placeholder,
    ProcCall,
    Raise,
    Retry,
    Return,
    Statement,
    Test,
    TryNext,
    While,
)
from sims.rapid.parser.cursor import MAX_NESTING, Cursor, RapidSyntaxError
from sims.rapid.parser.expressions import arguments, expression, reference

__all__ = ["ROUTINE_ENDS", "block"]

_CLAUSES = frozenset({"ERROR", "UNDO", "BACKWARD"})

# A routine's statements end here whatever is still open.
ROUTINE_ENDS = _CLAUSES | {"ENDPROC", "ENDFUNC", "ENDTRAP", "ENDMODULE", "PROC", "FUNC", "TRAP"}
ROUTINE_ENDS |= {"RECORD", "ENDRECORD", "ALIAS", "LOCAL", "TASK", "MODULE", "end"}

_BLOCK_WORDS = frozenset({"ENDIF", "ELSE", "ELSEIF", "ENDFOR", "ENDWHILE", "ENDTEST", "CASE"})
_BLOCK_WORDS |= {"DEFAULT", "THEN", "DO", "WITH", "TO", "STEP", "FROM"}

_STARTS = frozenset({"IF", "FOR", "WHILE", "TEST", "GOTO", "RETURN", "RAISE", "RETRY", "TRYNEXT"})
_STARTS |= {"EXIT", "CONNECT"}

_DATA_WORDS = frozenset({"VAR", "PERS", "CONST"})

_RESUME = (
    ROUTINE_ENDS
    | _STARTS
    | _DATA_WORDS
    | {"ENDIF", "ELSE", "ELSEIF", "ENDFOR", "ENDWHILE", "ENDTEST"}
)
_RESUME |= {"CASE", "DEFAULT", ";"}


def block(cursor: Cursor, ends: frozenset[str]) -> tuple[Statement, ...]:
    """Statements up to a word of ``ends``, of an outer block or of the routine, which stays."""
    found: list[Statement] = []
    cursor.open_ends.append(ends)
    while True:
        kind = cursor.kind
        if kind in ends or kind in ROUTINE_ENDS:
            break
        if kind in _BLOCK_WORDS and any(kind in outer for outer in cursor.open_ends):
            break
        statement = _recovering(cursor)
        if statement is not None:
            found.append(statement)
    cursor.open_ends.pop()
    return tuple(found)


def _recovering(cursor: Cursor) -> Statement | None:
    begin, nesting, outer = cursor.index, cursor.nesting, cursor.placeholder
    opened = len(cursor.open_ends)
    cursor.placeholder = None
    at = cursor.place
    try:
        found = _statement(cursor, at)
    except RapidSyntaxError as fault:
        cursor.nesting = nesting
        del cursor.open_ends[opened:]
        if cursor.placeholder is None:
            cursor.report(fault.at, fault.message)
        found = None
        if cursor.index == begin:
            cursor.advance()
        cursor.skip_to(_RESUME)
        cursor.accept(";")
    if cursor.placeholder is not None:
        found = Placeholder(at, cursor.placeholder)
    cursor.placeholder = outer
    return found


def _statement(cursor: Cursor, at: Place) -> Statement | None:
    kind = cursor.kind
    if kind == "name":
        return _named(cursor, at)
    if (compound := _COMPOUND.get(kind)) is not None:
        if cursor.nesting >= MAX_NESTING:
            raise RapidSyntaxError(
                at, f"nested deeper than {MAX_NESTING}: move the inner part to a PROC"
            )
        cursor.advance()
        cursor.nesting += 1
        made = compound(cursor, at)
        cursor.nesting -= 1
        return made
    if (simple := _SIMPLE.get(kind)) is not None:
        cursor.advance()
        found = simple(cursor, at)
        _semicolon(cursor)
        return found
    if kind == "%":
        return _late_call(cursor, at)
    if kind == "placeholder":
        return _placeholder(cursor, at)
    if kind == ";":
        cursor.advance()
        cursor.warn(at, "a semicolon with nothing before it: remove it")
        return None
    if kind in _DATA_WORDS:
        raise RapidSyntaxError(
            at, "data is declared at the top of a routine, before its statements"
        )
    if kind in _BLOCK_WORDS:
        raise RapidSyntaxError(at, f"{kind} without its {_PARTNERS.get(kind, 'beginning')}")
    return cursor.refuse("expected a statement")


def _semicolon(cursor: Cursor) -> None:
    if cursor.kind != ";" and cursor.begins_line and (cursor.kind == "name" or _is_word(cursor)):
        cursor.report(cursor.gap, "expected ';' at the end of the statement")
        return
    cursor.expect(";", "at the end of the statement")


def _is_word(cursor: Cursor) -> bool:
    return cursor.kind in _RESUME or cursor.kind in _BLOCK_WORDS


def _named(cursor: Cursor, at: Place) -> Statement:
    follower = cursor.peek()
    if follower == ":":
        name = cursor.new_name("a label")
        cursor.advance()
        return Label(at, name)
    if follower in (":=", ".", "{"):
        target = reference(cursor)
        cursor.expect(":=", "to assign to data")
        value = expression(cursor)
        _semicolon(cursor)
        return Assign(at, target, value)
    name = cursor.text
    cursor.advance()
    given = _call_arguments(cursor)
    return ProcCall(at, name, given)


def _call_arguments(cursor: Cursor) -> tuple[Argument, ...]:
    """Both ``a, b;`` and ``(a, b);``; the semicolon too."""
    if cursor.kind == "(" and _is_parenthesised(cursor):
        cursor.advance()
        given = arguments(cursor, ")")
        cursor.advance()
    else:
        given = arguments(cursor, ";")
    _semicolon(cursor)
    return given


def _is_parenthesised(cursor: Cursor) -> bool:
    depth = ahead = 0
    while (kind := cursor.peek(ahead)) not in (";", "end"):
        depth += (kind == "(") - (kind == ")")
        ahead += 1
        if depth == 0:
            return cursor.peek(ahead) == ";"
    return False


def _late_call(cursor: Cursor, at: Place) -> Statement:
    cursor.advance()
    name = expression(cursor)
    cursor.expect("%", "to close the name of the procedure")
    return LateCall(at, name, _call_arguments(cursor))


def _placeholder(cursor: Cursor, at: Place) -> Statement:
    text = cursor.text
    cursor.advance()
    if text.upper() == "<SMT>":
        cursor.accept(";")
    else:
        cursor.skip_to(_RESUME)
        cursor.accept(";")
    return Placeholder(at, text)


def _if(cursor: Cursor, at: Place) -> Statement | None:
    condition = _head(cursor, "THEN")
    if not cursor.accept("THEN"):
        return _compact_if(cursor, at, condition)
    branches = [(condition, block(cursor, _IF_ENDS))]
    otherwise: tuple[Statement, ...] = ()
    while True:
        if cursor.kind == "placeholder" and cursor.text.upper() == "<EIT>":
            cursor.advance()
        elif cursor.accept("ELSEIF"):
            condition = _head(cursor, "THEN")
            cursor.expect("THEN", "after the condition of ELSEIF")
            branches.append((condition, block(cursor, _IF_ENDS)))
        elif cursor.accept("ELSE"):
            otherwise = block(cursor, _ELSE_ENDS)
        else:
            break
    _close(cursor, at, "IF", "ENDIF")
    return If(at, tuple(branches), otherwise)


def _head(cursor: Cursor, end: str) -> Expr:
    """The expression before ``end``; a wrong one is noted, so that the block is still read."""
    at, nesting = cursor.place, cursor.nesting
    try:
        return expression(cursor)
    except RapidSyntaxError as fault:
        cursor.nesting = nesting
        cursor.skip_to(_RESUME | {"THEN", "DO", "TO"})
        if cursor.kind != end:
            raise
        cursor.report(fault.at, fault.message)
        return Name(at, "")


def _compact_if(cursor: Cursor, at: Place, condition: Expr) -> Statement | None:
    if cursor.kind not in _COMPACT_STARTS:
        cursor.refuse("expected THEN or one statement after the condition of IF")
    where = cursor.place
    statement = _statement(cursor, where)
    return None if statement is None else If(at, ((condition, (statement,)),))


def _for(cursor: Cursor, at: Place) -> Statement:
    variable = cursor.new_name("the variable of FOR")
    cursor.expect("FROM", "after the variable of FOR")
    first = _head(cursor, "TO")
    cursor.expect("TO", "after the first value of FOR")
    last = _head(cursor, "DO")
    step = _head(cursor, "DO") if cursor.accept("STEP") else None
    cursor.expect("DO", "before the statements of FOR")
    body = block(cursor, _FOR_ENDS)
    _close(cursor, at, "FOR", "ENDFOR")
    return For(at, variable, first, last, step, body)


def _while(cursor: Cursor, at: Place) -> Statement:
    condition = _head(cursor, "DO")
    cursor.expect("DO", "after the condition of WHILE")
    body = block(cursor, _WHILE_ENDS)
    _close(cursor, at, "WHILE", "ENDWHILE")
    return While(at, condition, body)


def _test(cursor: Cursor, at: Place) -> Statement:
    subject = _head(cursor, "CASE")
    stray = block(cursor, _TEST_ENDS)
    if stray:
        cursor.report(stray[0].at, "statements of TEST stand after a CASE or DEFAULT")
    cases: list[tuple[tuple[Expr, ...], tuple[Statement, ...]]] = []
    default: tuple[Statement, ...] | None = None
    while True:
        if cursor.kind == "placeholder" and cursor.text.upper() == "<CSE>":
            cursor.advance()
        elif cursor.accept("CASE"):
            values = [expression(cursor)]
            while cursor.accept(","):
                values.append(expression(cursor))
            cursor.expect(":", "after the values of CASE")
            cases.append((tuple(values), block(cursor, _TEST_ENDS)))
        elif cursor.accept("DEFAULT"):
            cursor.expect(":", "after DEFAULT")
            default = block(cursor, _TEST_ENDS)
        else:
            break
    _close(cursor, at, "TEST", "ENDTEST")
    return Test(at, subject, tuple(cases), default)


def _close(cursor: Cursor, at: Place, word: str, end: str) -> None:
    if cursor.accept(end):
        return
    if cursor.kind in ROUTINE_ENDS or cursor.kind in _BLOCK_WORDS:
        cursor.report(cursor.place, f"{end} is missing for the {word} of line {at.line}")
    elif cursor.kind in ("VAR", "PERS", "CONST"):
        cursor.report(cursor.place, f"data cannot be declared inside the {word} of line {at.line}")
    else:
        cursor.refuse(f"expected {end} for the {word} of line {at.line}")


def _goto(cursor: Cursor, at: Place) -> Statement:
    return Goto(at, cursor.name("a label after GOTO"))


def _return(cursor: Cursor, at: Place) -> Statement:
    return Return(at, None if cursor.kind == ";" else expression(cursor))


def _raise(cursor: Cursor, at: Place) -> Statement:
    return Raise(at, None if cursor.kind == ";" else expression(cursor))


def _connect(cursor: Cursor, at: Place) -> Statement:
    target = reference(cursor)
    cursor.expect("WITH", "after the interrupt of CONNECT")
    return Connect(at, target, cursor.name("the name of a TRAP"))


_IF_ENDS = frozenset({"ELSEIF", "ELSE", "ENDIF"})
_ELSE_ENDS = frozenset({"ENDIF"})
_FOR_ENDS = frozenset({"ENDFOR"})
_WHILE_ENDS = frozenset({"ENDWHILE"})
_TEST_ENDS = frozenset({"CASE", "DEFAULT", "ENDTEST"})

_PARTNERS = {"ENDIF": "IF", "ELSE": "IF", "ELSEIF": "IF", "ENDFOR": "FOR", "ENDWHILE": "WHILE"}
_PARTNERS |= {"ENDTEST": "TEST", "CASE": "TEST", "DEFAULT": "TEST", "THEN": "IF"}

_COMPOUND: dict[str, Callable[[Cursor, Place], Statement | None]] = {
    "IF": _if,
    "FOR": _for,
    "WHILE": _while,
    "TEST": _test,
}

_SIMPLE: dict[str, Callable[[Cursor, Place], Statement]] = {
    "GOTO": _goto,
    "RETURN": _return,
    "RAISE": _raise,
    "CONNECT": _connect,
    "RETRY": lambda _, at: Retry(at),
    "TRYNEXT": lambda _, at: TryNext(at),
    "EXIT": lambda _, at: Exit(at),
}

_COMPACT_STARTS = frozenset(_COMPOUND) | frozenset(_SIMPLE) | {"name", "%", "placeholder"}
