"""Operators between two values, once both are known."""

from sims.rapid import ast
from sims.rapid.compile.parts import is_record
from sims.rapid.compile.texts import BOOLEAN, NUMBER, TEXT, Text, typed
from sims.rapid.symbols import LinkError
from sims.rapid.types import DNUM, STRING, Kind, Shape

__all__ = ["COMPARISONS", "arithmetic", "as_number", "balanced", "compare"]

COMPARISONS = {"=": "==", "<>": "!=", "<": "<", "<=": "<=", ">": ">", ">=": ">="}
_ARITHMETIC = frozenset("+-*/")


def as_number(text: Text) -> Text:
    """Read a signal's value; leave others."""
    if text.shape.type.kind is Kind.SIGNAL:
        return Text(f"_signal({text.text}).value", NUMBER, depth=text.depth + 1)
    return text


def balanced(left: Text, right: Text, at: ast.Place) -> tuple[Text, Text]:
    """Make literals dnum beside a dnum."""
    if left.shape.type is DNUM and right.number is not None:
        return left, typed(right, left.shape, at)
    if right.shape.type is DNUM and left.number is not None:
        return typed(left, right.shape, at), right
    return left, right


def compare(expr: ast.Binary, left: Text, right: Text, depth: int) -> Text:
    """Return a comparison. Raises ``LinkError``."""
    a, b = left.shape, right.shape
    both_numbers = a.type.is_number and b.type.is_number and not a.dims and not b.dims
    if expr.op not in {"=", "<>"}:
        if not both_numbers:
            raise LinkError(expr.at, f"{expr.op} is for numbers, not for {a} and {b}")
    elif not both_numbers and not a.accepts(b):
        raise LinkError(expr.at, f"{a} and {b} cannot be compared")
    return Text(f"({left.text} {COMPARISONS[expr.op]} {right.text})", BOOLEAN, depth=depth)


def arithmetic(expr: ast.Binary, left: Text, right: Text, depth: int) -> Text:
    """Return a sum, product and so on. Raises ``LinkError``."""
    a, b, op = left.shape, right.shape, expr.op
    if a.type.is_number and b.type.is_number and not a.dims and not b.dims:
        wide = DNUM in {a.type, b.type}
        shape = Shape(DNUM, (), "dnum") if wide else NUMBER
        if op in _ARITHMETIC:
            rounding = "_round64" if wide else "_round"
            text = f"{rounding}({left.text} {op} {right.text})"
        else:
            name = "_div" if op == "DIV" else "_mod"
            text = f"{name}({left.text}, {right.text})"
        return Text(text, shape, depth=depth)
    if op == "+" and a.type is b.type is STRING and not a.dims and not b.dims:
        return Text(f"_join({left.text}, {right.text})", TEXT, depth=depth)
    operator = _vector_operator(op, a, b)
    if operator is None:
        raise LinkError(expr.at, f"{op} is not defined for {a} and {b}")
    shape = b if a.type.is_number else a
    first, second = (right, left) if a.type.is_number else (left, right)
    return Text(f"{operator}({first.text}, {second.text})", shape, is_fresh=True, depth=depth)


def _vector_operator(op: str, a: Shape, b: Shape) -> str | None:
    if is_record(a, "pos") and is_record(b, "pos"):
        return {"+": "_plus", "-": "_minus", "*": "_cross"}.get(op)
    if is_record(a, "orient") and is_record(b, "orient") and op == "*":
        return "_link"
    if is_record(a, "pos") and b.type.is_number and not b.dims and op in "*/":
        return "_scale" if op == "*" else "_shrink"
    if a.type.is_number and not a.dims and is_record(b, "pos") and op == "*":
        return "_scale"
    return None
