"""TCP, without delay and without surprises."""

import asyncio
import socket
from collections import deque
from collections.abc import Callable
from weakref import WeakValueDictionary

from hal.errors import ConfigError

__all__ = ["TcpConnector", "TcpTransport", "open_tcp"]

HIGH_WATER_BYTES = 1 << 16

_CONNECTORS: "WeakValueDictionary[str, TcpConnector]" = WeakValueDictionary()


class TcpTransport(asyncio.Protocol):
    """Hands received segments over as they are; stops reading when nobody takes them."""

    def __init__(self) -> None:
        self._segments: deque[bytes] = deque()
        self._held = 0
        self._waiter: asyncio.Future[None] | None = None
        self._drained: asyncio.Future[None] | None = None
        self._stream: asyncio.Transport | None = None
        self._error: ConnectionError | None = None
        self._is_over = False
        self._is_paused = False
        self._sink: Callable[[bytes], None] | None = None

    async def receive(self, most: int) -> bytes:
        while not self._segments:
            if self._error is not None:
                raise self._error
            if self._is_over:
                return b""
            self._waiter = asyncio.get_running_loop().create_future()
            try:
                await self._waiter
            finally:
                self._waiter = None
        data = self._segments.popleft()
        if len(data) > most:
            self._segments.appendleft(data[most:])
            data = data[:most]
        self._held -= len(data)
        if self._is_paused and self._held < HIGH_WATER_BYTES // 2 and self._stream is not None:
            self._is_paused = False
            self._stream.resume_reading()
        return data

    async def send(self, data: bytes) -> None:
        if self._stream is None or self._stream.is_closing() or self._error is not None:
            raise self._error or ConnectionResetError("the connection is closed")
        self._stream.write(data)
        if self._drained is not None:
            await asyncio.shield(self._drained)

    def close(self) -> None:
        if self._stream is not None:
            self._stream.close()
        self._is_over = True
        self._wake()

    def deliver_to(self, sink: Callable[[bytes], None]) -> None:
        """Hand over what arrives, from now on; see ``PushTransport``."""
        self._sink = sink
        while self._segments:
            sink(self._segments.popleft())
        self._held = 0
        if self._is_over:
            sink(b"")

    def abort(self) -> None:
        """Close at once; what was sent may be lost."""
        if self._stream is not None:
            self._stream.abort()
        self._is_over = True
        self._wake()

    # What asyncio calls.

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._stream = transport
        stream: socket.socket = transport.get_extra_info("socket")
        stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        stream.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)

    def data_received(self, data: bytes) -> None:
        if self._sink is not None:
            self._sink(data)
            return
        self._segments.append(data)
        self._held += len(data)
        if self._held > HIGH_WATER_BYTES and self._stream is not None:
            self._is_paused = True
            self._stream.pause_reading()
        self._wake()

    def eof_received(self) -> None:
        self._end()

    def connection_lost(self, exc: Exception | None) -> None:
        if exc is not None:
            self._error = ConnectionResetError(str(exc))
        self._end()
        self.resume_writing()

    def pause_writing(self) -> None:
        self._drained = asyncio.get_running_loop().create_future()

    def resume_writing(self) -> None:
        if self._drained is not None and not self._drained.done():
            self._drained.set_result(None)
        self._drained = None

    def _end(self) -> None:
        was_over, self._is_over = self._is_over, True
        self._wake()
        if self._sink is not None and not was_over:
            self._sink(b"")

    def _wake(self) -> None:
        if self._waiter is not None and not self._waiter.done():
            self._waiter.set_result(None)


class TcpConnector:
    """Streams to one host.

    ``ports`` maps a device's own port to the one to use instead, for forwarded ports.
    """

    def __init__(self, host: str, ports: dict[int, int] | None = None) -> None:
        self.host = host
        self.where = f"tcp:{host}"
        self._ports = ports or {}

    async def connect(self, port: int) -> TcpTransport:
        """Open a stream; see ``Connector``."""
        loop = asyncio.get_running_loop()
        port = self._ports.get(port, port)
        _, stream = await loop.create_connection(TcpTransport, self.host, port)
        return stream


def open_tcp(rest: str) -> TcpConnector:
    """Open ``tcp:<host>``; devices with one address share one connector.

    Raises
    ------
    ConfigError
        No host.
    """
    host = rest.strip().strip("/")
    if not host or any(c.isspace() for c in host):
        raise ConfigError(f"no host in address 'tcp:{rest}'; write tcp:192.168.125.1")
    connector = _CONNECTORS.get(host)
    if connector is None:
        connector = _CONNECTORS[host] = TcpConnector(host)
    return connector
