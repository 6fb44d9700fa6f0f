"""Faults made to order around a controller: the network's, the arm's, the operator's."""

import asyncio
import errno
from collections.abc import Callable

from sims.controller.controller import Controller
from sims.rapid.host import EventKind, EventLog, Listener, Network, Stream

__all__ = ["ControllerFaults", "FaultyNetwork", "UnlicensedNetwork"]

COMMUNICATION = 7
MOST_HELD = 4096


class FaultyNetwork:
    """A network whose faults are set while it runs; without any it is the one behind it.

    ``busy_ports`` refuse to be bound. ``cut_bytes`` hands received data over in pieces of at
    most that size (0: as it comes), ``delay_s`` holds each piece back, ``merge_s`` waits that
    long for more before it hands over.
    """

    def __init__(self, inner: Network) -> None:
        self._inner = inner
        self.busy_ports: set[int] = set()
        self.cut_bytes = 0
        self.delay_s = 0.0
        self.merge_s = 0.0
        self._streams: list[_FaultyStream] = []

    async def listen(self, address: str, port: int) -> Listener:
        """Raises ``OSError``, EADDRINUSE for a busy port."""
        if port in self.busy_ports:
            raise OSError(errno.EADDRINUSE, f"port {port} is in use")
        return _FaultyListener(self, await self._inner.listen(address, port))

    async def connect(self, address: str, port: int) -> Stream:
        """Raises ``OSError``."""
        return self.wrapped(await self._inner.connect(address, port))

    def drop_all(self) -> None:
        """Every connection is lost at once, both ways."""
        for stream in self._streams:
            stream.drop()
        self._streams.clear()

    def silence_all(self) -> None:
        """The peers' sides end (half-close): the program sees the end of what they send."""
        for stream in self._streams:
            stream.end_input()

    def wrapped(self, stream: Stream) -> Stream:
        """A stream under these faults."""
        faulty = _FaultyStream(self, stream)
        self._streams = [s for s in self._streams if not s.is_closed]
        self._streams.append(faulty)
        return faulty


class _FaultyListener:
    def __init__(self, network: FaultyNetwork, inner: Listener) -> None:
        self._network = network
        self._inner = inner
        self.port = inner.port

    async def accept(self) -> Stream:
        return self._network.wrapped(await self._inner.accept())

    def close(self) -> None:
        self._inner.close()


class _FaultyStream:
    """Fetches in the background into ``_held``, so that a cancelled receive loses nothing."""

    def __init__(self, network: FaultyNetwork, inner: Stream) -> None:
        self._network = network
        self._inner = inner
        self.peer = inner.peer
        self.is_closed = False
        self._is_dropped = False
        self._held = b""
        self._fetching: asyncio.Task[bytes] | None = None
        self._ends = asyncio.Event()

    async def receive(self, most: int) -> bytes:
        network = self._network
        if not self._held:
            await self._fetch()
        if self._is_dropped:
            raise ConnectionResetError("the connection was lost")
        size = min(most, network.cut_bytes) if network.cut_bytes > 0 else most
        data, self._held = self._held[:size], self._held[size:]
        return data

    async def _fetch(self) -> None:
        if self._ends.is_set():
            return
        if self._fetching is None:
            self._fetching = asyncio.ensure_future(self._arrival())
        ending = asyncio.ensure_future(self._ends.wait())
        try:
            await asyncio.wait({self._fetching, ending}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            ending.cancel()
        if self._fetching is not None and self._fetching.done():
            done, self._fetching = self._fetching, None
            data = done.result()
            self._held += data
            if not data:
                self._ends.set()

    async def _arrival(self) -> bytes:
        """The next piece, as late as it is, with what comes meanwhile."""
        network = self._network
        data = await self._inner.receive(MOST_HELD)
        if network.delay_s > 0:
            await asyncio.sleep(network.delay_s)
        if network.merge_s > 0:
            await asyncio.sleep(network.merge_s)
            while self._inner.pending() and len(data) < MOST_HELD:
                data += await self._inner.receive(MOST_HELD)
        return data

    async def send(self, data: bytes) -> None:
        if self._is_dropped:
            raise ConnectionResetError("the connection was lost")
        await self._inner.send(data)

    def pending(self) -> int:
        return len(self._held) + (0 if self._ends.is_set() else self._inner.pending())

    def close(self) -> None:
        self.is_closed = True
        self.end_input()
        self._inner.close()

    def drop(self) -> None:
        self._is_dropped = True
        self.close()

    def end_input(self) -> None:
        self._ends.set()
        if self._fetching is not None:
            self._fetching.cancel()
            self._fetching = None


class UnlicensedNetwork:
    """A controller without the option for sockets: every use is refused and logged."""

    def __init__(self, log: EventLog, option: str = "616-1 PC Interface") -> None:
        self._log = log
        self._option = option

    async def listen(self, address: str, port: int) -> Listener:
        """Refuse."""
        raise self._refusal(f"bind {address}:{port}")

    async def connect(self, address: str, port: int) -> Stream:
        """Refuse."""
        raise self._refusal(f"connect {address}:{port}")

    def _refusal(self, what: str) -> OSError:
        cause = f"{what}: sockets need the option {self._option}, which is not installed"
        self._log.write(EventKind.ERROR, COMMUNICATION, 71367, "Option not installed", [cause])
        return OSError(errno.EPROTONOSUPPORT, cause)


class ControllerFaults:
    """Hands at a controller while its programs run."""

    def __init__(self, controller: Controller) -> None:
        self._controller = controller

    async def stop_in_move(self) -> None:
        """Press the emergency stop as soon as the arm is driven."""
        await self.when_moving(self._controller.press_emergency_stop)

    async def collide_in_move(self) -> None:
        """Let the arm run into something as soon as it is driven."""
        await self.when_moving(self._controller.collide)

    async def when_moving(self, act: Callable[[], None]) -> None:
        """Do something in the tick in which the arm is driven."""
        unit, world = self._controller.unit, self._controller.world
        await world.until(lambda: unit.is_driving and unit.speed > 0)
        act()

    async def stop_program(self) -> None:
        """Stop the programs; open sockets stay open and silent."""
        await self._controller.stop()

    async def restart(self) -> None:
        """Warm start: sockets close, programs stand at main."""
        await self._controller.restart()
