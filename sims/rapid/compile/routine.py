"""A whole routine: its data, body, handlers; and single expressions for data at load."""

from collections.abc import Iterator
from typing import Any

from sims.rapid import ast
from sims.rapid.ast import DataKind, Mode
from sims.rapid.compile.arguments import Arguments
from sims.rapid.compile.emitter import Code, Emitter
from sims.rapid.compile.matching import match
from sims.rapid.compile.parts import unfold
from sims.rapid.compile.scope import Local, RoutineScope
from sims.rapid.compile.statements import Statements
from sims.rapid.data import Cell
from sims.rapid.symbols import LinkError, ModuleScope, ParamInfo, Routine
from sims.rapid.types import Shape
from sims.rapid.values import default

__all__ = ["compile_routine", "evaluate"]

MAX_LOCAL_ELEMENTS = 100_000


def compile_routine(routine: Routine) -> tuple[Code | None, list[LinkError]]:
    """Return a routine's code, or all that is wrong with it."""
    try:
        return _Writer(routine).write()
    except RecursionError:
        name = routine.name
        return None, [LinkError(routine.decl.at, f"{name} is nested too deeply: split it")]


def evaluate(expr: ast.Expr, module: ModuleScope, shape: Shape) -> Any:
    """Return the value of an expression that data starts with. Raises ``LinkError``."""
    emitter = Emitter(0)
    emitter.statement(expr.at)
    text = Arguments(RoutineScope(module), emitter).kept(expr, shape)
    if emitter.position() > 1:
        raise LinkError(expr.at, "what data starts with cannot call a routine of the program")
    return eval(compile(text, "<data>", "eval"), module.program.namespace)


class _Writer:
    """Writes one routine."""

    def __init__(self, routine: Routine) -> None:
        self.routine = routine
        self.decl = routine.decl
        self.module = routine.module
        self.scope = RoutineScope(self.module)
        self.emitter = Emitter(0)
        self.statements = Statements(self.scope, self.emitter, routine.result, self.decl.kind)
        self.weight = 0

    def write(self) -> tuple[Code | None, list[LinkError]]:
        """Return the code, or the errors."""
        errors = self.statements.errors
        try:
            self._head()
        except LinkError as error:
            return None, [error]
        for body in self._bodies():
            self.statements.declare_labels(body)
        self.statements.block(self.decl.body)
        self._close(self.routine.result is not None)
        handlers = [self._handler(handler) for handler in self.decl.handlers]
        undo = self._undo()
        if errors:
            return None, errors
        layout = self.emitter.layout()
        namespace = self.module.program.namespace
        code = Code(
            layout.build(namespace, self.routine.name),
            **layout.tables(),
            handlers=tuple(
                (numbers, is_long, layout.number(label)) for numbers, is_long, label in handlers
            ),
            undo=None if undo is None else layout.number(undo),
            weight=self.weight,
        )
        return code, []

    def _bodies(self) -> Iterator[tuple[ast.Statement, ...]]:
        yield self.decl.body
        for handler in self.decl.handlers:
            yield handler.body
        if self.decl.undo is not None:
            yield self.decl.undo

    # Data.

    def _head(self) -> None:
        boxed = _Referred(self.module, self.decl).names()
        emitter = self.emitter
        end = self.decl.at
        mark = emitter.statement(end)
        lines = ["f.extend([None] * (@size - len(f)))"]
        for param in self.routine.params:
            lines += self._parameter(param, param.name in boxed)
        emitter.operation(*lines, "return @next")
        total = 0
        for data in self.decl.data:
            total += self._local(data, data.name.lower() in boxed)
        if total > MAX_LOCAL_ELEMENTS:
            raise LinkError(end, f"a routine's data has at most {MAX_LOCAL_ELEMENTS} values")
        emitter.place(mark.after)
        self.weight = total + len(self.routine.params)

    def _parameter(self, param: ParamInfo, is_boxed: bool) -> list[str]:
        slot = self.emitter.local()
        is_boxed = is_boxed and param.mode is Mode.IN and not param.is_switch
        self.scope.locals[param.name] = Local(
            param.name, slot, param.shape, is_boxed, param.mode, param.is_optional
        )
        if not is_boxed:
            return []
        bound = self.module.program.bind("h", param.shape)
        box = f"f[{slot}] = _Cell({param.name!r}, {bound}, f[{slot}])"
        return [f"if f[{slot}] is not _N: {box}"] if param.is_optional else [box]

    def _local(self, data: ast.DataDecl, is_boxed: bool) -> int:
        shape = self.module.shape(data.type, data.dims, data.at)
        slot = self.emitter.local()
        if data.kind is DataKind.PERS:
            raise LinkError(data.at, f"{data.name}: a PERS is declared in a module")
        if data.value is not None:
            start = self.statements.expressions.kept(data.value, shape)
        elif shape.is_list:
            value = self.module.program.bind("d", default(shape))
            start = f"_copy({value})"
        elif shape.type.make is not None:
            start = f"{self.module.program.bind('m', shape.type.make)}()"
        else:
            start = repr(default(shape))
        if is_boxed:
            bound = self.module.program.bind("h", shape)
            start = f"_Cell({data.name!r}, {bound}, {start})"
        self.emitter.operation(f"f[{slot}] = {start}", "return @next")
        name = data.name.lower()
        is_constant = data.kind is DataKind.CONST
        self.scope.locals[name] = Local(data.name, slot, shape, is_boxed, is_constant=is_constant)
        return shape.size

    # Clauses.

    def _close(self, needs_value: bool) -> None:
        mark = self.emitter.statement(self.decl.end or self.decl.at)
        self.emitter.operation("return T.no_value()" if needs_value else "return T.leave()")
        self.emitter.place(mark.after)
        self.emitter.operation("return T.leave()")

    def _handler(self, handler: ast.Handler) -> tuple[tuple[int | Cell, ...], bool, Any]:
        numbers = []
        for expr in handler.numbers:
            try:
                numbers.append(self._error_number(expr))
            except LinkError as error:
                self.statements.errors.append(error)
        label = self.emitter.label()
        self.emitter.place(label)
        self.statements.block(handler.body)
        self._close(self.routine.result is not None)
        return tuple(numbers), handler.has_long_jump, label

    def _error_number(self, expr: ast.Expr) -> int | Cell:
        if isinstance(expr, ast.Name):
            datum = self.module.find_data(expr.name.lower())
            if datum is not None and datum.decl.kind is not DataKind.CONST:
                return datum.cell
        return int(self.module.program.evaluate_number(expr, self.module))

    def _undo(self) -> Any:
        if self.decl.undo is None:
            return None
        label = self.emitter.label()
        self.emitter.place(label)
        self.statements.block(self.decl.undo)
        self._close(needs_value=False)
        return label


