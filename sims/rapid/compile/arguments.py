"""Arguments of calls: values, references to the caller's data, and what was not given."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from sims.rapid import ast
from sims.rapid.ast import DataKind, Mode
from sims.rapid.compile.expressions import Expressions
from sims.rapid.compile.matching import match
from sims.rapid.compile.parts import component, indexed, unfold
from sims.rapid.compile.scope import Local
from sims.rapid.compile.texts import BOOLEAN, NUMBER, Text, literal, owned
from sims.rapid.symbols import BuiltinRoutine, LinkError, MissingError, ParamInfo, Routine
from sims.rapid.types import Kind, Shape

__all__ = ["Arguments"]


class Arguments(Expressions):
    """Writes expressions with calls, and the arguments of calls."""

    # Calls.

    def call(self, expr: ast.Call) -> Text:
        """Return what a function gives. Raises ``LinkError``."""
        name = expr.name.lower()
        if name == "present":
            return self.present(expr)
        routine = self.scope.module.find_routine(name)
        if routine is None:
            if reason := self.program.refuses(expr.name):
                raise LinkError(expr.at, reason)
            raise MissingError(expr.at, f"the function {expr.name} is not known: load its module")
        if routine.result is None:
            raise LinkError(expr.at, f"{expr.name} gives no value: it is not a function")
        slot: Any
        if isinstance(routine, Routine):
            values = self.for_routine(routine, expr.arguments, expr.at)
            slot = self.emitter.temporary()
            bound = self.program.bind("R", routine)
            self.emitter.operation(f"return T.call({bound}, {values}, @own, @next, {slot[2:-1]})")
            return Text(slot, routine.result, is_fresh=True, is_fixed=True)
        return self._builtin(routine, self._keywords(routine, expr.arguments, expr.at))

    def _builtin(self, routine: BuiltinRoutine, keywords: Sequence[tuple[str, Text]]) -> Text:
        assert routine.result is not None
        arguments = _joined(keywords)
        bound = self.program.bind("B", routine.builtin.call)
        text = f"{bound}(C{arguments})"
        if routine.is_async:
            slot = self.emitter.temporary()
            shape = self.program.bind("h", routine.result)
            self.emitter.operation(f"return T.wait({text}, @own, @next, {slot[2:-1]}, {shape})")
            return Text(slot, routine.result, is_fresh=True, is_fixed=True)
        depth = 3 + max((given.depth for _, given in keywords), default=0)
        return Text(self._checked(text, routine.result), routine.result, is_fresh=True, depth=depth)

    def _checked(self, text: str, shape: Shape) -> str:
        match shape.type.kind:
            case Kind.NUM:
                return f"_round({text})"
            case Kind.DNUM:
                return f"_round64({text})"
            case Kind.BOOL:
                return text
            case Kind.STRING:
                return f"_join({text}, '')"
            case _:
                return f"_convert({text}, {self.program.bind('h', shape)})"

    # Arguments.

    def for_routine(
        self, routine: Routine, arguments: Sequence[ast.Argument], at: ast.Place
    ) -> str:
        """Return the list of a new frame's first slots."""
        pairs = match(routine.params, arguments, routine.name, at)
        texts = self.ordered([partial(self._argument, *pair, "_N") for pair in pairs])
        return "[" + ", ".join(text.text for text in texts) + "]"

    def for_builtin(
        self, routine: BuiltinRoutine, arguments: Sequence[ast.Argument], at: ast.Place
    ) -> str:
        """Return keyword arguments, each with a comma before it."""
        return _joined(self._keywords(routine, arguments, at))

    def _keywords(
        self, routine: BuiltinRoutine, arguments: Sequence[ast.Argument], at: ast.Place
    ) -> list[tuple[str, Text]]:
        pairs = match(routine.params, arguments, routine.name, at)
        texts = self.ordered([partial(self._argument, *pair, "None") for pair in pairs])
        return [(param.keyword, text) for (param, _), text in zip(pairs, texts, strict=True)]

    def for_late_call(self, arguments: Sequence[ast.Argument]) -> str:
        """Return a list of (name, is optional, reference or None, value) for the machine."""
        made = [self._late(argument) for argument in arguments]
        return "[" + ", ".join(made) + "]"

    def present(self, expr: ast.Call) -> Text:
        """``Present(parameter)``."""
        value = expr.arguments[0].value if len(expr.arguments) == 1 else None
        local = self._parameter(value) if isinstance(value, ast.Name) else None
        if local is None:
            raise LinkError(expr.at, "Present() asks about a parameter of its own routine")
        return Text(self._is_present(local), BOOLEAN, depth=1)

    # One argument.

    def _argument(self, param: ParamInfo, argument: ast.Argument | None, absent: str) -> Text:
        if argument is None:
            return Text("False" if param.is_switch else absent, param.shape, is_fixed=True)
        if param.is_switch:
            return self._switch(argument)
        if argument.condition is None:
            return self._given(param, argument)
        local = self._condition(argument)
        if argument.value is None or is_name(argument.value, local.name):
            return self._passed_on(param, local, argument, absent)
        given = self._given(param, argument)
        text = f"({given.text} if {self._is_present(local)} else {absent})"
        return Text(text, given.shape, is_fresh=given.is_fresh, depth=given.depth + 1)

    def _given(self, param: ParamInfo, argument: ast.Argument) -> Text:
        if argument.value is None:
            raise LinkError(argument.at, f"{param.name} needs a value: \\{argument.name}:=...")
        if param.mode is not Mode.IN:
            return self.reference(argument.value, param)
        if param.shape.type.kind is Kind.SIGNAL:
            return self._signal(param, argument.value)
        expected = None if param.shape.type.kind is Kind.ANY else param.shape
        value = self.value(argument.value, expected)
        return Text(
            owned(value),
            value.shape,
            is_fresh=True,
            depth=value.depth,
            is_fixed=(value.is_fixed and not value.shape.is_list),
        )

    def _signal(self, param: ParamInfo, expr: ast.Expr) -> Text:
        text = self.value(expr)
        if text.shape.type.kind is Kind.ANY:
            return text
        if text.shape.type.kind is not Kind.SIGNAL:
            raise LinkError(expr.at, f"{param.name} needs a signal, this is {text.shape}")
        return Text(f"_signal({text.text})", text.shape, depth=text.depth + 1)

    def _switch(self, argument: ast.Argument) -> Text:
        if argument.condition is not None:
            return Text(self._is_present(self._condition(argument)), BOOLEAN)
        if argument.value is not None:
            return self.condition(argument.value)
        return Text("True", BOOLEAN, is_fixed=True)

    def _condition(self, argument: ast.Argument) -> Local:
        assert argument.condition is not None
        local = self._parameter(argument.condition)
        if local is None:
            raise LinkError(
                argument.at,
                f"{argument.condition.name} behind ? is not a parameter of this routine",
            )
        return local

    def _passed_on(
        self, param: ParamInfo, local: Local, argument: ast.Argument, absent: str
    ) -> Text:
        slot = f"f[{local.slot}]"
        if not param.shape.accepts(local.shape):
            raise LinkError(argument.at, f"{param.name} needs {param.shape}, not {local.shape}")
        if param.mode is not Mode.IN:
            value = slot
        elif local.is_boxed or local.is_reference:
            value = owned(Text(f"{slot}.value", local.shape))
        else:
            value = owned(Text(slot, local.shape))
        if value == slot and absent == "_N":
            return Text(slot, local.shape)
        return Text(f"({value} if {slot} is not _N else {absent})", local.shape, depth=1)

    def _parameter(self, name: ast.Name) -> Local | None:
        return self.scope.find_local(name.name.lower())

    def _is_present(self, local: Local) -> str:
        slot = f"f[{local.slot}]"
        return slot if local.shape.type.kind is Kind.SWITCH else f"({slot} is not _N)"

    # References.

    def reference(self, expr: ast.Expr, param: ParamInfo | None = None) -> Text:
        """Return a reference to data, checked against a parameter. Raises ``LinkError``."""
        steps, base = unfold(expr)
        found = self._root(base) if isinstance(base, ast.Name) else None
        if found is None:
            return self._temporary_cell(expr, param)
        text, kind = found
        if steps:
            text = self._element(text, steps)
        if param is not None:
            _check_mode(param, text.shape, kind, expr.at)
        return text

    def _root(self, name: ast.Name) -> tuple[Text, DataKind] | None:
        key = name.name.lower()
        local = self.scope.find_local(key)
        if local is not None:
            kind = DataKind.VAR
            if local.mode is Mode.PERS:
                kind = DataKind.PERS
            elif local.is_constant:
                kind = DataKind.CONST
            if not local.is_boxed and not local.is_reference:
                return None
            return Text(f"f[{local.slot}]", local.shape, is_fixed=True), kind
        datum = self.scope.find_data(key)
        if datum is None:
            return None
        return Text(self.program.bind_cell(datum.cell), datum.shape, is_fixed=True), datum.decl.kind

    def _element(self, base: Text, steps: Sequence[ast.Field | ast.Index]) -> Text:
        path: list[str] = []
        shape = base.shape
        for step in steps:
            if isinstance(step, ast.Field):
                k, shape = component(shape, step)
                path.append(str(k))
                continue
            shape = indexed(shape, step)
            path += [f"float({self.value(i, NUMBER)})" for i in step.indices if i]
        bound = self.program.bind("h", shape)
        return Text(f"_ref({base.text}, {bound}, ({', '.join(path)},))", shape, depth=2)

    def _temporary_cell(self, expr: ast.Expr, param: ParamInfo | None) -> Text:
        """A built-in that takes any data (REF) may be given a value; nobody else may."""
        if param is None or param.mode is not Mode.REF:
            what = f" for {param.name}" if param is not None else ""
            raise LinkError(expr.at, f"data is needed{what}, not a value: declare a variable")
        expected = None if param.shape.type.kind is Kind.ANY else param.shape
        value = self.value(expr, expected)
        bound = self.program.bind("h", value.shape)
        return Text(f"_Cell('', {bound}, {owned(value)})", value.shape, depth=value.depth + 1)

    # Late calls.

    def _late(self, argument: ast.Argument) -> str:
        name = literal(argument.name)
        if argument.condition is not None:
            local = self._condition(argument)
            return f"({name}, {argument.is_optional}, None, {self._is_present(local)}, None)"
        if argument.value is None:
            return f"({name}, {argument.is_optional}, None, True, None)"
        reference = "None"
        if isinstance(unfold(argument.value)[1], ast.Name):
            try:
                reference = self.reference(argument.value).text
            except LinkError:
                reference = "None"
        value = self.value(argument.value)
        shape = self.program.bind("h", value.shape)
        return f"({name}, {argument.is_optional}, {reference}, {owned(value)}, {shape})"


def _joined(keywords: Sequence[tuple[str, Text]]) -> str:
    return "".join(f", {name}={given.text}" for name, given in keywords)


def is_name(expr: ast.Expr, name: str) -> bool:
    """Whether it is this name and no more."""
    return isinstance(expr, ast.Name) and expr.name.lower() == name


def _check_mode(param: ParamInfo, shape: Shape, kind: DataKind, at: ast.Place) -> None:
    if kind is DataKind.CONST and param.mode is not Mode.REF:
        raise LinkError(at, f"{param.name} is {param.mode}: a constant cannot be given")
    if param.mode is Mode.PERS and kind is not DataKind.PERS:
        raise LinkError(at, f"{param.name} must be a PERS: declare it as one")
    if not param.shape.accepts(shape):
        raise LinkError(at, f"{param.name} needs {param.shape}, not {shape}")
