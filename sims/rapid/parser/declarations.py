"""Declarations: data, records, aliases, routines and their parameters."""

from sims.rapid.ast import (
    AliasDecl,
    DataDecl,
    DataKind,
    Declaration,
    Expr,
    Handler,
    Mode,
    Name,
    Param,
    Place,
    RecordDecl,
    RoutineDecl,
    RoutineKind,
    Scope,
    Statement,
)
from sims.rapid.parser.cursor import Cursor, RapidSyntaxError
from sims.rapid.parser.expressions import expression
from sims.rapid.parser.statements import ROUTINE_ENDS, block

__all__ = ["DECLARATION_STARTS", "declaration", "routine_head"]

_DATA_WORDS = frozenset({"VAR", "PERS", "CONST"})
_SCOPES = frozenset({"LOCAL", "TASK"})

DECLARATION_STARTS = _DATA_WORDS | _SCOPES | {"RECORD", "ALIAS", "PROC", "FUNC", "TRAP"}

_CLAUSES = frozenset({"ERROR", "UNDO", "BACKWARD"})
_LONG_JUMP = "long_jmp_all_err"

_Head = tuple[str, str | None, tuple[Param, ...]]


def declaration(cursor: Cursor) -> Declaration:
    """One declaration of a module."""
    scope = Scope.GLOBAL
    if cursor.kind in _SCOPES:
        scope = Scope(cursor.kind)
        cursor.advance()
    kind = cursor.kind
    if kind in _DATA_WORDS:
        return _data(cursor, scope)
    if kind not in DECLARATION_STARTS or kind in _SCOPES:
        cursor.refuse("expected a declaration")
    if scope is Scope.TASK:
        raise RapidSyntaxError(
            cursor.place, f"TASK says who shares data; a {kind} has no use for it"
        )
    if kind == "RECORD":
        return _record(cursor, scope)
    if kind == "ALIAS":
        return _alias(cursor, scope)
    return _routine(cursor, scope)


def routine_head(cursor: Cursor) -> RoutineDecl:
    """``PROC name(parameters)`` alone, as built-in routines declare themselves."""
    kind = RoutineKind(cursor.kind)
    cursor.advance()
    at = cursor.place
    name, type_name, params = _head(cursor, kind)
    return RoutineDecl(at, Scope.GLOBAL, kind, name, type_name, params, (), ())


def _data(cursor: Cursor, scope: Scope) -> DataDecl:
    kind = DataKind(cursor.kind)
    cursor.advance()
    type_name = cursor.name(f"a type after {kind}")
    at = cursor.place
    name = cursor.new_name("the name of the data")
    dims: list[Expr] = []
    if cursor.accept("{"):
        dims.append(expression(cursor))
        while cursor.accept(","):
            dims.append(expression(cursor))
        cursor.expect("}", "after the dimensions")
    value = expression(cursor) if cursor.accept(":=") else None
    if value is None and kind is DataKind.CONST and cursor.placeholder is None:
        raise RapidSyntaxError(at, f"a CONST needs its value: CONST {type_name} {name} := ...;")
    cursor.expect(";", "at the end of the declaration")
    return DataDecl(at, scope, kind, type_name, name, tuple(dims), value)


def _record(cursor: Cursor, scope: Scope) -> RecordDecl:
    cursor.advance()
    at = cursor.place
    name = cursor.new_name("the name of the record")
    fields: list[tuple[str, str]] = []
    while cursor.kind in ("name", "placeholder"):
        type_name = cursor.name("the type of a component")
        fields.append((type_name, cursor.new_name("the name of a component")))
        cursor.expect(";", "after a component")
    cursor.expect("ENDRECORD", f"at the end of RECORD {name}")
    if not fields:
        raise RapidSyntaxError(at, f"RECORD {name} has no components")
    return RecordDecl(at, scope, name, tuple(fields))


def _alias(cursor: Cursor, scope: Scope) -> AliasDecl:
    cursor.advance()
    type_name = cursor.name("a type after ALIAS")
    at = cursor.place
    name = cursor.new_name("the new name of the type")
    cursor.expect(";", "at the end of the declaration")
    return AliasDecl(at, scope, type_name, name)


def _routine(cursor: Cursor, scope: Scope) -> RoutineDecl:
    kind = RoutineKind(cursor.kind)
    cursor.advance()
    at = cursor.place
    name, type_name, params = _head(cursor, kind)
    data = _local_data(cursor)
    body = block(cursor, _CLAUSES)
    handlers: list[Handler] = []
    clauses: dict[str, tuple[Statement, ...]] = {}
    while cursor.kind in _CLAUSES:
        word, where = cursor.kind, cursor.place
        cursor.advance()
        if word == "ERROR":
            handlers.append(_handler(cursor, where))
        elif word in clauses:
            raise RapidSyntaxError(where, f"{word} stands twice in {name}")
        else:
            clauses[word] = block(cursor, _CLAUSES)
    end = cursor.place
    _end_of_routine(cursor, kind, name)
    return RoutineDecl(
        at,
        scope,
        kind,
        name,
        type_name,
        params,
        data,
        body,
        tuple(handlers),
        clauses.get("UNDO"),
        clauses.get("BACKWARD"),
        end,
    )


