"""Arithmetic on RAPID values as a controller does it: binary32, 80 characters, bounds from 1.

The code that ``sims.rapid.compile`` writes calls these by their short names.
"""

import math
from array import array
from typing import Any

from sims.rapid.errors import RapidError
from sims.rapid.types import Kind, Shape, Type

__all__ = [
    "MAX_STRING",
    "binary32",
    "binary64",
    "concatenate",
    "convert",
    "copy",
    "cross",
    "default",
    "divide_whole",
    "element",
    "link",
    "minus_pos",
    "modulo",
    "plus_pos",
    "position",
    "put",
    "scale",
    "shrink",
]

MAX_STRING = 80

_SINGLE = array("f", [0.0])


def binary32(value: float) -> float:
    """Round to the nearest binary32. ERR_NUM_LIMIT: out of its range."""
    _SINGLE[0] = value
    rounded = _SINGLE[0]
    if rounded - rounded != 0.0:  # infinite, or not a number
        raise RapidError("ERR_NUM_LIMIT", f"{value:g} is out of the range of num")
    return rounded


def binary64(value: float) -> float:
    """A dnum as it is. ERR_NUM_LIMIT: not finite."""
    if value - value != 0.0:
        raise RapidError("ERR_NUM_LIMIT", f"{value:g} is out of the range of dnum")
    return float(value)


def concatenate(left: str, right: str) -> str:
    """``left + right``. ERR_STRTOOLNG: over 80 characters."""
    joined = left + right
    if len(joined) > MAX_STRING:
        raise RapidError("ERR_STRTOOLNG", f"{len(joined)} characters, {MAX_STRING} are possible")
    return joined


def divide_whole(left: float, right: float) -> float:
    """``left DIV right``, towards zero."""
    _check_whole(left, right)
    return float(math.trunc(left / right)) if abs(left) < 2**52 else float(int(left) // int(right))


def modulo(left: float, right: float) -> float:
    """``left MOD right``, with the sign of ``left``."""
    _check_whole(left, right)
    return math.fmod(left, right)


def _check_whole(left: float, right: float) -> None:
    if right == 0.0:
        raise RapidError("ERR_DIVZERO", "division by zero")
    if left != math.floor(left) or right != math.floor(right):
        raise RapidError("ERR_ARGVALERR", f"{left:g} and {right:g} must be whole for DIV and MOD")


# Lists.


def position(items: list[Any], index: float) -> int:
    """The place in a list of an index that counts from 1. ERR_OUTOFBND."""
    k = int(index)
    if k != index or not 0 < k <= len(items):
        raise RapidError("ERR_OUTOFBND", f"index {index:g} is not within 1..{len(items)}")
    return k - 1


def element(items: list[Any], index: float) -> Any:
    """``items{index}``. ERR_OUTOFBND."""
    k = int(index)
    if k != index or not 0 < k <= len(items):
        raise RapidError("ERR_OUTOFBND", f"index {index:g} is not within 1..{len(items)}")
    return items[k - 1]


def put(items: list[Any], index: float, value: Any) -> None:
    """``items{index} := value``. ERR_OUTOFBND."""
    k = int(index)
    if k != index or not 0 < k <= len(items):
        raise RapidError("ERR_OUTOFBND", f"index {index:g} is not within 1..{len(items)}")
    items[k - 1] = value


def copy(value: list[Any]) -> list[Any]:
    """A copy of a record or an array with all that is in it."""
    if (value and type(value[0]) is list) or any(type(item) is list for item in value):
        return [copy(item) if type(item) is list else item for item in value]
    return value[:]


# pos and orient.


def plus_pos(left: list[float], right: list[float]) -> list[float]:
    """``pos + pos``."""
    return [binary32(a + b) for a, b in zip(left, right, strict=True)]


def minus_pos(left: list[float], right: list[float]) -> list[float]:
    """``pos - pos``."""
    return [binary32(a - b) for a, b in zip(left, right, strict=True)]


def scale(vector: list[float], factor: float) -> list[float]:
    """``pos * num``."""
    return [binary32(a * factor) for a in vector]


def shrink(vector: list[float], divisor: float) -> list[float]:
    """``pos / num``."""
    return [binary32(a / divisor) for a in vector]


def cross(left: list[float], right: list[float]) -> list[float]:
    """``pos * pos``: the vector product."""
    (a, b, c), (d, e, f) = left, right
    return [binary32(b * f - c * e), binary32(c * d - a * f), binary32(a * e - b * d)]


def link(left: list[float], right: list[float]) -> list[float]:
    """``orient * orient``: one rotation after the other."""
    (a, b, c, d), (e, f, g, h) = left, right
    product = (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    )
    return [binary32(part) for part in product]


# Shapes.


def default(shape: Shape) -> Any:
    """What a variable without an initial value holds."""
    if not shape.dims:
        return _default_of(shape.type)
    inner = Shape(shape.type, shape.dims[1:])
    return [default(inner) for _ in range(shape.dims[0])]


def _default_of(kind: Type) -> Any:
    match kind.kind:
        case Kind.NUM | Kind.DNUM:
            return 0.0
        case Kind.BOOL | Kind.SWITCH:
            return False
        case Kind.STRING:
            return ""
        case Kind.RECORD:
            return [_default_of(part) for _, part in kind.fields]
        case _:
            return kind.make() if kind.make is not None else None


def convert(value: Any, shape: Shape) -> Any:
    """Check a value that came from outside the program against a shape; round and copy it.

    Raises
    ------
    RapidError
        ERR_STRTOOLNG, ERR_NUM_LIMIT; ERR_ARGVALERR when it has another form.
    """
    if shape.dims:
        dim = shape.dims[0]
        if type(value) is not list or (dim and len(value) != dim):
            raise _misfit(value, shape)
        inner = Shape(shape.type, shape.dims[1:])
        return [convert(item, inner) for item in value]
    match shape.type.kind:
        case Kind.NUM | Kind.DNUM:
            if type(value) is not float and type(value) is not int:
                raise _misfit(value, shape)
            return binary32(value) if shape.type.kind is Kind.NUM else binary64(value)
        case Kind.BOOL:
            if type(value) is not bool:
                raise _misfit(value, shape)
        case Kind.STRING:
            if type(value) is not str:
                raise _misfit(value, shape)
            return concatenate(value, "")
        case Kind.RECORD:
            fields = shape.type.fields
            if type(value) not in {list, tuple} or len(value) != len(fields):
                raise _misfit(value, shape)
            return [
                convert(item, Shape(part)) for item, (_, part) in zip(value, fields, strict=True)
            ]
        case _:
            pass
    return value


def _misfit(value: Any, shape: Shape) -> RapidError:
    return RapidError("ERR_ARGVALERR", f"{str(value)[:60]} is not a value of {shape}")
