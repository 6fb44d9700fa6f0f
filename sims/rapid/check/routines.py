"""Statements of a routine: names, labels, handlers, what may be assigned to."""

from collections.abc import Iterable, Sequence

from sims.rapid.ast import (
    Assign,
    Connect,
    DataDecl,
    DataKind,
    Expr,
    Field,
    For,
    Goto,
    Handler,
    If,
    Index,
    Label,
    LateCall,
    Mode,
    Name,
    Param,
    Placeholder,
    ProcCall,
    Raise,
    Retry,
    Return,
    RoutineDecl,
    RoutineKind,
    Statement,
    Test,
    TryNext,
    While,
)
from sims.rapid.check.calls import Calls
from sims.rapid.check.declarations import check_data
from sims.rapid.check.expressions import NUM, Expressions, fits
from sims.rapid.check.scope import Data, Known, data_of

__all__ = ["check_routine"]


def check_routine(decl: RoutineDecl, expressions: Expressions, calls: Calls) -> None:
    """Check all clauses of a routine."""
    expressions.locals = [{}]
    for param in decl.params:
        _declare_param(param, expressions)
    for item in decl.data:
        _declare_data(item, expressions)
    walk = _Walk(decl, expressions, calls)
    walk.clause(decl.body)
    for handler in decl.handlers:
        walk.handler(handler)
    for clause in (decl.undo, decl.backward):
        walk.clause(clause or ())
    if decl.kind is RoutineKind.FUNC and not walk.has_way_out:
        expressions.warn(decl.at, f"{decl.name} has no RETURN: ERR_FNCNORET when it is called")
    expressions.locals = []


def _declare_param(param: Param, expressions: Expressions) -> None:
    names = expressions.locals[0]
    if param.name.lower() in names:
        expressions.error(param.at, f"the parameter {param.name} stands twice: rename one")
    resolved = expressions.types.resolve(param.type)
    if resolved is None:
        expressions.error(
            param.at, f"the type {param.type} is not known: declare it, or load its module"
        )
    known = None if resolved in (None, "anytype", "switch") else Known(resolved or "", param.rank)
    kind = DataKind.PERS if param.mode is Mode.PERS else None
    names[param.name.lower()] = Data(param.name, known, kind, param=param)


def _declare_data(item: DataDecl, expressions: Expressions) -> None:
    names = expressions.locals[0]
    if item.name.lower() in names:
        expressions.error(item.at, f"{item.name} is declared twice in this routine: rename one")
    if item.kind is DataKind.PERS:
        expressions.error(item.at, f"{item.name} is PERS: declare it in the module, not a routine")
    check_data(item, expressions)
    names[item.name.lower()] = data_of(item, expressions.types)


