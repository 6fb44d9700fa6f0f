"""Bits of bytes (0 to 255) and of dnums (whole numbers below 2^52)."""

import math
from collections.abc import Callable

from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.errors import RapidError

__all__: list[str] = []

_BYTE_BITS = 8
_DNUM_BITS = 52

_TWO: dict[str, Callable[[int, int], int]] = {
    "BitAnd": lambda a, b: a & b,
    "BitOr": lambda a, b: a | b,
    "BitXOr": lambda a, b: a ^ b,
}

_SHIFT: dict[str, Callable[[int, int], int]] = {
    "BitLSh": lambda value, by: value << by,
    "BitRSh": lambda value, by: value >> by,
}


def _whole(name: str, value: float, bits: int) -> int:
    if value != math.trunc(value) or not 0 <= value < 2**bits:
        raise RapidError(
            "ERR_ARGVALERR", f"{name}: {value:g} is not a whole number from 0 to {2**bits - 1}"
        )
    return int(value)


def _position(name: str, value: float, bits: int) -> int:
    if value != math.trunc(value) or not 1 <= value <= bits:
        raise RapidError("ERR_ARGVALERR", f"{name}: bit {value:g}; 1 to {bits} are possible")
    return int(value)


def _add_family(suffix: str, kind: str, bits: int) -> None:
    def register_two(name: str, of: Callable[[int, int], int]) -> None:
        @builtin(f"FUNC {kind} {name}({kind} BitData1, {kind} BitData2)")
        def _two(task: TaskContext, *, bitdata1: float, bitdata2: float) -> float:
            del task
            return float(of(_whole(name, bitdata1, bits), _whole(name, bitdata2, bits)))

    def register_shift(name: str, of: Callable[[int, int], int]) -> None:
        @builtin(f"FUNC {kind} {name}({kind} BitData, num ShiftSteps)")
        def _shift(task: TaskContext, *, bitdata: float, shiftsteps: float) -> float:
            del task
            by = _position(name, shiftsteps, bits)
            return float(of(_whole(name, bitdata, bits), by) & (2**bits - 1))

    for two, of_two in _TWO.items():
        register_two(two + suffix, of_two)
    for shift, of_shift in _SHIFT.items():
        register_shift(shift + suffix, of_shift)

    @builtin(f"FUNC {kind} BitNeg{suffix}({kind} BitData)")
    def _negated(task: TaskContext, *, bitdata: float) -> float:
        del task
        return float(_whole("BitNeg", bitdata, bits) ^ (2**bits - 1))

    @builtin(f"FUNC bool BitCheck{suffix}({kind} BitData, num BitPos)")
    def _check(task: TaskContext, *, bitdata: float, bitpos: float) -> bool:
        del task
        at = _position("BitCheck", bitpos, bits)
        return bool(_whole("BitCheck", bitdata, bits) >> (at - 1) & 1)


_add_family("", "byte", _BYTE_BITS)
_add_family("Dnum", "dnum", _DNUM_BITS)


def _put(name: str, bitdata: Ref, bitpos: float, is_set: bool) -> None:
    bits = _DNUM_BITS if bitdata.base == "dnum" else _BYTE_BITS
    mask = 1 << (_position(name, bitpos, bits) - 1)
    held = bitdata.get()
    if isinstance(held, bool) or not isinstance(held, float | int):
        raise RapidError("ERR_ARGVALERR", f"{name}: a {bitdata.type} has no bits", is_fatal=True)
    value = _whole(name, held, bits)
    bitdata.set(float(value | mask if is_set else value & ~mask))


@builtin("PROC BitSet(INOUT anytype BitData, num BitPos)")
def bit_set(task: TaskContext, *, bitdata: Ref, bitpos: float) -> None:
    """Set one bit of a byte or dnum; 1 is the lowest."""
    del task
    _put("BitSet", bitdata, bitpos, True)


@builtin("PROC BitClear(INOUT anytype BitData, num BitPos)")
def bit_clear(task: TaskContext, *, bitdata: Ref, bitpos: float) -> None:
    """Clear one bit of a byte or dnum; 1 is the lowest."""
    del task
    _put("BitClear", bitdata, bitpos, False)
