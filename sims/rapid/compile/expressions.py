"""Expressions to Python text.

Calls that may take time (routines of the program, built-ins that wait) are operations of their
own before the one they stand in; their results are temporaries. The order is that of the
source, from left to right, and the right operand of AND and OR is evaluated only if it matters.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from sims.rapid import ast
from sims.rapid.compile.emitter import Emitter
from sims.rapid.compile.operators import (
    COMPARISONS,
    arithmetic,
    as_number,
    balanced,
    compare,
)
from sims.rapid.compile.parts import component, indexed, is_record, parts, unfold
from sims.rapid.compile.scope import Local, RoutineScope
from sims.rapid.compile.texts import BOOLEAN, NUMBER, TEXT, Text, literal, number, owned, typed
from sims.rapid.data import Cell
from sims.rapid.symbols import Datum, LinkError
from sims.rapid.types import DNUM, Kind, Shape

__all__ = ["Expressions"]

MAX_DEPTH = 24


class Expressions(ABC):
    """Writes expressions for one routine; calls are added by ``Arguments``."""

    def __init__(self, scope: RoutineScope, emitter: Emitter) -> None:
        self.scope = scope
        self.emitter = emitter
        self.program = scope.module.program

    # Values.

    def value(self, expr: ast.Expr, expected: Shape | None = None) -> Text:
        """Return a value, checked against ``expected``. Raises ``LinkError``."""
        match expr:
            case ast.Number():
                text = number(expr.value, expr.at)
            case ast.StringLiteral():
                text = Text(literal(expr.value), TEXT, is_fixed=True)
            case ast.BoolLiteral():
                text = Text(str(expr.value), BOOLEAN, is_fixed=True)
            case ast.Name():
                text = self._name(expr)
            case ast.Aggregate():
                return self._aggregate(expr, expected)
            case ast.Field() | ast.Index():
                text = self._part(expr)
            case ast.Unary():
                text = self._unary(expr, expected)
            case ast.Binary():
                text = self._binary(expr, expected)
            case ast.Call():
                text = self.call(expr)
        return typed(self.shallow(text), expected, expr.at)

    def kept(self, expr: ast.Expr, expected: Shape | None = None) -> str:
        """Return the text of a value that may be stored."""
        return owned(self.value(expr, expected))

    def condition(self, expr: ast.Expr) -> Text:
        """Return a bool; a digital signal or a number counts as TRUE when it is not 0."""
        text = self.value(expr)
        if text.shape.type.kind is Kind.SIGNAL:
            text = typed(text, NUMBER, expr.at)
            return replace(text, text=f"({text.text} != 0.0)", shape=BOOLEAN)
        return typed(text, BOOLEAN, expr.at)

    def ordered(self, makers: Sequence[Callable[[], Text]]) -> list[Text]:
        """Evaluate from left to right: what stands before an operation is put aside."""
        made: list[Text] = []
        for maker in makers:
            position = self.emitter.position()
            text = maker()
            if self.emitter.position() > position:
                for k, earlier in enumerate(made):
                    if not earlier.is_fixed:
                        made[k] = self.put_aside(earlier, position)
                        position += 1
            made.append(text)
        return made

    def put_aside(self, text: Text, before: int | None = None) -> Text:
        """Evaluate now, into a temporary."""
        slot = self.emitter.temporary()
        self.emitter.operation(f"{slot} = {owned(text)}", "return @next", before=before)
        return Text(slot, text.shape, is_fresh=text.shape.is_list, is_fixed=True)

    def shallow(self, text: Text) -> Text:
        """Keep Python's nesting bounded."""
        return self.put_aside(text) if text.depth > MAX_DEPTH else text

    # Names and parts.

    def _name(self, expr: ast.Name) -> Text:
        name = expr.name.lower()
        local = self.scope.find_local(name)
        if local is not None:
            return self.read_local(local)
        datum = self.scope.find_data(name)
        if datum is not None:
            return self._read_datum(datum)
        signal = self.scope.module.find_signal(name)
        if signal is not None:
            kind = self.program.types.find(f"signal{signal.kind.value.lower()}")
            assert kind is not None
            bound = self.program.bind("q", signal)
            return Text(bound, Shape(kind, (), kind.name), is_fixed=True)
        raise LinkError(
            expr.at, f"{expr.name} is not known: declare it, load its module or add the signal"
        )

    def read_local(self, local: Local) -> Text:
        """Return the value of a routine's data."""
        slot = f"f[{local.slot}]"
        if local.is_boxed or local.is_reference:
            return Text(f"{slot}.value", local.shape)
        if local.is_optional and local.shape.type.kind is not Kind.SWITCH:
            return Text(f"_given({slot})", local.shape, depth=1)
        shape = BOOLEAN if local.shape.type.kind is Kind.SWITCH else local.shape
        return Text(slot, shape, is_fixed=local.is_constant)

    def _read_datum(self, datum: Datum) -> Text:
        cell = datum.cell
        if datum.decl.kind is ast.DataKind.CONST:
            return self._constant(cell)
        return Text(f"{self.program.bind_cell(cell)}.value", cell.shape)

    def _constant(self, cell: Cell) -> Text:
        shape = cell.shape
        if shape.is_list:
            return Text(f"{self.program.bind_cell(cell)}.value", shape, is_fixed=True)
        if shape.type.is_number:
            # A constant of type num stays one; only literals may become a dnum.
            return Text(literal(cell.value), shape, is_fixed=True)
        return Text(literal(cell.value), shape, is_fixed=True)

    def _part(self, expr: ast.Field | ast.Index) -> Text:
        steps, base_expr = unfold(expr)
        base = self.value(base_expr)
        text, shape, depth, fixed = base.text, base.shape, base.depth, base.is_fixed
        for step in steps:
            if isinstance(step, ast.Field):
                k, shape = component(shape, step)
                text = f"{text}[{k}]"
                continue
            shape = indexed(shape, step)
            for index in step.indices:
                position = self.emitter.position()
                inner = self.value(index, NUMBER) if index is not None else number(0, step.at)
                if self.emitter.position() > position:
                    slot = self.emitter.temporary()
                    self.emitter.operation(f"{slot} = {text}", "return @next", before=position)
                    text, depth = slot, 0
                text = f"_element({text}, {inner.text})"
                depth = max(depth, inner.depth) + 1
                fixed = False
        return Text(text, shape, is_fixed=fixed and not shape.is_list, depth=depth)

    # Aggregates.

    def _aggregate(self, expr: ast.Aggregate, expected: Shape | None) -> Text:
        if expected is None or expected.type.kind is Kind.ANY:
            raise LinkError(expr.at, "what [...] means is not clear here: assign it to data first")
        shapes = parts(expected, len(expr.items), expr.at)
        makers = [
            partial(self._owned, item, shape)
            for item, shape in zip(expr.items, shapes, strict=True)
        ]
        items = self.ordered(makers)
        text = "[" + ", ".join(item.text for item in items) + "]"
        depth = 1 + max((item.depth for item in items), default=0)
        return self.shallow(Text(text, expected, is_fresh=True, depth=depth))

    def _owned(self, expr: ast.Expr, shape: Shape) -> Text:
        text = self.value(expr, shape)
        return replace(text, text=owned(text), is_fresh=True)

    # Operators.

    def _unary(self, expr: ast.Unary, expected: Shape | None) -> Text:
        if expr.op == "NOT":
            inner = self.condition(expr.operand)
            return Text(f"(not {inner.text})", BOOLEAN, depth=inner.depth + 1)
        inner = self.value(expr.operand, expected if isinstance(expr.operand, ast.Number) else None)
        inner = as_number(inner)
        if inner.number is not None:
            value = -inner.number if expr.op == "-" else inner.number
            return number(value, expr.at)
        if expr.op == "+" and inner.shape.type.is_number:
            return inner
        if inner.shape.type.is_number and not inner.shape.dims:
            return Text(f"(-{inner.text})", inner.shape, depth=inner.depth + 1)
        if is_record(inner.shape, "pos") and expr.op == "-":
            return Text(f"_scale({inner.text}, -1.0)", inner.shape, True, depth=inner.depth + 1)
        raise LinkError(expr.at, f"{expr.op} is not defined for {inner.shape}")

    def _binary(self, expr: ast.Binary, expected: Shape | None) -> Text:
        chain: list[ast.Binary] = []
        node: ast.Expr = expr
        while isinstance(node, ast.Binary):
            chain.append(node)
            node = node.left
        numeric = expected if expected is not None and expected.type is DNUM else None
        left = self._first(node, chain[-1], numeric)
        for link in reversed(chain):
            left = self.shallow(self._combine(link, left))
        return left

    def _first(self, node: ast.Expr, link: ast.Binary, expected: Shape | None) -> Text:
        if link.op in {"AND", "OR", "XOR"}:
            return self.condition(node)
        if isinstance(node, ast.Aggregate):
            is_compared = link.op in COMPARISONS
            return self.value(
                node, self._shape_of(link.right) if is_compared else self._vector(node)
            )
        return self.value(node, expected if isinstance(node, ast.Number) else None)

    def _shape_of(self, expr: ast.Expr) -> Shape:
        position = self.emitter.position()
        shape = self.value(expr).shape
        self.emitter.cut(position)
        return shape

    def _vector(self, node: ast.Aggregate) -> Shape:
        """What can be calculated with: a pos, or an orient of four."""
        name = "orient" if len(node.items) == 4 else "pos"
        return self.scope.module.shape(name, (), node.at)

    def _combine(self, expr: ast.Binary, left: Text) -> Text:
        if expr.op in {"AND", "OR"}:
            return self._logic(expr, left)
        position = self.emitter.position()
        if expr.op == "XOR":
            right = self.condition(expr.right)
        elif isinstance(expr.right, ast.Aggregate):
            shape = left.shape if expr.op in COMPARISONS else self._vector(expr.right)
            right = self.value(expr.right, shape)
        else:
            right = self.value(expr.right)
        if self.emitter.position() > position and not left.is_fixed:
            left = self.put_aside(left, position)
        depth = max(left.depth, right.depth) + 2
        if expr.op == "XOR":
            return Text(f"({left.text} != {right.text})", BOOLEAN, depth=depth)
        left, right = balanced(as_number(left), as_number(right), expr.at)
        if expr.op in COMPARISONS:
            return compare(expr, left, right, depth)
        return arithmetic(expr, left, right, depth)

    def _logic(self, expr: ast.Binary, left: Text) -> Text:
        position = self.emitter.position()
        right = self.condition(expr.right)
        word = expr.op.lower()
        if self.emitter.position() == position:
            depth = max(left.depth, right.depth) + 1
            return Text(f"({left.text} {word} {right.text})", BOOLEAN, depth=depth)
        slot, end = self.emitter.temporary(), self.emitter.label()
        go_on, stop = ("@next", f"@{end.number}@")
        if expr.op == "OR":
            go_on, stop = stop, go_on
        self.emitter.operation(
            f"{slot} = {left.text}", f"return {go_on} if {slot} else {stop}", before=position
        )
        self.emitter.operation(f"{slot} = {right.text}", "return @next")
        self.emitter.place(end)
        return Text(slot, BOOLEAN, is_fixed=True)

    @abstractmethod
    def call(self, expr: ast.Call) -> Text:
        """Return what a function gives."""