class _Walk:
    """Goes through the statements of one routine."""

    def __init__(self, decl: RoutineDecl, expressions: Expressions, calls: Calls) -> None:
        self.decl = decl
        self.expressions = expressions
        self.calls = calls
        self.has_way_out = False
        self._in_handler = False
        clauses = [decl.body, *(handler.body for handler in decl.handlers)]
        clauses += [clause for clause in (decl.undo, decl.backward) if clause is not None]
        self._labels = {label.name.lower() for clause in clauses for label in _labels_in(clause)}

    def clause(self, statements: Sequence[Statement]) -> None:
        """Check the statements of a clause; a label stands once in it."""
        seen: set[str] = set()
        for label in _labels_in(statements):
            if label.name.lower() in seen:
                self.expressions.error(label.at, f"the label {label.name} stands twice")
            seen.add(label.name.lower())
        self._block(statements)

    def handler(self, handler: Handler) -> None:
        """Check an ERROR clause."""
        for number in handler.numbers:
            self.expressions.expect(number, NUM, "an error number")
        self._in_handler = True
        self.clause(handler.body)
        self._in_handler = False

    def _block(self, statements: Iterable[Statement]) -> None:
        for statement in statements:
            self._statement(statement)

    def _statement(self, node: Statement) -> None:
        match node:
            case If():
                for condition, body in node.branches:
                    self.expressions.condition(condition)
                    self._block(body)
                self._block(node.otherwise)
            case While():
                self.expressions.condition(node.condition)
                self._block(node.body)
            case For():
                self._for(node)
            case Test():
                self._test(node)
            case Goto() | Return() | Raise() | Retry() | TryNext():
                self._jump(node)
            case _:
                self._simple(node)

    def _simple(self, node: Statement) -> None:
        match node:
            case Assign():
                self._assign(node)
            case ProcCall():
                self.calls.procedure(node.at, node.name, node.arguments)
            case LateCall():
                self.expressions.expect(node.name, Known("string"), "the name of a procedure")
                self.calls.any_arguments(node.arguments)
            case Connect():
                self._connect(node)
            case Placeholder():
                self.expressions.warn(
                    node.at, f"unfinished: {node.text}; an error when it is reached"
                )
            case _:
                pass

    def _jump(self, node: Goto | Return | Raise | Retry | TryNext) -> None:
        match node:
            case Goto():
                if node.label.lower() not in self._labels:
                    self.expressions.error(
                        node.at, f"there is no label {node.label} in {self.decl.name}"
                    )
            case Return():
                self._return(node)
            case Raise():
                self._raise(node)
            case _:
                if not self._in_handler:
                    word = type(node).__name__.upper()
                    self.expressions.error(node.at, f"{word} stands in an ERROR handler only")

    def _assign(self, node: Assign) -> None:
        wanted = self.expressions.type_of(node.target)
        self.expressions.expect(node.value, wanted, "what is assigned to")
        data = self._root(node.target)
        if data is None:
            return
        if data.kind is DataKind.CONST:
            self.expressions.error(
                node.at, f"{data.name} is a CONST: declare it as VAR or PERS to assign to it"
            )
        elif data.is_loop:
            self.expressions.error(
                node.at, f"{data.name} is the variable of FOR and cannot be assigned to"
            )

    def _root(self, target: Expr) -> Data | None:
        while isinstance(target, Field | Index):
            target = target.base
        return self.expressions.find(target.name) if isinstance(target, Name) else None

    def _for(self, node: For) -> None:
        for part in (node.first, node.last, node.step):
            if part is not None:
                self.expressions.expect(part, NUM, "a bound of FOR")
        low = node.variable.lower()
        self.expressions.locals.append({low: Data(node.variable, None, is_loop=True)})
        self._block(node.body)
        self.expressions.locals.pop()

    def _test(self, node: Test) -> None:
        subject = self.expressions.type_of(node.subject)
        for values, body in node.cases:
            for value in values:
                given = self.expressions.type_of(value, subject)
                if not fits(subject, given):
                    self.expressions.error(
                        value.at, f"TEST is about a {subject}, this is a {given}"
                    )
            self._block(body)
        self._block(node.default or ())

    def _return(self, node: Return) -> None:
        is_function = self.decl.kind is RoutineKind.FUNC
        self.has_way_out = True
        if is_function and node.value is None and not self._in_handler:
            self.expressions.error(node.at, f"{self.decl.name} is a FUNC: RETURN needs a value")
        elif not is_function and node.value is not None:
            self.expressions.error(node.at, f"a {self.decl.kind} returns no value: RETURN; alone")
        if node.value is not None:
            resolved = self.expressions.types.resolve(self.decl.type or "")
            wanted = None if resolved is None else Known(resolved)
            self.expressions.expect(node.value, wanted, f"the result of {self.decl.name}")

    def _raise(self, node: Raise) -> None:
        self.has_way_out = True
        if node.value is not None:
            self.expressions.expect(node.value, NUM, "an error number")
        elif not self._in_handler:
            self.expressions.error(
                node.at, "RAISE without a number stands in an ERROR handler only: RAISE number;"
            )

    def _connect(self, node: Connect) -> None:
        self.expressions.expect(node.target, NUM, "an interrupt number")
        routine = self.expressions.names.find_routine(self.expressions.module, node.trap)
        if routine is None:
            self.expressions.error(node.at, f"there is no TRAP {node.trap}: declare it")
        elif routine.decl.kind is not RoutineKind.TRAP:
            self.expressions.error(
                node.at, f"{node.trap} is a {routine.decl.kind}: CONNECT needs a TRAP"
            )


def _labels_in(statements: Iterable[Statement]) -> Iterable[Label]:
    for node in statements:
        match node:
            case Label():
                yield node
            case If():
                for _, body in node.branches:
                    yield from _labels_in(body)
                yield from _labels_in(node.otherwise)
            case For() | While():
                yield from _labels_in(node.body)
            case Test():
                for _, body in node.cases:
                    yield from _labels_in(body)
                yield from _labels_in(node.default or ())
            case _:
                pass
