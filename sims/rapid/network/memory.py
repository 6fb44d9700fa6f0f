"""A network without a kernel: byte streams between RAPID and Python in one event loop.

Nothing takes time here, and everything happens in the order it was done, so a run in lock-step
repeats to the bit.
"""

import asyncio
import errno
import os
from collections import deque
from collections.abc import Callable

__all__ = ["MemoryListener", "MemoryNetwork", "MemoryStream"]

BUFFER_BYTES = 65_536
BACKLOG = 16
EPHEMERAL = range(49_152, 65_536)
LOOPBACK = "127.0.0.1"
ANY = frozenset({"", "0.0.0.0"})


class _Pipe:
    """One direction: a bounded buffer that a sender fills and a receiver empties."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.is_ended = False
        self.is_aborted = False
        self._waiters: list[asyncio.Future[None]] = []

    async def changed(self) -> None:
        """Until something is put in, taken out or ended."""
        waiter: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiters.append(waiter)
        try:
            await waiter
        finally:
            if waiter in self._waiters:
                self._waiters.remove(waiter)

    def wake(self) -> None:
        """Tell who waits."""
        waiters, self._waiters = self._waiters, []
        for waiter in waiters:
            if not waiter.done():
                waiter.set_result(None)


class MemoryStream:
    """One end of a connection; ``peer`` is the other end's address.

    ``send`` waits while the receiver is 64 KiB behind.
    """

    def __init__(self, peer: str, inward: _Pipe, outward: _Pipe) -> None:
        self.peer = peer
        self._in = inward
        self._out = outward
        self._is_closed = False

    async def receive(self, most: int) -> bytes:
        """At least one byte, at most ``most``; ``b""`` when the peer has ended.

        Raises
        ------
        ConnectionError
            The peer has aborted, or this end is closed.
        """
        pipe = self._in
        while not pipe.data and not pipe.is_ended and not self._is_closed:
            await pipe.changed()
        if self._is_closed:
            raise ConnectionAbortedError(errno.ECONNABORTED, "this end is closed")
        if pipe.is_aborted:
            raise ConnectionResetError(errno.ECONNRESET, f"{self.peer} reset the connection")
        data = bytes(pipe.data[:most])
        del pipe.data[:most]
        pipe.wake()
        return data

    async def send(self, data: bytes) -> None:
        """All of it, in order.

        Raises
        ------
        ConnectionError
            The peer is gone, or this end is closed or has ended.
        """
        rest = memoryview(data)
        while True:
            self._check_open_for_sending()
            room = BUFFER_BYTES - len(self._out.data)
            if rest and room > 0:
                self._out.data += rest[:room]
                rest = rest[room:]
                self._out.wake()
            if not rest:
                return
            await self._out.changed()

    def pending(self) -> int:
        """How many received bytes wait."""
        return len(self._in.data)

    def end(self) -> None:
        """Half-close: no more is sent; the peer reads what is on its way, then the end."""
        self._out.is_ended = True
        self._out.wake()

    def close(self) -> None:
        """Both ways; what was sent still arrives. Harmless when closed."""
        self._is_closed = True
        self.end()
        self._in.is_ended = True
        self._in.data.clear()
        self._in.wake()

    def abort(self) -> None:
        """Close at once: what is on its way is lost and the peer gets a reset."""
        self._out.data.clear()
        self._out.is_aborted = True
        self.close()

    def _check_open_for_sending(self) -> None:
        if self._is_closed:
            raise ConnectionAbortedError(errno.ECONNABORTED, "this end is closed")
        if self._out.is_ended:
            raise BrokenPipeError(errno.EPIPE, f"the connection with {self.peer} has ended")


class MemoryListener:
    """A bound port; at most 16 clients wait to be accepted."""

    def __init__(self, port: int, closed: Callable[[], None]) -> None:
        self.port = port
        self._closed = closed
        self._clients: deque[MemoryStream] = deque()
        self._arrived = asyncio.Event()
        self.is_closed = False

    async def accept(self) -> MemoryStream:
        """The next client. ``ConnectionAbortedError`` once closed."""
        while not self._clients:
            if self.is_closed:
                raise ConnectionAbortedError(errno.ECONNABORTED, "this end is closed")
            self._arrived.clear()
            await self._arrived.wait()
        return self._clients.popleft()

    def close(self) -> None:
        """Stop listening; clients that were not accepted are dropped."""
        if self.is_closed:
            return
        self.is_closed = True
        self._closed()
        while self._clients:
            self._clients.popleft().abort()
        self._arrived.set()

    def admit(self, client: MemoryStream) -> None:
        """Queue a client. ``ConnectionRefusedError`` when too many wait."""
        if len(self._clients) >= BACKLOG:
            raise _refused(self.port)
        self._clients.append(client)
        self._arrived.set()


class MemoryNetwork:
    """What one host sees of a network; ``at`` gives another host's view of the same one.

    A host may bind its own address, all addresses (``0.0.0.0``) and ``127.0.0.1``, which, as in
    life, can be reached from that host only.
    """

    def __init__(self, address: str = "192.168.125.1") -> None:
        self.address = address
        self._bound: dict[tuple[str, int], MemoryListener] = {}

    def at(self, address: str) -> "MemoryNetwork":
        """Return the view of the host with this address."""
        other = MemoryNetwork(address)
        other._bound = self._bound
        return other

    async def listen(self, address: str, port: int) -> MemoryListener:
        """Bind; port 0 chooses one.

        Raises
        ------
        OSError
            EADDRNOTAVAIL: not an address of this host. EADDRINUSE.
        """
        if address in ANY:
            keys = [self.address, f"{LOOPBACK}@{self.address}"]
        elif address == LOOPBACK:
            keys = [f"{LOOPBACK}@{self.address}"]
        elif address == self.address:
            keys = [address]
        else:
            raise OSError(errno.EADDRNOTAVAIL, f"{address} is not an address of {self.address}")
        port = port or self._free_port(keys)
        places = [(key, port) for key in keys]
        if any(place in self._bound for place in places):
            raise OSError(errno.EADDRINUSE, f"{os.strerror(errno.EADDRINUSE)}: {address}:{port}")

        def release() -> None:
            for place in places:
                del self._bound[place]

        listener = MemoryListener(port, release)
        self._bound.update(dict.fromkeys(places, listener))
        return listener

    async def connect(self, address: str, port: int, peer: str | None = None) -> MemoryStream:
        """Connect from ``peer`` (default: this host) and return the client's end.

        Raises
        ------
        ConnectionRefusedError
            Nobody listens there, or the backlog is full.
        """
        source = peer or self.address
        key = f"{LOOPBACK}@{source}" if address == LOOPBACK else address
        listener = self._bound.get((key, port))
        if listener is None:
            raise _refused(port)
        forth, back = _Pipe(), _Pipe()
        listener.admit(MemoryStream(LOOPBACK if address == LOOPBACK else source, forth, back))
        return MemoryStream(address, back, forth)

    def _free_port(self, keys: list[str]) -> int:
        for port in EPHEMERAL:
            if not any((key, port) in self._bound for key in keys):
                return port
        raise OSError(errno.EADDRINUSE, "no free port is left")


def _refused(port: int) -> ConnectionRefusedError:
    return ConnectionRefusedError(errno.ECONNREFUSED, f"port {port}: connection refused")
