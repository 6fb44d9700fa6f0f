"""Real sockets, for the paced loop.

A program binds the controller's address, which this machine does not have, and often a fixed
port: both are mapped.
"""

import asyncio
import errno
import os
import socket
from collections import deque
from collections.abc import Mapping
from typing import Any, cast

__all__ = ["TcpListener", "TcpNetwork", "TcpStream"]

BUFFER_BYTES = 65_536
BACKLOG = 16


class TcpStream(asyncio.Protocol):
    """One end of a TCP connection; ``peer`` is the other end's address."""

    def __init__(self, listener: "TcpListener | None" = None) -> None:
        self.peer = ""
        self._listener = listener
        self._transport: asyncio.Transport | None = None
        self._data = bytearray()
        self._has_ended = False
        self._is_closed = False
        self._is_paused = False
        self._may_write = asyncio.Event()
        self._may_write.set()
        self._error: Exception | None = None
        self._arrived: asyncio.Future[None] | None = None

    async def receive(self, most: int) -> bytes:
        """At least one byte, at most ``most``; ``b""`` at the end.

        Raises
        ------
        ConnectionError
            The connection was reset, or this end is closed.
        """
        while not self._data and not self._has_ended and not self._is_closed:
            self._arrived = asyncio.get_running_loop().create_future()
            await self._arrived
        if self._is_closed:
            raise ConnectionAbortedError(errno.ECONNABORTED, "this end is closed")
        if not self._data and self._error is not None:
            raise ConnectionResetError(errno.ECONNRESET, str(self._error))
        data = bytes(self._data[:most])
        del self._data[:most]
        if self._is_paused and len(self._data) < BUFFER_BYTES and self._transport is not None:
            self._is_paused = False
            self._transport.resume_reading()
        return data

    async def send(self, data: bytes) -> None:
        """All of it, in order; waits while too much is on its way.

        Raises
        ------
        ConnectionError
            The connection is lost or closed.
        """
        self._check_open()
        assert self._transport is not None
        self._transport.write(data)
        await self._may_write.wait()
        self._check_open()

    def pending(self) -> int:
        """How many received bytes wait."""
        return len(self._data)

    def close(self) -> None:
        """Both ways; what was sent still leaves. Harmless when closed."""
        self._is_closed = True
        self._data.clear()
        self._wake()
        if self._transport is not None:
            self._transport.close()

    def abort(self) -> None:
        """Close with a reset."""
        self._is_closed = True
        self._wake()
        if self._transport is not None:
            self._transport.abort()

    # For asyncio.

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast("asyncio.Transport", transport)
        self.peer = str(transport.get_extra_info("peername", ("",))[0])
        sock = transport.get_extra_info("socket")
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if self._listener is not None:
            self._listener.admit(self)

    def data_received(self, data: bytes) -> None:
        self._data += data
        if len(self._data) >= BUFFER_BYTES and self._transport is not None:
            self._is_paused = True
            self._transport.pause_reading()
        self._wake()

    def eof_received(self) -> bool:
        self._has_ended = True
        self._wake()
        return True

    def connection_lost(self, exc: Exception | None) -> None:
        self._error = exc
        self._has_ended = True
        self._transport = None
        self._may_write.set()
        self._wake()

    def pause_writing(self) -> None:
        self._may_write.clear()

    def resume_writing(self) -> None:
        self._may_write.set()

    def _check_open(self) -> None:
        if self._is_closed:
            raise ConnectionAbortedError(errno.ECONNABORTED, "this end is closed")
        if self._transport is None or self._transport.is_closing():
            raise BrokenPipeError(errno.EPIPE, f"the connection with {self.peer} has ended")

    def _wake(self) -> None:
        if self._arrived is not None and not self._arrived.done():
            self._arrived.set_result(None)


class TcpListener:
    """A listening socket; ``port`` is the one really bound."""

    def __init__(self) -> None:
        self.port = 0
        self.is_closed = False
        self._server: asyncio.Server | None = None
        self._clients: deque[TcpStream] = deque()
        self._arrived = asyncio.Event()

    async def accept(self) -> TcpStream:
        """The next client. ``ConnectionAbortedError`` once closed."""
        while not self._clients:
            if self.is_closed:
                raise ConnectionAbortedError(errno.ECONNABORTED, "this end is closed")
            self._arrived.clear()
            await self._arrived.wait()
        return self._clients.popleft()

    def close(self) -> None:
        """Stop listening; clients that were not accepted are dropped."""
        self.is_closed = True
        self._arrived.set()
        if self._server is not None:
            self._server.close()
        while self._clients:
            self._clients.popleft().abort()

    def admit(self, client: TcpStream) -> None:
        """Queue a client, or drop it when too many wait."""
        if self.is_closed or len(self._clients) >= BACKLOG:
            client.abort()
            return
        self._clients.append(client)
        self._arrived.set()

    async def open(self, address: str, port: int) -> None:
        """Bind and listen. Raises ``OSError``."""
        loop = asyncio.get_running_loop()
        self._server = await loop.create_server(
            lambda: TcpStream(self), address, port, reuse_address=True, backlog=BACKLOG
        )
        self.port = cast("tuple[Any, ...]", self._server.sockets[0].getsockname())[1]


class TcpNetwork:
    """TCP of this machine.

    Parameters
    ----------
    bind
        Where a program's listener really listens, whatever address it names; ``127.0.0.1``
        stays itself.
    ports
        The program's port to the real one; 0 chooses a free one, which then stays the same and
        is read from ``chosen``. A port that is not here is bound as it is. ``refused`` says why
        one could not be bound when it was last tried.
    """

    def __init__(self, bind: str = "127.0.0.1", ports: Mapping[int, int] | None = None) -> None:
        self.bind = bind
        self.chosen: dict[int, int] = {}
        self.refused: dict[int, str] = {}
        self._ports = dict(ports or {})
        self._open: dict[int, TcpListener] = {}

    async def listen(self, address: str, port: int) -> TcpListener:
        """Bind and listen. Raises ``OSError`` (EADDRINUSE, EADDRNOTAVAIL)."""
        before = self._open.get(port)
        if port and before is not None and not before.is_closed:
            raise OSError(errno.EADDRINUSE, f"port {port} is already in use")
        listener = TcpListener()
        real = self.chosen.get(port, self._ports.get(port, port))
        try:
            await listener.open(address if address.startswith("127.") else self.bind, real)
        except OSError as error:
            number = error.errno or 0
            why = os.strerror(number) if number in errno.errorcode else error.strerror
            self.refused[port] = f"{self.bind}:{real}: {why}"
            raise
        self.refused.pop(port, None)
        self._open[port] = listener
        self.chosen[port] = listener.port
        return listener

    async def connect(self, address: str, port: int) -> TcpStream:
        """Connect to a real address. Raises ``OSError``."""
        loop = asyncio.get_running_loop()
        _, stream = await loop.create_connection(TcpStream, address, port)
        return stream
