"""Bytes to frames and back. No socket, no clock, no await.

A frame: magic (1 byte), kind (1), payload length (2, big endian), sequence (4), payload.
"""

import struct
from collections.abc import Sequence

from drivers.abb.layouts import REPLIES, REQUESTS, Layout, TextLayout
from drivers.abb.messages import Frame, Message
from hal.errors import LocalProtocolError, RemoteProtocolError

__all__ = ["Decoder", "encode", "reply_decoder", "request_decoder"]

MAGIC = 0xB1
HEADER = struct.Struct(">BBHi")
MAX_PAYLOAD_BYTES = 1016
MAX_SEQ = 8_000_000
DEVICE = "abb"

_BY_MESSAGE = {layout.message: layout for layout in (*REQUESTS, *REPLIES)}


def encode(seq: int, message: Message) -> bytes:
    """Return a frame.

    Raises
    ------
    LocalProtocolError
        A value does not fit the wire.
    """
    layout = _BY_MESSAGE[type(message)]
    try:
        payload = layout.encode(message)
    except ValueError as error:
        raise LocalProtocolError(str(error), device=DEVICE) from error
    if len(payload) > MAX_PAYLOAD_BYTES or not 0 <= seq <= MAX_SEQ:
        raise LocalProtocolError(f"{message} with number {seq} is too large", device=DEVICE)
    return HEADER.pack(MAGIC, layout.kind, len(payload), seq) + payload


class Decoder:
    """Fed what arrived, however it was cut; asked for what is whole. An error is final."""

    def __init__(self, layouts: Sequence[Layout | TextLayout]) -> None:
        self._layouts = {layout.kind: layout for layout in layouts}
        self._buffer = bytearray()
        self._error: RemoteProtocolError | None = None

    def feed(self, data: bytes) -> None:
        """Take what arrived. Feed and empty in turn: what is held is bounded by what is fed."""
        if self._error is None:
            self._buffer += data

    def next_frame(self) -> Frame | None:
        """Return the next whole frame, or None until more bytes are fed.

        Raises
        ------
        RemoteProtocolError
            The peer sent nonsense, now or before.
        """
        if self._error is not None:
            raise self._error
        buffer = self._buffer
        if buffer and buffer[0] != MAGIC:
            self._fail(f"a frame begins with {buffer[0]:#04x} instead of {MAGIC:#04x}")
        if len(buffer) < HEADER.size:
            return None
        _, kind, size, seq = HEADER.unpack_from(buffer)
        layout = self._layouts.get(kind)
        if layout is None:
            self._fail(f"a frame of unknown kind {kind}")
        if size > MAX_PAYLOAD_BYTES or not 0 <= seq <= MAX_SEQ:
            self._fail(f"a frame of {size} bytes with number {seq}")
        if len(buffer) < HEADER.size + size:
            return None
        payload = bytes(buffer[HEADER.size : HEADER.size + size])
        try:
            message = layout.decode(payload)  # type: ignore[union-attr]
        except ValueError as error:
            self._fail(f"a frame of kind {kind}: {error}")
        del buffer[: HEADER.size + size]
        return Frame(seq, message)

    def _fail(self, problem: str) -> None:
        raw = bytes(self._buffer[:64])
        self._buffer.clear()
        self._error = RemoteProtocolError(problem, device=DEVICE, raw=raw)
        raise self._error


def reply_decoder() -> Decoder:
    """For the driver: what a controller says."""
    return Decoder(REPLIES)


def request_decoder() -> Decoder:
    """For a scripted peer: what a client says."""
    return Decoder(REQUESTS)
