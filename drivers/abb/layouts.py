"""How each message lies in a frame's payload: fields, widths, and the units of the wire.

The wire counts in millimetres and degrees, as RAPID does; messages are in SI units.
"""

import math
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from drivers.abb import messages as m

__all__ = ["REPLIES", "REQUESTS", "Field", "Layout", "TextLayout"]

MM = 1000.0
DEG = 180.0 / math.pi
MS = 1000.0


@dataclass(frozen=True)
class Field:
    """``count`` numbers of one struct ``code``; the wire's value is the message's x ``scale``.

    ``kind`` turns a whole number into what the message holds, and refuses what is not one.
    """

    name: str
    code: str
    count: int = 1
    scale: float = 1.0
    kind: Any = None


class Layout:
    """A payload of fixed size."""

    def __init__(self, kind: int, message: type, *fields: Field) -> None:
        self.kind = kind
        self.message = message
        self._fields = fields
        self._struct = struct.Struct(">" + "".join(f.code * f.count for f in fields))

    def encode(self, message: Any) -> bytes:
        """Raises ``ValueError`` for what does not fit."""
        try:
            return self._struct.pack(*self._numbers(message))
        except (struct.error, OverflowError, TypeError) as error:
            raise ValueError(f"{message} does not fit the wire: {error}") from error

    def decode(self, payload: bytes) -> Any:
        """Raises ``ValueError`` for what makes no sense."""
        if len(payload) != self._struct.size:
            raise ValueError(f"{len(payload)} bytes of payload instead of {self._struct.size}")
        numbers = self._struct.unpack(payload)
        if not all(map(math.isfinite, numbers)):
            raise ValueError("a number is not finite")
        return self.message(*self._values(numbers))

    def _numbers(self, message: Any) -> Iterator[float]:
        for field in self._fields:
            value = getattr(message, field.name)
            values = value if field.count > 1 else (value,)
            if len(values) != field.count:
                raise ValueError(f"{field.name} needs {field.count} numbers")
            for number in values:
                if field.code == "f":
                    if not math.isfinite(number):
                        raise ValueError(f"{field.name} is not finite: {number}")
                    yield number * field.scale
                else:
                    yield round(number * field.scale)

    def _values(self, numbers: Sequence[float]) -> Iterator[Any]:
        at = 0
        for field in self._fields:
            if field.count == 1:
                value = numbers[at]
                if field.kind is not None:
                    yield field.kind(value)
                else:
                    yield value if field.scale == 1.0 else value / field.scale
            else:
                part = numbers[at : at + field.count]
                scale = field.scale
                yield part if scale == 1.0 else tuple([value / scale for value in part])
            at += field.count


class TextLayout:
    """Texts with their lengths; ``counts``: the first bytes say how many there are of each."""

    def __init__(self, kind: int, message: type, names: tuple[str, ...], *, counts: bool) -> None:
        self.kind = kind
        self.message = message
        self._names = names
        self._counts = counts

    def encode(self, message: Any) -> bytes:
        """Raises ``ValueError`` for what does not fit."""
        values = [getattr(message, name) for name in self._names]
        lists = values if self._counts else [(value,) for value in values]
        head = bytes(map(len, lists)) if self._counts else b""
        texts = [text.encode("latin-1") for texts in lists for text in texts]
        return head + b"".join(bytes([len(text)]) + text for text in texts)

    def decode(self, payload: bytes) -> Any:
        """Raises ``ValueError`` for what makes no sense."""
        size = len(self._names)
        counts = payload[:size] if self._counts else bytes([1] * size)
        rest = payload[size:] if self._counts else payload
        if len(counts) != size:
            raise ValueError("the counts of texts are cut off")
        values: list[Any] = []
        for count in counts:
            texts = []
            for _ in range(count):
                if not rest or len(rest) < 1 + rest[0]:
                    raise ValueError("a text is cut off")
                texts.append(rest[1 : 1 + rest[0]].decode("latin-1"))
                rest = rest[1 + rest[0] :]
            values.append(tuple(texts) if self._counts else texts[0])
        if rest:
            raise ValueError(f"{len(rest)} bytes too many")
        return self.message(*values)


def _pose(position: str = "position_m", quaternion: str = "quaternion") -> tuple[Field, Field]:
    return Field(position, "f", 3, MM), Field(quaternion, "f", 4)


_CONF = Field("conf", "b", 4)
_WAY = (Field("speed_mps", "f", 1, MM), Field("zone_m", "f", 1, MM))
_LOAD = (Field("mass_kg", "f"), Field("centre_m", "f", 3, MM))
_VERSION = (Field("major", "B"), Field("minor", "B"), Field("epoch", "i"))

REQUESTS: tuple[Layout | TextLayout, ...] = (
    Layout(1, m.Hello, *_VERSION),
    Layout(2, m.Identify),
    Layout(
        16,
        m.AddJoint,
        Field("joints_rad", "f", 6, DEG),
        Field("share", "f"),
        Field("zone_m", "f", 1, MM),
    ),
    Layout(17, m.AddLinear, *_pose(), _CONF, *_WAY),
    Layout(18, m.AddCircular, *_pose("via_m", "via_quaternion"), *_pose(), _CONF, *_WAY),
    Layout(19, m.Run, Field("id", "i"), Field("count", "H"), Field("tick", "i")),
    Layout(20, m.Drop),
    Layout(32, m.SetTool, *_pose(), *_LOAD),
    Layout(33, m.SetWorkObject, *_pose()),
    Layout(34, m.SetLoad, *_LOAD),
    Layout(35, m.SetAcceleration, Field("percent", "f"), Field("ramp_percent", "f")),
    Layout(48, m.AskState),
    Layout(49, m.Stop),
    Layout(50, m.Ping),
    Layout(64, m.AskSignals),
    Layout(65, m.Write, Field("which", "B"), Field("value", "B")),
    Layout(66, m.Pulse, Field("which", "B"), Field("duration_s", "f")),
    Layout(
        67,
        m.WaitFor,
        Field("is_output", "B"),
        Field("which", "B"),
        Field("value", "B"),
        Field("timeout_s", "f"),
    ),
)

REPLIES: tuple[Layout | TextLayout, ...] = (
    Layout(129, m.Welcome, *_VERSION, Field("queue", "H"), Field("watchdog_s", "H", 1, MS)),
    TextLayout(130, m.IdentityReply, ("robot_type", "serial", "version"), counts=False),
    Layout(144, m.Accepted, Field("value", "i")),
    Layout(
        145,
        m.Outcome,
        Field("result", "B", kind=m.Result),
        Field("code", "H", kind=m.Code),
        Field("id", "i"),
        Field("at", "H"),
    ),
    Layout(146, m.Refused, Field("code", "H", kind=m.Code), Field("at", "H")),
    Layout(
        176,
        m.ControllerState,
        Field("turns", "H"),
        Field("time_s", "f"),
        Field("flags", "H", kind=m.Flag),
        Field("hold", "H", kind=m.Code),
        Field("tick", "i"),
        Field("active", "i"),
        Field("joints_rad", "f", 6, DEG),
        *_pose(),
        Field("inputs", "H"),
        Field("outputs", "H"),
    ),
    TextLayout(192, m.SignalNames, ("inputs", "outputs"), counts=True),
)