class _Referred:
    """Finds the local names that calls take by reference; those are kept in cells."""

    def __init__(self, module: ModuleScope, decl: ast.RoutineDecl) -> None:
        self._module = module
        self._decl = decl

    def names(self) -> frozenset[str]:
        """In lower case."""
        found: set[str] = set()
        for call in calls_in(self._decl):
            if isinstance(call, ast.Connect):
                found |= root_name(call.target)
            elif isinstance(call, ast.LateCall):
                for argument in call.arguments:
                    found |= root_name(argument.value)
            else:
                found |= self._by_reference(call)
        return frozenset(found)

    def _by_reference(self, call: ast.ProcCall | ast.Call) -> set[str]:
        routine = self._module.find_routine(call.name.lower())
        names: set[str] = set()
        try:
            pairs = (
                [] if routine is None else match(routine.params, call.arguments, call.name, call.at)
            )
        except LinkError:
            return names
        if routine is None:
            return names.union(*(root_name(argument.value) for argument in call.arguments))
        for param, argument in pairs:
            if argument is not None and param.mode is not Mode.IN:
                names |= root_name(argument.value)
        return names


def root_name(expr: ast.Expr | None) -> set[str]:
    """Return the data that an argument names, if it is data."""
    if expr is None:
        return set()
    base = unfold(expr)[1]
    return {base.name.lower()} if isinstance(base, ast.Name) else set()


def calls_in(
    decl: ast.RoutineDecl,
) -> Iterator[ast.ProcCall | ast.Call | ast.LateCall | ast.Connect]:
    """Return all calls in a routine, wherever they stand."""
    pending: list[Any] = [decl.body, decl.handlers, decl.undo, decl.data]
    while pending:
        node = pending.pop()
        if isinstance(node, tuple):
            pending += node
        elif isinstance(node, ast.ProcCall | ast.Call | ast.LateCall | ast.Connect):
            yield node
            pending += children(node)
        elif hasattr(node, "__dataclass_fields__"):
            pending += children(node)


def children(node: Any) -> list[Any]:
    """Return the parts of a tree's node that may hold calls."""
    return [
        part
        for name in node.__dataclass_fields__
        if name != "at"
        if isinstance(part := getattr(node, name), tuple) or hasattr(part, "__dataclass_fields__")
    ]
