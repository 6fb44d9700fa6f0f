"""Files: open, write and read them. Text is Latin-1, a line ends with a line feed."""

import math
from typing import Any

from sims.rapid.builtin import Ref, TaskContext, builtin, opaque
from sims.rapid.disk import Device, locate
from sims.rapid.errors import RapidError
from sims.rapid.formats import number_text, text_to_value, value_text
from sims.rapid.library.rawbytes import MAX_RAWBYTES

__all__ = ["device_of"]

_MAX_STRING = 80
_EOF_TEXT = "EOF"
_EOF_NUM = 9998.0
_EOF_BIN = -1.0

opaque("iodev")


def device_of(iodevice: Ref) -> Device:
    """The open file behind an iodev. ERR_FILEACC."""
    device = iodevice.get()
    if not isinstance(device, Device) or not device.is_open:
        raise RapidError("ERR_FILEACC", f"{iodevice.name} is not open")
    return device


@builtin(
    "PROC Open(string Object \\string File, VAR iodev IODevice "
    "\\switch Read | switch Write | switch Append \\switch Bin)"
)
def open_(
    task: TaskContext,
    *,
    object_: str,
    file: str | None = None,
    iodevice: Ref,
    read: bool = False,
    write: bool = False,
    append: bool = False,
    bin_: bool = False,
) -> None:
    """Open a file below HOME:, for writing unless a switch says otherwise."""
    del write, bin_
    before = iodevice.get()
    if isinstance(before, Device) and before.is_open:
        raise RapidError("ERR_FILEOPEN", f"{iodevice.name} is open already: Close it first")
    path = locate(task.host, object_, file or "")
    iodevice.set(Device(path, "r" if read else "a" if append else "w"))


@builtin("PROC Close(VAR iodev IODevice)")
def close(task: TaskContext, *, iodevice: Ref) -> None:
    """Close; harmless when closed."""
    del task
    device = iodevice.get()
    if isinstance(device, Device):
        device.close()


@builtin("PROC Rewind(VAR iodev IODevice)")
def rewind(task: TaskContext, *, iodevice: Ref) -> None:
    """Go to the beginning, to read."""
    del task
    device_of(iodevice).rewind()


@builtin("PROC ClearIOBuff(VAR iodev IODevice)")
def clear_io_buff(task: TaskContext, *, iodevice: Ref) -> None:
    """Forget what waits; a file has nothing waiting."""
    del task
    device_of(iodevice)


@builtin(
    "PROC Write(VAR iodev IODevice, string String \\num Num | bool Bool | pos Pos | orient Orient "
    "| dnum Dnum \\switch NoNewLine)"
)
def write_(
    task: TaskContext,
    *,
    iodevice: Ref,
    string: str,
    num: float | None = None,
    bool_: bool | None = None,
    pos: list[float] | None = None,
    orient: list[float] | None = None,
    dnum: float | None = None,
    nonewline: bool = False,
) -> None:
    """Write text, then a value, then the end of the line."""
    del task
    text = string
    value: Any
    for value in (num, bool_, pos, orient):
        if value is not None:
            text += value_text(value)
    if dnum is not None:
        text += number_text(dnum, is_dnum=True)
    device_of(iodevice).write((text + ("" if nonewline else "\n")).encode("latin-1", "replace"))


@builtin("PROC WriteBin(VAR iodev IODevice, num Buffer{*}, num NChar)")
def write_bin(task: TaskContext, *, iodevice: Ref, buffer: list[float], nchar: float) -> None:
    """Write the first numbers of an array as bytes."""
    del task
    count = _whole("WriteBin", nchar, len(buffer))
    if any(value not in range(256) for value in buffer[:count]):
        raise RapidError("ERR_ARGVALERR", "WriteBin: the numbers have to be 0 to 255")
    device_of(iodevice).write(bytes(int(value) for value in buffer[:count]))


@builtin("PROC WriteStrBin(VAR iodev IODevice, string Str)")
def write_str_bin(task: TaskContext, *, iodevice: Ref, str_: str) -> None:
    """Write characters and nothing more."""
    del task
    device_of(iodevice).write(str_.encode("latin-1", "replace"))


