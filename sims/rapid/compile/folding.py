"""Values of plain literals, without a detour through compiled code."""

from typing import Any

from sims.rapid import ast
from sims.rapid.compile.parts import parts
from sims.rapid.compile.texts import binary_limit, number
from sims.rapid.symbols import LinkError
from sims.rapid.types import BOOL, DNUM, NUM, STRING, Shape
from sims.rapid.values import binary32

__all__ = ["fold"]


def fold(expr: ast.Expr, shape: Shape) -> tuple[bool, Any]:
    """Return (True, value) of an expression of literals only, else (False, None).

    Raises
    ------
    LinkError
        An aggregate that does not fit.
    """
    match expr:
        case ast.Number() if not shape.dims:
            return _number(expr, expr.value, shape)
        case ast.Unary(op="-", operand=ast.Number(value=float(value))) if not shape.dims:
            return _number(expr, -value, shape)
        case ast.StringLiteral() if shape.type is STRING and not shape.dims:
            return True, expr.value
        case ast.BoolLiteral() if shape.type is BOOL and not shape.dims:
            return True, expr.value
        case ast.Aggregate() if shape.is_list:
            values = []
            for item, part in zip(expr.items, parts(shape, len(expr.items), expr.at), strict=True):
                done, value = fold(item, part)
                if not done:
                    return False, None
                values.append(value)
            return True, values
        case _:
            return False, None


def _number(expr: ast.Expr, value: float, shape: Shape) -> tuple[bool, Any]:
    if shape.type is DNUM:
        return True, value
    if shape.type is not NUM:
        raise LinkError(expr.at, f"a value of {shape} is needed, this is a number")
    binary_limit(number(value, expr.at), expr.at)
    return True, binary32(value)
