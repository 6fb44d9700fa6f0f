"""Statements to operations. Structured statements become jumps between flat operations."""

from collections.abc import Sequence
from functools import partial

from sims.rapid import ast
from sims.rapid.compile.arguments import Arguments
from sims.rapid.compile.assignments import LOOK_UP, Assignments
from sims.rapid.compile.emitter import Emitter, Label
from sims.rapid.compile.scope import Local, RoutineScope
from sims.rapid.compile.texts import NUMBER, TEXT, Text, literal, owned
from sims.rapid.symbols import BuiltinRoutine, LinkError, MissingError, Routine
from sims.rapid.types import Kind, Shape

__all__ = ["Statements"]


class Statements:
    """Writes the statements of one routine. Errors are collected, one for each statement."""

    def __init__(
        self, scope: RoutineScope, emitter: Emitter, result: Shape | None, kind: ast.RoutineKind
    ) -> None:
        self.scope = scope
        self.emitter = emitter
        self.result = result
        self.kind = kind
        self.expressions = self.arguments = Arguments(scope, emitter)
        self.assignments = Assignments(self.expressions)
        self.program = scope.module.program
        self.errors: list[LinkError] = []
        self._labels: dict[str, Label] = {}

    def block(self, statements: Sequence[ast.Statement]) -> None:
        """Write statements one after the other."""
        for statement in statements:
            mark = self.emitter.statement(statement.at)
            position = self.emitter.position()
            try:
                self._statement(statement)
            except MissingError as error:
                self.emitter.cut(position)
                self._do(f"return T.missing({literal(str(error))})")
            except LinkError as error:
                self.errors.append(error)
                self.emitter.cut(position)
            self.emitter.place(mark.after)

    def declare_labels(self, statements: Sequence[ast.Statement]) -> None:
        """Make the labels known before the jumps to them are written."""
        pending = list(statements)
        while pending:
            statement = pending.pop()
            match statement:
                case ast.Label():
                    self._labels[statement.name.lower()] = self.emitter.label()
                case ast.If():
                    for _, body in statement.branches:
                        pending += body
                    pending += statement.otherwise
                case ast.For() | ast.While():
                    pending += statement.body
                case ast.Test():
                    for _, body in statement.cases:
                        pending += body
                    pending += statement.default or ()
                case _:
                    pass

    def _statement(self, node: ast.Statement) -> None:
        match node:
            case ast.Assign():
                self.assignments.write(node)
            case ast.ProcCall():
                self._call(node)
            case ast.LateCall():
                name = self.expressions.value(node.name, TEXT)
                arguments = self.arguments.for_late_call(node.arguments)
                self._do(f"return T.late({name.text}, {arguments}, {self._module()}, @own, @next)")
            case ast.If():
                self._if(node)
            case ast.For():
                self._for(node)
            case ast.While():
                self._while(node)
            case ast.Test():
                self._test(node)
            case ast.Goto():
                self._do(f"return @{self._label(node).number}@")
            case ast.Label():
                self.emitter.place(self._labels[node.name.lower()])
            case ast.Connect():
                self._connect(node)
            case _:
                self._leave(node)

    def _leave(self, node: ast.Statement) -> None:
        match node:
            case ast.Return():
                self._return(node)
            case ast.Raise():
                value = "None" if node.value is None else self._number(node.value)
                self._do(f"return T.throw({value})")
            case ast.Retry():
                self._do("return T.retry()")
            case ast.TryNext():
                self._do("return T.try_next()")
            case ast.Exit():
                self._do("return T.exit()")
            case ast.Placeholder():
                self._do(f"return T.unfinished({literal(node.text)})")
            case _:
                raise AssertionError(node)

    def _do(self, *lines: str) -> None:
        self.emitter.operation(*lines)

    def _module(self) -> str:
        return self.program.bind("M", self.scope.module)

    def _number(self, expr: ast.Expr) -> str:
        return self.expressions.value(expr, NUMBER).text

    # Calls.

    def _call(self, node: ast.ProcCall) -> None:
        routine = self.scope.module.find_routine(node.name.lower())
        if routine is None:
            reason = self.program.refuses(node.name)
            if reason:
                raise LinkError(node.at, reason)
            arguments = self._late_arguments(node)
            self._do(
                f"return T.late({literal(node.name)}, {arguments}, {self._module()}, @own, @next)"
            )
        elif isinstance(routine, Routine):
            if routine.decl.kind is not ast.RoutineKind.PROC:
                raise LinkError(node.at, f"{node.name} is no procedure: use its value")
            values = self.arguments.for_routine(routine, node.arguments, node.at)
            bound = self.program.bind("R", routine)
            self._do(f"return T.call({bound}, {values}, @own, @next, None)")
        else:
            self._builtin(routine, node)

    def _late_arguments(self, node: ast.ProcCall) -> str:
        try:
            return self.arguments.for_late_call(node.arguments)
        except LinkError as error:
            raise MissingError(node.at, f"{node.name} is not known, and {error}") from error

    def _builtin(self, routine: BuiltinRoutine, node: ast.ProcCall) -> None:
        if routine.result is not None:
            raise LinkError(node.at, f"{node.name} is a function: use its value")
        if routine.name == "WaitUntil":
            self._wait_until(routine, node)
            return
        arguments = self.arguments.for_builtin(routine, node.arguments, node.at)
        bound = self.program.bind("B", routine.builtin.call)
        if routine.name == "CallByVar":
            name = f"{bound}(C{arguments})"
            self._do(f"return T.late({name}, [], {self._module()}, @own, @next)")
            return
        if routine.is_async:
            self._do(f"return T.wait({bound}(C{arguments}), @own, @next, None, None)")
            return
        self._do(f"{bound}(C{arguments})", LOOK_UP)
        if routine.name == "StartMoveRetry":
            self._do("return T.retry()")

    def _wait_until(self, routine: BuiltinRoutine, node: ast.ProcCall) -> None:
        """The condition is evaluated anew at each look."""
        emitter = self.emitter
        condition = next((one for one in node.arguments if not one.is_optional), None)
        if condition is None or condition.value is None:
            raise LinkError(node.at, "WaitUntil needs a condition")
        constant = ast.Argument(condition.at, condition.name, ast.BoolLiteral(node.at, True))
        given = [constant if one is condition else one for one in node.arguments]
        arguments = self.arguments.for_builtin(routine, given, node.at)
        slot = f"f[{emitter.local()}]"
        bound = self.program.bind("B", routine.builtin.call)
        self._do(f"{slot} = {bound}(C{arguments})", "return @next")
        again, end = emitter.label(), emitter.label()
        emitter.place(again)
        text = self.expressions.condition(condition.value)
        self._do(f"return @{end.number}@ if {text.text} and {slot}.done() else @next")
        self._do(f"return @{end.number}@ if {slot}.is_over() else @next")
        self._do(f"return T.wait({slot}.pause(), @own, @{again.number}@, None, None)")
        emitter.place(end)

    def _connect(self, node: ast.Connect) -> None:
        trap = self.scope.module.find_routine(node.trap.lower())
        if not isinstance(trap, Routine) or trap.decl.kind is not ast.RoutineKind.TRAP:
            raise LinkError(node.at, f"{node.trap} is no TRAP: declare it")
        target = self.arguments.reference(node.target)
        bound = self.program.bind("R", trap)
        self._do(f"T.interrupts.connect({target.text}, {bound})", "return @next")

    def _return(self, node: ast.Return) -> None:
        if node.value is None:
            if self.result is not None:
                raise LinkError(node.at, "RETURN needs a value in a function")
            self._do("return T.leave()")
        elif self.result is None:
            raise LinkError(node.at, "RETURN has a value, but this is no function")
        else:
            self._do(f"return T.leave({self.expressions.kept(node.value, self.result)})")

    # Jumps.

    def _label(self, node: ast.Goto) -> Label:
        label = self._labels.get(node.label.lower())
        if label is None:
            raise LinkError(node.at, f"there is no label {node.label} in this routine")
        return label

    def _if(self, node: ast.If) -> None:
        end = self.emitter.label()
        for condition, body in node.branches:
            otherwise = self.emitter.label()
            text = self.expressions.condition(condition)
            self._do(f"return @next if {text.text} else @{otherwise.number}@")
            self._body(body)
            self.emitter.jump(end)
            self.emitter.place(otherwise)
        self._body(node.otherwise)
        self.emitter.place(end)

    def _body(self, body: Sequence[ast.Statement]) -> None:
        """A block inside a statement, whose mark then goes on."""
        mark = self.emitter.mark
        self.block(body)
        self.emitter.mark = mark

    def _while(self, node: ast.While) -> None:
        begin, end = self.emitter.label(), self.emitter.label()
        self.emitter.place(begin)
        text = self.expressions.condition(node.condition)
        self._do(f"return @next if {text.text} else @{end.number}@")
        self._body(node.body)
        self.emitter.jump(begin)
        self.emitter.place(end)

    def _for(self, node: ast.For) -> None:
        emitter, number = self.emitter, self.expressions.value
        k, last, step = emitter.local(), emitter.local(), emitter.local()
        exprs = [node.first, node.last] + ([node.step] if node.step is not None else [])
        texts = self.expressions.ordered([partial(number, expr, NUMBER) for expr in exprs])
        lines = [f"f[{k}] = {texts[0].text}", f"f[{last}] = {texts[1].text}"]
        if len(texts) > 2:
            lines.append(f"f[{step}] = {texts[2].text}")
        else:
            lines.append(f"f[{step}] = 1.0 if f[{k}] <= f[{last}] else -1.0")
        body, end = emitter.label(), emitter.label()
        goes_on = (
            f"return @{body.number}@ if (f[{k}] <= f[{last}] if f[{step}] >= 0.0"
            f" else f[{k}] >= f[{last}]) else @{end.number}@"
        )
        self._do(*lines, goes_on)
        emitter.place(body)
        name = node.variable.lower()
        hidden = self.scope.locals.get(name)
        self.scope.locals[name] = Local(node.variable, k, NUMBER, is_constant=True)
        try:
            self._body(node.body)
        finally:
            if hidden is None:
                del self.scope.locals[name]
            else:
                self.scope.locals[name] = hidden
        self._do(f"f[{k}] = _round(f[{k}] + f[{step}])", goes_on)
        emitter.place(end)

    def _test(self, node: ast.Test) -> None:
        emitter = self.emitter
        subject = self.expressions.value(node.subject)
        if not subject.is_fixed:
            subject = self._subject(subject)
        end = emitter.label()
        bodies: list[tuple[Label, Sequence[ast.Statement]]] = []
        for values, body in node.cases:
            label = emitter.label()
            bodies.append((label, body))
            for value in values:
                same = self._is_case(subject, value)
                self._do(f"return @{label.number}@ if {same} else @next")
        self._body(node.default or ())
        for label, statements in bodies:
            emitter.jump(end)
            emitter.place(label)
            self._body(statements)
        emitter.place(end)

    def _subject(self, subject: Text) -> Text:
        slot = f"f[{self.emitter.local()}]"
        self._do(f"{slot} = {owned(subject)}", "return @next")
        return Text(slot, subject.shape, is_fixed=True)

    def _is_case(self, subject: Text, value: ast.Expr) -> str:
        if subject.shape.type.kind is Kind.SIGNAL:
            return f"_signal({subject.text}).value == {self._number(value)}"
        return f"{subject.text} == {self.expressions.value(value, subject.shape).text}"
