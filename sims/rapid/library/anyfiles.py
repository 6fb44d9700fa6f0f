"""WriteAnyBin and ReadAnyBin: values of any type in files.

What a controller writes is not published: these files are read here only. Each value is its
type's name and the value as JSON, behind their length in four bytes.
"""

import json
from typing import Any

from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.errors import RapidError
from sims.rapid.library.files import device_of

__all__: list[str] = []

_LENGTH = 4
_LONGEST = 4_000_000


@builtin("PROC WriteAnyBin(VAR iodev IODevice, REF anytype Data)")
def write_any_bin(task: TaskContext, *, iodevice: Ref, data: Ref) -> None:
    """Write one value. ERR_ARGVALERR: of a type that cannot be written."""
    del task
    try:
        text = json.dumps([data.base, data.get()]).encode()
    except (TypeError, ValueError, RecursionError):
        raise RapidError("ERR_ARGVALERR", f"WriteAnyBin: a {data.type} has no value") from None
    if len(text) > _LONGEST:
        raise RapidError("ERR_ARGVALERR", f"WriteAnyBin: {data.name} is too large")
    device_of(iodevice).write(len(text).to_bytes(_LENGTH, "little") + text)


@builtin("PROC ReadAnyBin(VAR iodev IODevice, INOUT anytype Data \\num Time)")
def read_any_bin(task: TaskContext, *, iodevice: Ref, data: Ref, time: float | None = None) -> None:
    """Read one value. ERR_RANYBIN_EOF: there is none; ERR_RANYBIN_CHK: it is of another type."""
    del task, time
    device = device_of(iodevice)
    head = device.read(_LENGTH)
    length = int.from_bytes(head, "little")
    text = device.read(length) if length <= _LONGEST else b""
    if len(head) < _LENGTH:
        raise RapidError("ERR_RANYBIN_EOF", "the file has no more values")
    if len(text) < length:
        raise RapidError("ERR_RANYBIN_CHK", "the file ends within a value")
    kind, value = _read(text)
    if kind != data.base:
        raise RapidError("ERR_RANYBIN_CHK", f"the file has a {kind!s:.32}, not a {data.base}")
    data.set(value)


def _read(text: bytes) -> tuple[Any, Any]:
    try:
        kind, value = json.loads(text, parse_int=float)
    except (ValueError, TypeError, RecursionError):
        raise RapidError("ERR_RANYBIN_CHK", "the file was not written by WriteAnyBin") from None
    return kind, value