def _end_of_routine(cursor: Cursor, kind: RoutineKind, name: str) -> None:
    wanted = f"END{kind}"
    if cursor.accept(wanted):
        return
    cursor.report(cursor.place, f"{wanted} is missing at the end of {kind} {name}")
    if cursor.kind in ("ENDPROC", "ENDFUNC", "ENDTRAP"):
        cursor.advance()


def _head(cursor: Cursor, kind: RoutineKind) -> _Head:
    type_name = cursor.name("the type of the function's result") if kind == "FUNC" else None
    name = cursor.new_name(f"the name of the {kind}")
    if kind is RoutineKind.TRAP:
        return name, None, ()
    cursor.expect("(", f"after {kind} {name}")
    nesting = cursor.nesting
    try:
        params = _params(cursor)
    except RapidSyntaxError as fault:
        cursor.nesting = nesting
        cursor.report(fault.at, fault.message)
        cursor.skip_to(ROUTINE_ENDS | {")"})
        cursor.accept(")")
        return name, type_name, ()
    cursor.advance()
    return name, type_name, params


def _params(cursor: Cursor) -> tuple[Param, ...]:
    found: list[Param] = []
    group = 0
    while cursor.kind != ")":
        if found and cursor.kind != "\\":
            cursor.expect(",", "or ')' after a parameter")
        if cursor.kind == "placeholder":
            cursor.warn(cursor.place, f"a parameter is left unfinished: {cursor.text}")
            cursor.advance()
            continue
        if not cursor.accept("\\"):
            found.append(_param(cursor, is_optional=False, group=0))
            continue
        group += 1
        alternatives = [_param(cursor, is_optional=True, group=group)]
        while cursor.accept("|"):
            cursor.accept("\\")
            alternatives.append(_param(cursor, is_optional=True, group=group))
        found.extend(alternatives if len(alternatives) > 1 else [_alone(alternatives[0])])
    return tuple(found)


def _alone(param: Param) -> Param:
    return Param(param.at, param.name, param.type, param.mode, param.rank, is_optional=True)


def _param(cursor: Cursor, *, is_optional: bool, group: int) -> Param:
    mode = Mode.IN
    if cursor.kind in ("VAR", "PERS", "INOUT"):
        mode = Mode(cursor.kind)
        cursor.advance()
    elif cursor.text.upper() == "REF" and cursor.peek(2) == "name":
        mode = Mode.REF
        cursor.advance()
    type_name = cursor.name("the type of a parameter")
    at = cursor.place
    name = cursor.new_name("the name of a parameter")
    rank = 0
    if cursor.accept("{"):
        rank = 1
        cursor.expect("*", "as the size of an array parameter")
        while cursor.accept(","):
            cursor.expect("*", "as the size of an array parameter")
            rank += 1
        cursor.expect("}", "after the size of an array parameter")
    return Param(at, name, type_name, mode, rank, is_optional, group)


def _local_data(cursor: Cursor) -> tuple[DataDecl, ...]:
    found: list[DataDecl] = []
    outer = cursor.placeholder
    while cursor.kind in _DATA_WORDS or cursor.kind in _SCOPES or _is_data_placeholder(cursor):
        cursor.placeholder = None
        at = cursor.place
        if cursor.kind in _SCOPES and cursor.peek() not in _DATA_WORDS:
            break
        try:
            declared = None if cursor.kind == "placeholder" else _local(cursor)
        except RapidSyntaxError as fault:
            declared = None
            cursor.report(fault.at, fault.message)
            cursor.skip_to(ROUTINE_ENDS | _DATA_WORDS | {";"})
            cursor.accept(";")
        if cursor.kind == "placeholder" and declared is None:
            cursor.name("a declaration")
            cursor.accept(";")
        if cursor.placeholder is not None:
            cursor.warn(at, f"a declaration is left unfinished: {cursor.placeholder}")
        elif declared is not None:
            found.append(declared)
    cursor.placeholder = outer
    return tuple(found)


def _is_data_placeholder(cursor: Cursor) -> bool:
    return cursor.kind == "placeholder" and cursor.text.upper() in ("<DDN>", "<TDN>")


def _local(cursor: Cursor) -> DataDecl:
    if cursor.kind in _SCOPES:
        at, word = cursor.place, cursor.kind
        cursor.advance()
        cursor.report(at, f"{word} belongs to data of a module; remove it in a routine")
    return _data(cursor, Scope.GLOBAL)


def _handler(cursor: Cursor, at: Place) -> Handler:
    numbers: list[Expr] = []
    has_long_jump = False
    if cursor.accept("("):
        while True:
            number = expression(cursor)
            if isinstance(number, Name) and number.name.lower() == _LONG_JUMP:
                has_long_jump = True
            else:
                numbers.append(number)
            if not cursor.accept(","):
                break
        cursor.expect(")", "after the list of errors")
    return Handler(at, tuple(numbers), block(cursor, _CLAUSES), has_long_jump)
