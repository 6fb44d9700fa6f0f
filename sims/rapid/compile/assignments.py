"""Assignments: into slots and cells, into parts of them, through references."""

from collections.abc import Sequence

from sims.rapid import ast
from sims.rapid.ast import DataKind, Mode
from sims.rapid.compile.arguments import Arguments
from sims.rapid.compile.parts import component, indexed, unfold
from sims.rapid.compile.scope import Local
from sims.rapid.compile.texts import NUMBER, Text, owned
from sims.rapid.symbols import LinkError
from sims.rapid.types import Kind, Shape

__all__ = ["LOOK_UP", "Assignments"]

LOOK_UP = "return @next if not T.attention else T.pause(@next)"


class Assignments:
    """Writes the assignments of one routine."""

    def __init__(self, expressions: Arguments) -> None:
        self.expressions = expressions
        self.scope = expressions.scope
        self.program = expressions.program
        self._do = expressions.emitter.operation
        self.emitter = expressions.emitter

    def write(self, node: ast.Assign) -> None:
        """Write an assignment. Raises ``LinkError``."""
        steps, base = unfold(node.target)
        if not isinstance(base, ast.Name):
            raise LinkError(node.at, "only data can be assigned to")
        name = base.name.lower()
        local = self.scope.find_local(name)
        if local is not None and not local.is_reference:
            self._check_local(local, node)
            root = f"f[{local.slot}]" + (".value" if local.is_boxed else "")
            self._store(node, root, local.shape, steps)
        elif local is not None and local.mode is Mode.VAR and steps:
            self._store(node, f"f[{local.slot}].value", local.shape, steps)
        elif local is not None:
            self._store_through(node, Text(f"f[{local.slot}]", local.shape), steps)
        else:
            self._assign_datum(node, name, steps)

    def _assign_datum(
        self, node: ast.Assign, name: str, steps: Sequence[ast.Field | ast.Index]
    ) -> None:
        datum = self.scope.find_data(name)
        if datum is None:
            if (signal := self.scope.module.find_signal(name)) is not None:
                raise LinkError(node.at, f"{signal.name} is a signal: use SetDO, SetGO or SetAO")
            raise LinkError(node.at, f"{name} is not known: declare it or load its module")
        cell = self.program.bind_cell(datum.cell)
        match datum.decl.kind:
            case DataKind.CONST:
                raise LinkError(node.at, f"{datum.decl.name} is a constant")
            case DataKind.PERS:
                self._store_through(node, Text(cell, datum.shape), steps)
            case DataKind.VAR:
                self._store(node, f"{cell}.value", datum.shape, steps)

    def _check_local(self, local: Local, node: ast.Assign) -> None:
        if local.is_constant:
            raise LinkError(node.at, f"{local.name} is a constant or a FOR variable")
        if local.shape.type.kind is Kind.SWITCH:
            raise LinkError(node.at, f"{local.name} is a switch and cannot be assigned to")

    def _store(
        self, node: ast.Assign, root: str, shape: Shape, steps: Sequence[ast.Field | ast.Index]
    ) -> None:
        """Store straight into a value that nobody watches."""
        path, shape = self._path(shape, steps)
        _check_assignable(shape, node.at)
        value = self._value_before_path(node.value, shape, path)
        if not path:
            self._do(f"{root} = {value}", "return @next")
            return
        for step in path[:-1]:
            root = f"{root}[{step}]" if isinstance(step, int) else f"_element({root}, {step.text})"
        last = path[-1]
        if isinstance(last, int):
            self._do(f"{root}[{last}] = {value}", "return @next")
        else:
            self._do(f"_put({root}, {last.text}, {value})", "return @next")

    def _store_through(
        self, node: ast.Assign, root: Text, steps: Sequence[ast.Field | ast.Index]
    ) -> None:
        """Store into data that somebody may watch."""
        path, shape = self._path(root.shape, steps)
        _check_assignable(shape, node.at)
        value = self._value_before_path(node.value, shape, path)
        target = root.text
        if path:
            bound = self.program.bind("h", shape)
            texts = [str(s) if isinstance(s, int) else f"float({s.text})" for s in path]
            target = f"_ref({root.text}, {bound}, ({', '.join(texts)},))"
        self._do(f"{target}.store({value})", LOOK_UP)

    def _path(
        self, shape: Shape, steps: Sequence[ast.Field | ast.Index]
    ) -> tuple[list[int | Text], Shape]:
        path: list[int | Text] = []
        for step in steps:
            if isinstance(step, ast.Field):
                k, shape = component(shape, step)
                path.append(k)
                continue
            shape = indexed(shape, step)
            path += [self.expressions.value(index, NUMBER) for index in step.indices if index]
        return path, shape

    def _value_before_path(self, expr: ast.Expr, shape: Shape, path: list[int | Text]) -> str:
        """The value's operations come after the indices' own: put such indices aside."""
        position = self.emitter.position()
        text = self.expressions.value(expr, shape)
        if self.emitter.position() > position:
            for k, step in enumerate(path):
                if isinstance(step, Text) and not step.is_fixed:
                    path[k] = self.expressions.put_aside(step, position)
                    position += 1
        if 0 in shape.dims or 0 in text.shape.dims:
            return f"_fit({owned(text)}, {self.program.bind('h', shape)})"
        return owned(text)


def _check_assignable(shape: Shape, at: ast.Place) -> None:
    if shape.type.kind is Kind.OPAQUE or shape.type.kind is Kind.SIGNAL:
        raise LinkError(at, f"{shape} has no value that can be assigned")