@builtin("PROC WriteRawBytes(VAR iodev IODevice, VAR rawbytes RawData \\num NoOfBytes)")
def write_raw_bytes(
    task: TaskContext, *, iodevice: Ref, rawdata: Ref, noofbytes: float | None = None
) -> None:
    """Write rawbytes, all or the first of them."""
    del task
    raw = rawdata.get()
    count = len(raw) if noofbytes is None else _whole("WriteRawBytes", noofbytes, len(raw))
    device_of(iodevice).write(bytes(raw[:count]))


@builtin("PROC ReadRawBytes(VAR iodev IODevice, VAR rawbytes RawData \\num NoOfBytes \\num Time)")
def read_raw_bytes(
    task: TaskContext,
    *,
    iodevice: Ref,
    rawdata: Ref,
    noofbytes: float | None = None,
    time: float | None = None,
) -> None:
    """Read up to 1024 bytes. ERR_RANYBIN_EOF: the file ended before; what there was is in."""
    del task, time
    wanted = MAX_RAWBYTES
    if noofbytes is not None:
        wanted = _whole("ReadRawBytes", noofbytes, MAX_RAWBYTES)
    data = device_of(iodevice).read(wanted)
    rawdata.get()[:] = data
    if len(data) < wanted and (noofbytes is not None or not data):
        raise RapidError("ERR_RANYBIN_EOF", f"the file ended after {len(data)} of {wanted} bytes")


@builtin("FUNC num ReadBin(VAR iodev IODevice \\num Time)")
def read_bin(task: TaskContext, *, iodevice: Ref, time: float | None = None) -> float:
    """One byte; EOF_BIN at the end."""
    del task, time
    data = device_of(iodevice).read(1)
    return float(data[0]) if data else _EOF_BIN


@builtin("FUNC string ReadStrBin(VAR iodev IODevice, num NoOfChars \\num Time)")
def read_str_bin(
    task: TaskContext, *, iodevice: Ref, noofchars: float, time: float | None = None
) -> str:
    """Read up to 80 characters; EOF at the end."""
    del task, time
    count = _whole("ReadStrBin", noofchars, _MAX_STRING)
    data = device_of(iodevice).read(count)
    return data.decode("latin-1") if data or not count else _EOF_TEXT


@builtin(
    "FUNC string ReadStr(VAR iodev IODevice \\string Delim \\switch RemoveCR "
    "\\switch DiscardHeaders \\num Time)"
)
def read_str(
    task: TaskContext,
    *,
    iodevice: Ref,
    delim: str | None = None,
    removecr: bool = False,
    discardheaders: bool = False,
    time: float | None = None,
) -> str:
    """Read a line or up to a delimiter, at most 80 characters; EOF at the end."""
    del task, time
    line = _line(device_of(iodevice), delim or "", discardheaders)
    if line is None:
        return _EOF_TEXT
    return line.removesuffix("\r") if removecr else line


@builtin("FUNC num ReadNum(VAR iodev IODevice \\string Delim \\num Time)")
def read_num(
    task: TaskContext, *, iodevice: Ref, delim: str | None = None, time: float | None = None
) -> float:
    """Read a line or up to a delimiter as a number; EOF_NUM at the end. ERR_RCVDATA: it is none."""
    del task, time
    line = _line(device_of(iodevice), delim or "", False)
    if line is None:
        return _EOF_NUM
    value = text_to_value(line.strip(), 0.0)
    if value is None:
        raise RapidError("ERR_RCVDATA", f"{line[:24]!r} is not a number")
    return float(value)


def _line(device: Device, delimiters: str, skips_leading: bool) -> str | None:
    ends = set(("\n" + delimiters).encode("latin-1", "replace"))
    chunk = device.read(_MAX_STRING + 1)
    while skips_leading and chunk and chunk[0] in ends:
        chunk = chunk[1:] + device.read(1)
    if not chunk:
        return None
    end = next((k for k, byte in enumerate(chunk) if byte in ends), None)
    taken = min(len(chunk), _MAX_STRING) if end is None else end + 1
    if taken < len(chunk):
        device.unread(len(chunk) - taken)
    return chunk[: taken if end is None else end].decode("latin-1")


def _whole(name: str, value: float, most: int) -> int:
    if value != math.trunc(value) or not 0 <= value <= most:
        raise RapidError("ERR_ARGVALERR", f"{name}: {value:g}; 0 to {most} are possible")
    return int(value)
