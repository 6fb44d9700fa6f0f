"""Arithmetic: roots, powers, rounding, trigonometry in degrees; counting instructions."""

import math
from collections.abc import Callable

from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.errors import RapidError

__all__: list[str] = []


def _exact(of: Callable[[float], float], angle_deg: float) -> float:
    """Sine or cosine of degrees, exact at the multiples of 90."""
    value = of(math.radians(math.fmod(angle_deg, 360.0)))
    return float(round(value)) if angle_deg % 90.0 == 0.0 else value


def _tangent(angle_deg: float) -> float:
    return _exact(math.sin, angle_deg) / _exact(math.cos, angle_deg)


_ONE: dict[str, Callable[[float], float]] = {
    "Abs": abs,
    "Exp": math.exp,
    "Sqrt": math.sqrt,
    "Sin": lambda angle: _exact(math.sin, angle),
    "Cos": lambda angle: _exact(math.cos, angle),
    "Tan": _tangent,
    "ASin": lambda value: math.degrees(math.asin(value)),
    "ACos": lambda value: math.degrees(math.acos(value)),
    "ATan": lambda value: math.degrees(math.atan(value)),
}


def _guarded(name: str, of: Callable[..., float], *values: float) -> float:
    try:
        return float(of(*values))
    except ZeroDivisionError:
        raise RapidError("ERR_DIVZERO", f"{name}: division by zero") from None
    except OverflowError:
        raise RapidError("ERR_NUM_LIMIT", f"{name}: the result is out of range") from None
    except (ValueError, TypeError):
        shown = ", ".join(f"{value:g}" for value in values)
        raise RapidError("ERR_ARGVALERR", f"{name}({shown}) is not defined") from None


def _add_one(name: str, of: Callable[[float], float]) -> None:
    @builtin(f"FUNC num {name}(num Value)")
    def _num(task: TaskContext, *, value: float) -> float:
        del task
        return _guarded(name, of, value)

    @builtin(f"FUNC dnum {name}Dnum(dnum Value)")
    def _dnum(task: TaskContext, *, value: float) -> float:
        del task
        return _guarded(name, of, value)


for _name, _function in _ONE.items():
    _add_one(_name, _function)


@builtin("FUNC num Pow(num Base, num Exponent)")
def pow_(task: TaskContext, *, base: float, exponent: float) -> float:
    """Power."""
    del task
    return _guarded("Pow", math.pow, base, exponent)


@builtin("FUNC dnum PowDnum(dnum Base, num Exponent)")
def pow_dnum(task: TaskContext, *, base: float, exponent: float) -> float:
    """Power."""
    del task
    return _guarded("PowDnum", math.pow, base, exponent)


@builtin("FUNC num ATan2(num Y, num X)")
def atan2(task: TaskContext, *, y: float, x: float) -> float:
    """Angle in degrees, -180 to 180."""
    del task
    return math.degrees(math.atan2(y, x))


@builtin("FUNC dnum ATan2Dnum(dnum Y, dnum X)")
def atan2_dnum(task: TaskContext, *, y: float, x: float) -> float:
    """Angle in degrees, -180 to 180."""
    del task
    return math.degrees(math.atan2(y, x))


def _decimals(name: str, dec: float | None) -> int:
    count = 0.0 if dec is None else dec
    if count != math.trunc(count) or not 0 <= count <= 15:
        raise RapidError("ERR_ARGVALERR", f"{name}: {count:g} decimals; 0 to 15 are possible")
    return int(count)


def _round(value: float, decimals: int) -> float:
    scale = 10.0**decimals
    scaled = abs(value) * scale
    if scaled >= 2.0**52 or not math.isfinite(scaled):
        return value
    return math.copysign(math.floor(scaled + 0.5) / scale, value)


def _truncate(value: float, decimals: int) -> float:
    scale = 10.0**decimals
    if abs(value) * scale >= 2.0**52 or not math.isfinite(value * scale):
        return value
    return math.trunc(value * scale) / scale


@builtin("FUNC num Round(num Val \\num Dec)")
def round_(task: TaskContext, *, val: float, dec: float | None = None) -> float:
    """To the nearest, halves away from zero."""
    del task
    return _round(val, _decimals("Round", dec))


@builtin("FUNC dnum RoundDnum(dnum Val \\num Dec)")
def round_dnum(task: TaskContext, *, val: float, dec: float | None = None) -> float:
    """To the nearest, halves away from zero."""
    del task
    return _round(val, _decimals("RoundDnum", dec))


@builtin("FUNC num Trunc(num Val \\num Dec)")
def trunc(task: TaskContext, *, val: float, dec: float | None = None) -> float:
    """Towards zero."""
    del task
    return _truncate(val, _decimals("Trunc", dec))


@builtin("FUNC dnum TruncDnum(dnum Val \\num Dec)")
def trunc_dnum(task: TaskContext, *, val: float, dec: float | None = None) -> float:
    """Towards zero."""
    del task
    return _truncate(val, _decimals("TruncDnum", dec))


@builtin("FUNC num Max(num Value1, num Value2)")
def max_(task: TaskContext, *, value1: float, value2: float) -> float:
    """Return the larger."""
    del task
    return max(value1, value2)


@builtin("FUNC num Min(num Value1, num Value2)")
def min_(task: TaskContext, *, value1: float, value2: float) -> float:
    """Return the smaller."""
    del task
    return min(value1, value2)


@builtin("FUNC dnum NumToDnum(num Value)")
def num_to_dnum(task: TaskContext, *, value: float) -> float:
    """Return the same value."""
    del task
    return value


@builtin("FUNC num DnumToNum(dnum Value \\switch Integer)")
def dnum_to_num(task: TaskContext, *, value: float, integer: bool = False) -> float:
    r"""Round to num. ``\Integer``: ERR_ARGVALERR unless it is a whole number."""
    del task
    if integer and value != math.trunc(value):
        raise RapidError("ERR_ARGVALERR", f"DnumToNum: {value:g} is not a whole number")
    return value


def _count(name: Ref, by: float) -> None:
    value = name.get()
    if isinstance(value, bool) or not isinstance(value, float | int):
        raise RapidError("ERR_ARGVALERR", f"{name.name} is a {name.type}, not a num", is_fatal=True)
    name.set(value + by)


@builtin("PROC Incr(INOUT anytype Name)")
def incr(task: TaskContext, *, name: Ref) -> None:
    """Add 1."""
    del task
    _count(name, 1.0)


@builtin("PROC Decr(INOUT anytype Name)")
def decr(task: TaskContext, *, name: Ref) -> None:
    """Subtract 1."""
    del task
    _count(name, -1.0)


@builtin("PROC Add(INOUT anytype Name, dnum AddValue)")
def add(task: TaskContext, *, name: Ref, addvalue: float) -> None:
    """Add a value."""
    del task
    _count(name, addvalue)


@builtin("PROC Clear(INOUT anytype Name)")
def clear(task: TaskContext, *, name: Ref) -> None:
    """Set to 0."""
    del task
    name.set(0.0)
