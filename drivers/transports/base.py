"""What a driver is handed instead of a socket."""

from collections.abc import Callable
from typing import Protocol, runtime_checkable

__all__ = ["Connector", "PushTransport", "Transport"]


class Transport(Protocol):
    """A connected byte stream."""

    async def receive(self, most: int) -> bytes:
        """At least one byte, at most ``most``; ``b""`` at the end. Cancelling loses nothing.

        Raises
        ------
        ConnectionError
            The stream broke.
        """

    async def send(self, data: bytes) -> None:
        """All of it.

        Raises
        ------
        ConnectionError
            The stream is closed or broke.
        """

    def close(self) -> None:
        """Both ways; harmless when closed."""


@runtime_checkable
class PushTransport(Protocol):
    """A transport that can hand over what arrives unasked: two turns of the loop less."""

    def deliver_to(self, sink: Callable[[bytes], None]) -> None:
        """Call with what arrives, from now on, and with ``b""`` at the end; ``receive`` is over."""


class Connector(Protocol):
    """Opens streams to one controller; ``where`` is its address for people."""

    where: str

    async def connect(self, port: int) -> Transport:
        """Open a stream.

        Raises
        ------
        OSError
            Refused, unreachable.
        """
