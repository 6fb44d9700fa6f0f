"""Between values and their text."""

import math

from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.errors import RapidError
from sims.rapid.formats import fixed_text, text_to_value, value_text

__all__: list[str] = []

_MAX = 80
_BASES = {"hex": (16, "02X"), "okt": (8, "03o"), "bin": (2, "08b")}


def _bounded(name: str, text: str) -> str:
    if len(text) > _MAX:
        raise RapidError("ERR_STRTOOLNG", f"{name}: {len(text)} characters, {_MAX} are possible")
    return text


def _fixed(name: str, value: float, dec: float, has_exponent: bool) -> str:
    if dec != math.trunc(dec) or not 0 <= dec <= 15:
        raise RapidError("ERR_ARGVALERR", f"{name}: {dec:g} decimals; 0 to 15 are possible")
    return _bounded(name, fixed_text(value, int(dec), has_exponent=has_exponent))


@builtin("FUNC string NumToStr(num Val, num Dec \\switch Exp)")
def num_to_str(task: TaskContext, *, val: float, dec: float, exp: bool = False) -> str:
    r"""Fixed decimals, or with an exponent for ``\Exp``."""
    del task
    return _fixed("NumToStr", val, dec, exp)


@builtin("FUNC string DnumToStr(dnum Val, num Dec \\switch Exp)")
def dnum_to_str(task: TaskContext, *, val: float, dec: float, exp: bool = False) -> str:
    r"""Fixed decimals, or with an exponent for ``\Exp``."""
    del task
    return _fixed("DnumToStr", val, dec, exp)


@builtin("FUNC string ValToStr(REF anytype Val)")
def val_to_str(task: TaskContext, *, val: Ref) -> str:
    """Any value as text. ERR_STRTOOLNG: over 80 characters."""
    del task
    try:
        text = value_text(val.get(), is_dnum=val.base == "dnum")
    except TypeError:
        raise RapidError("ERR_ARGVALERR", f"a {val.type} has no text", is_fatal=True) from None
    return _bounded("ValToStr", text)


@builtin("FUNC bool StrToVal(string Str, INOUT anytype Val)")
def str_to_val(task: TaskContext, *, str_: str, val: Ref) -> bool:
    """Read text into data of any type; FALSE, and the data as it was, when it is no such value."""
    del task
    value = text_to_value(str_, val.get())
    if value is None:
        return False
    try:
        val.set(value)
    except RapidError:
        return False
    return True


@builtin("FUNC byte StrToByte(string ConStr \\switch Hex | switch Okt | switch Bin | switch Char)")
def str_to_byte(
    task: TaskContext,
    *,
    constr: str,
    hex_: bool = False,
    okt: bool = False,
    bin_: bool = False,
    char: bool = False,
) -> float:
    """Text of a byte, decimal unless a switch says otherwise. ERR_INT_NOTVAL: it is none."""
    del task
    if char:
        if len(constr) != 1:
            raise RapidError("ERR_INT_NOTVAL", f"StrToByte: {constr!r} is not one character")
        return float(ord(constr))
    base = 16 if hex_ else 8 if okt else 2 if bin_ else 10
    try:
        value = int(constr, base) if constr.isalnum() and constr.isascii() else -1
    except ValueError:
        value = -1
    if not 0 <= value <= 255:
        raise RapidError("ERR_INT_NOTVAL", f"StrToByte: {constr!r} is no byte in base {base}")
    return float(value)


@builtin("FUNC string ByteToStr(byte BitData \\switch Hex | switch Okt | switch Bin | switch Char)")
def byte_to_str(
    task: TaskContext,
    *,
    bitdata: float,
    hex_: bool = False,
    okt: bool = False,
    bin_: bool = False,
    char: bool = False,
) -> str:
    """Return a byte as text, decimal unless a switch says otherwise."""
    del task
    if bitdata != math.trunc(bitdata) or not 0 <= bitdata <= 255:
        raise RapidError("ERR_ARGVALERR", f"ByteToStr: {bitdata:g} is not a byte")
    value = int(bitdata)
    if char:
        return chr(value)
    for name, is_asked in (("hex", hex_), ("okt", okt), ("bin", bin_)):
        if is_asked:
            return format(value, _BASES[name][1])
    return str(value)


@builtin("FUNC string DecToHex(string Str)")
def dec_to_hex(task: TaskContext, *, str_: str) -> str:
    """Return a decimal number of 0 to 2147483647 in hexadecimal. ERR_INT_NOTVAL: it is none."""
    del task
    if not (str_.isascii() and str_.isdigit() and int(str_) < 2**31):
        raise RapidError("ERR_INT_NOTVAL", f"DecToHex: {str_!r} is not 0 to 2147483647")
    return format(int(str_), "X")


@builtin("FUNC string HexToDec(string Str)")
def hex_to_dec(task: TaskContext, *, str_: str) -> str:
    """Return a hexadecimal number of 0 to 7FFFFFFF in decimal. ERR_INT_NOTVAL: it is none."""
    del task
    value = int(str_, 16) if str_ and all(c in "0123456789abcdefABCDEF" for c in str_) else -1
    if not 0 <= value < 2**31:
        raise RapidError("ERR_INT_NOTVAL", f"HexToDec: {str_!r} is not 0 to 7FFFFFFF")
    return str(value)
