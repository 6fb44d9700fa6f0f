r"""``rawbytes``: up to 1024 bytes, written and read as numbers and text.

The value is a ``bytearray``; its length is what RawBytesLen says. Little endian is the rule,
``\Network`` the exception.
"""

import math
import struct

from sims.rapid.builtin import Ref, TaskContext, builtin, opaque
from sims.rapid.errors import RapidError

__all__ = ["MAX_RAWBYTES", "index_in"]

MAX_RAWBYTES = 1024
MAX_STRING = 80

# By the value of the constants USINT to LINT: unsigned are positive, the size is the magnitude.
_INTEGERS = {1.0: "B", 2.0: "H", 4.0: "I", 8.0: "Q", -1.0: "b", -2.0: "h", -4.0: "i", -8.0: "q"}

opaque("rawbytes", bytearray)


def index_in(name: str, raw: bytearray, start: float, *, most: int) -> int:
    """Return a RAPID index as Python's. ERR_OUTOFBND: not 1 to ``most``."""
    if start != math.trunc(start) or not 1 <= start <= most:
        raise RapidError(
            "ERR_OUTOFBND", f"{name}: index {start:g} in rawbytes of {len(raw)}; 1 to {most}"
        )
    return int(start) - 1


@builtin("FUNC num RawBytesLen(VAR rawbytes RawData)")
def raw_bytes_len(task: TaskContext, *, rawdata: Ref) -> float:
    """How many bytes are in."""
    del task
    return float(len(rawdata.get()))


@builtin("PROC ClearRawBytes(VAR rawbytes RawData \\num FromIndex)")
def clear_raw_bytes(task: TaskContext, *, rawdata: Ref, fromindex: float | None = None) -> None:
    """Empty, or cut off from an index on."""
    del task
    raw = rawdata.get()
    begin = 0
    if fromindex is not None:
        begin = index_in("ClearRawBytes", raw, fromindex, most=len(raw) + 1)
    del raw[begin:]


@builtin(
    "PROC CopyRawBytes(VAR rawbytes FromRawData, num FromIndex, VAR rawbytes ToRawData, "
    "num ToIndex \\num NoOfBytes)"
)
def copy_raw_bytes(
    task: TaskContext,
    *,
    fromrawdata: Ref,
    fromindex: float,
    torawdata: Ref,
    toindex: float,
    noofbytes: float | None = None,
) -> None:
    """Copy bytes; all from the index on when no number is given."""
    del task
    source, target = fromrawdata.get(), torawdata.get()
    begin = index_in("CopyRawBytes", source, fromindex, most=max(len(source), 1))
    at = index_in("CopyRawBytes", target, toindex, most=len(target) + 1)
    count = _count("CopyRawBytes", noofbytes, len(source) - begin)
    _write("CopyRawBytes", target, at, bytes(source[begin : begin + count]))


@builtin(
    "PROC PackRawBytes(REF anytype Value, VAR rawbytes RawData \\switch Network, num StartIndex "
    "\\switch Hex1 | inttypes IntX | switch Float4 | switch ASCII)"
)
def pack_raw_bytes(
    task: TaskContext,
    *,
    value: Ref,
    rawdata: Ref,
    network: bool = False,
    startindex: float,
    hex1: bool = False,
    intx: float | None = None,
    float4: bool = False,
    ascii_: bool = False,
) -> None:
    """Write a value at an index, at most one behind the last byte."""
    del task
    raw = rawdata.get()
    at = index_in("PackRawBytes", raw, startindex, most=min(len(raw) + 1, MAX_RAWBYTES))
    given = value.get()
    if isinstance(given, bool) or not isinstance(given, str | float | int):
        raise RapidError("ERR_ARGVALERR", f"PackRawBytes: a {value.type} cannot be packed")
    if isinstance(given, str):
        data = given.encode("latin-1", "replace")
    elif intx is not None:
        data = _integer(given, intx, network)
    elif float4:
        data = _single(given, network)
    elif hex1 or ascii_:
        data = _integer(given, 1.0, network)
    else:
        raise RapidError(
            "ERR_ARGVALERR", "PackRawBytes: say how: \\Hex1, \\IntX, \\Float4 or \\ASCII"
        )
    _write("PackRawBytes", raw, at, data)


@builtin(
    "PROC UnpackRawBytes(VAR rawbytes RawData \\switch Network, num StartIndex, "
    "INOUT anytype Value \\switch Hex1 | inttypes IntX | switch Float4 | num ASCII)"
)
def unpack_raw_bytes(
    task: TaskContext,
    *,
    rawdata: Ref,
    network: bool = False,
    startindex: float,
    value: Ref,
    hex1: bool = False,
    intx: float | None = None,
    float4: bool = False,
    ascii_: float | None = None,
) -> None:
    """Read a value at an index. ERR_OUTOFBND: it would reach behind the last byte."""
    del task
    raw = rawdata.get()
    at = index_in("UnpackRawBytes", raw, startindex, most=max(len(raw), 1))
    order = ">" if network else "<"
    if ascii_ is not None:
        most = MAX_STRING if value.base == "string" else 1
        size = _count("UnpackRawBytes", ascii_, min(most, MAX_RAWBYTES))
        data = _read(raw, at, size)
        is_text = value.base == "string"
        value.set(data.decode("latin-1") if is_text else float(int.from_bytes(data, "big")))
        return
    layout = "B" if hex1 else "f" if float4 else _INTEGERS.get(intx or 0.0)
    if layout is None:
        raise RapidError(
            "ERR_ARGVALERR", "UnpackRawBytes: say how: \\Hex1, \\IntX, \\Float4 or \\ASCII"
        )
    (found,) = struct.unpack(order + layout, _read(raw, at, struct.calcsize(order + layout)))
    value.set(float(found))


def _integer(value: float, kind: float, network: bool) -> bytes:
    layout = _INTEGERS.get(kind)
    if layout is None:
        raise RapidError("ERR_ARGVALERR", f"\\IntX:={kind:g} is no integer type; use USINT to LINT")
    try:
        whole = int(value) if value == math.trunc(value) else None
        if whole is not None:
            return struct.pack((">" if network else "<") + layout, whole)
    except (struct.error, OverflowError, ValueError):
        pass
    raise RapidError("ERR_ARGVALERR", f"{value:g} does not fit an integer of {abs(kind):g} bytes")


def _single(value: float, network: bool) -> bytes:
    try:
        return struct.pack(">f" if network else "<f", value)
    except OverflowError:
        raise RapidError("ERR_ARGVALERR", f"{value:g} does not fit \\Float4") from None


def _count(name: str, given: float | None, most: int) -> int:
    if given is None:
        return most
    if given != math.trunc(given) or not 0 <= given <= most:
        raise RapidError("ERR_OUTOFBND", f"{name}: {given:g} bytes; {most} are possible")
    return int(given)


def _read(raw: bytearray, at: int, size: int) -> bytes:
    if at + size > len(raw):
        raise RapidError(
            "ERR_OUTOFBND", f"UnpackRawBytes: bytes {at + 1} to {at + size} of {len(raw)}"
        )
    return bytes(raw[at : at + size])


def _write(name: str, raw: bytearray, at: int, data: bytes) -> None:
    if at + len(data) > MAX_RAWBYTES:
        raise RapidError(
            "ERR_OUTOFBND", f"{name}: {at + len(data)} bytes; rawbytes hold {MAX_RAWBYTES}"
        )
    raw[at : at + len(data)] = data
