"""The ABB codec under fuzz: judged by a second reading of the protocol, not by itself."""

import math
import struct
from collections.abc import Iterator, Sequence
from types import ModuleType
from typing import Any

from drivers.abb import codec as our_codec
from drivers.abb import messages as m
from hal.errors import RemoteProtocolError

__all__ = ["AbbCodec", "CodecError"]

HEADER_BYTES = 8
MAX_PAYLOAD_BYTES = 1016
MAX_SEQ = 8_000_000
MM, DEG, MS = 1e-3, math.pi / 180, 1e-3

# Kind: struct format of the payload, and what each number is worth in SI units.
POSE = [MM] * 3 + [1.0] * 4
LOAD = [1.0] + [MM] * 3
FORMATS: dict[int, tuple[str, list[float]]] = {
    1: ("BBi", [1, 1, 1]),
    2: ("", []),
    16: ("ffffffff", [DEG] * 6 + [1, MM]),
    17: ("fffffffbbbbff", [*POSE, 1, 1, 1, 1, MM, MM]),
    18: ("ffffffffffffffbbbbff", [*POSE, *POSE, 1, 1, 1, 1, MM, MM]),
    19: ("iHi", [1, 1, 1]),
    20: ("", []),
    32: ("fffffffffff", [*POSE, *LOAD]),
    33: ("fffffff", POSE),
    34: ("ffff", LOAD),
    35: ("ff", [1, 1]),
    48: ("", []),
    49: ("", []),
    50: ("", []),
    64: ("", []),
    65: ("BB", [1, 1]),
    66: ("Bf", [1, 1]),
    67: ("BBBf", [1, 1, 1, 1]),
    129: ("BBiHH", [1, 1, 1, 1, MS]),
    144: ("i", [1]),
    145: ("BHiH", [1, 1, 1, 1]),
    146: ("HH", [1, 1]),
    176: ("HfHHiiffffff" + "f" * 7 + "HH", [1, 1, 1, 1, 1, 1, *[DEG] * 6, *POSE, 1, 1]),
}
IDENTITY, SIGNALS = 130, 192
CODES = {code.value for code in m.Code}
# Kind: which numbers must be one of a set.
ENUMS = {145: {0: {1, 2, 3}, 1: CODES}, 146: {0: CODES}, 176: {3: CODES}}
GOOD_REPLY = bytes.fromhex("b190000400000001 00000000")
REPLIES = (129, 130, 144, 145, 146, 176, 192)


class CodecError(AssertionError):
    """The codec read something else than the protocol has, or read it differently when cut."""


class NonsenseError(Exception):
    """The protocol has no meaning for these bytes."""


class AbbCodec:
    """Requests and replies by turns: an input's first byte says which, the second how to cut."""

    name = "abb-codec"
    prefixes: tuple[str, ...] = ()
    modules: Sequence[str] = ("drivers.abb.codec", "drivers.abb.layouts")

    def __init__(self, codec: ModuleType = our_codec) -> None:
        self._codec: Any = codec

    def seeds(self) -> list[bytes]:
        """One good frame of each kind."""
        return [bytes([kind > 128, 3]) + frame for kind, frame in _good_frames()]

    def pieces(self) -> list[bytes]:
        """Frames, headers, odd numbers."""
        frames = [frame for _, frame in _good_frames()]
        heads = [frame[:HEADER_BYTES] for frame in frames]
        numbers = [b"\x7f\x80\0\0", b"\x7f\xc0\0\0", b"\x80\0\0\0", b"\xff\xff", b"\0\0", b"\xb1"]
        return [*frames, *heads, *numbers]

    def run(self, data: bytes) -> None:
        """Read it whole and cut; compare with the protocol, and with what encoding gives."""
        is_reply = bool(data[:1] and data[0] & 1)
        size = data[1] % 13 + 1 if len(data) > 1 else 1
        stream = data[2:]
        wanted = list(reference(stream, is_reply=is_reply))
        whole = list(self._read([stream], is_reply))
        cut = list(
            self._read([stream[k : k + size] for k in range(0, len(stream), size)], is_reply)
        )
        if cut != whole:
            raise CodecError(f"cut every {size} bytes it reads {cut}, whole {whole}")
        if len(whole) != len(wanted):
            raise CodecError(f"it reads {whole}, the protocol {wanted}")
        at = 0
        for got, want in zip(whole, wanted, strict=True):
            if isinstance(got, str) or isinstance(want, str):
                if not (isinstance(got, str) and isinstance(want, str)):
                    raise CodecError(f"it reads {got}, the protocol {want}")
                return
            seq, numbers, length = want
            _compare(got, seq, numbers)
            again = self._codec.encode(got.seq, got.message)
            if again != stream[at : at + length]:
                raise CodecError(f"{got} is encoded as {again.hex()}")
            at += length

    def _read(self, pieces: list[bytes], is_reply: bool) -> Iterator[Any]:
        make = self._codec.reply_decoder if is_reply else self._codec.request_decoder
        decoder = make()
        for piece in pieces:
            decoder.feed(piece)
            try:
                while (frame := decoder.next_frame()) is not None:
                    yield frame
            except RemoteProtocolError as error:
                yield str(error)
                self._check_final(decoder)
                return

    def _check_final(self, decoder: Any) -> None:
        decoder.feed(GOOD_REPLY)
        try:
            frame = decoder.next_frame()
        except RemoteProtocolError:
            return
        raise CodecError(f"after an error it goes on with {frame}")


def reference(stream: bytes, *, is_reply: bool) -> Iterator[tuple[int, list[Any], int] | str]:
    """Read a stream by the protocol: (seq, values, length) a frame, or a text at an error."""
    at = 0
    while at < len(stream):
        try:
            frame = _reference_frame(stream[at:], is_reply)
        except NonsenseError as error:
            yield str(error)
            return
        if frame is None:
            return
        at += frame[2]
        yield frame


def _reference_frame(rest: bytes, is_reply: bool) -> tuple[int, list[Any], int] | None:
    if rest[0] != 0xB1:
        raise NonsenseError("magic")
    if len(rest) < HEADER_BYTES:
        return None
    kind = rest[1]
    size, seq = int.from_bytes(rest[2:4], "big"), int.from_bytes(rest[4:8], "big", signed=True)
    is_known = kind in FORMATS or kind in (IDENTITY, SIGNALS)
    if not is_known or (kind in REPLIES) is not is_reply:
        raise NonsenseError("kind")
    if size > MAX_PAYLOAD_BYTES or not 0 <= seq <= MAX_SEQ:
        raise NonsenseError("size")
    if len(rest) < HEADER_BYTES + size:
        return None
    payload = rest[HEADER_BYTES : HEADER_BYTES + size]
    values = _texts(kind, payload) if kind in (IDENTITY, SIGNALS) else _numbers(kind, payload)
    return seq, values, HEADER_BYTES + size


def _numbers(kind: int, payload: bytes) -> list[Any]:
    format_, worth = FORMATS[kind]
    if struct.calcsize(">" + format_) != len(payload):
        raise NonsenseError("length")
    numbers = struct.unpack(">" + format_, payload)
    if not all(math.isfinite(number) for number in numbers):
        raise NonsenseError("not finite")
    for index, allowed in ENUMS.get(kind, {}).items():
        if numbers[index] not in allowed:
            raise NonsenseError("enum")
    return [number * scale for number, scale in zip(numbers, worth, strict=True)]


def _texts(kind: int, payload: bytes) -> list[Any]:
    values: list[Any] = []
    at = 0
    count = 3
    if kind == SIGNALS:
        if len(payload) < 2:
            raise NonsenseError("counts")
        count, at = payload[0] + payload[1], 2
    for _ in range(count):
        if at >= len(payload) or at + 1 + payload[at] > len(payload):
            raise NonsenseError("text")
        values.append(payload[at + 1 : at + 1 + payload[at]].decode("latin-1"))
        at += 1 + payload[at]
    if at != len(payload):
        raise NonsenseError("rest")
    return values


def _compare(frame: Any, seq: int, wanted: list[Any]) -> None:
    got = list(_flat(frame.message))
    if frame.seq != seq or len(got) != len(wanted):
        raise CodecError(f"{frame} instead of {seq}, {wanted}")
    for one, other in zip(got, wanted, strict=True):
        if isinstance(other, str):
            is_same = one == other
        else:
            is_same = math.isclose(one, other, rel_tol=1e-12, abs_tol=1e-300)
        if not is_same:
            raise CodecError(f"{one!r} instead of {other!r} in {frame}")


def _flat(value: Any) -> Iterator[Any]:
    if isinstance(value, tuple):
        for part in value:
            yield from _flat(part)
    elif hasattr(value, "__dataclass_fields__"):
        for name in value.__dataclass_fields__:
            yield from _flat(getattr(value, name))
    else:
        yield value


def _good_frames() -> Iterator[tuple[int, bytes]]:
    for kind, (format_, _) in FORMATS.items():
        numbers = [1.5 * k + 1 if c == "f" else k + 1 for k, c in enumerate(format_)]
        payload = struct.pack(">" + format_, *numbers)
        yield kind, struct.pack(">BBHi", 0xB1, kind, len(payload), kind + 1) + payload
    for kind, payload in (
        (IDENTITY, b"\x03abc\x00\x02de"),
        (SIGNALS, b"\x02\x01\x03di1\x00\x02do"),
    ):
        yield kind, struct.pack(">BBHi", 0xB1, kind, len(payload), kind + 1) + payload
