"""The wire to a simulated controller in memory, and the shipped package running behind it."""

from collections import deque
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager

from hal.errors import ConfigError
from sims.controller.controller import Controller
from sims.controller.package import package_setup
from sims.rapid.network import MemoryNetwork
from sims.rapid.network.memory import MemoryStream
from sims.world import World

__all__ = [
    "CONTROLLER_ADDRESS",
    "MemoryConnector",
    "open_address",
    "running_package",
    "shipped_controller",
]

CONTROLLER_ADDRESS = "192.168.125.1"
CLIENT_ADDRESS = "192.168.125.50"
MOST_STREAMS = 16


class MemoryConnector:
    """The computer's end of the cable; ``drivers.transports.Connector``.

    ``cut`` pulls it out: connections break and new ones are refused until ``mend``.
    """

    def __init__(self, network: MemoryNetwork, address: str = CLIENT_ADDRESS) -> None:
        self.where = f"sim-abb:{CONTROLLER_ADDRESS}"
        self._network = network
        self._address = address
        self._streams: deque[MemoryStream] = deque(maxlen=MOST_STREAMS)
        self.is_cut = False

    async def connect(self, port: int) -> MemoryStream:
        """Open a stream. ``OSError`` when nobody listens or the cable is out."""
        if self.is_cut:
            raise ConnectionRefusedError(111, "the cable is out")
        stream = await self._network.connect(CONTROLLER_ADDRESS, port, peer=self._address)
        self._streams.append(stream)
        return stream

    def mute(self) -> None:
        """Lose all that is sent from now on over the connections there are, and tell nobody."""
        for stream in self._streams:
            stream.send = _lose  # type: ignore[method-assign]

    def cut(self) -> None:
        """Pull the cable."""
        self.is_cut = True
        for stream in self._streams:
            stream.abort()
        self._streams.clear()

    def mend(self) -> None:
        """Plug it in."""
        self.is_cut = False


async def _lose(data: bytes) -> None:
    """Where bytes go that never arrive."""
    del data


def shipped_controller(
    world: World, overrides: Mapping[str, str] | None = None
) -> tuple[Controller, MemoryConnector]:
    """Return a controller with the shipped package, switched off, and the cable to it."""
    network = MemoryNetwork(CONTROLLER_ADDRESS)
    setup = package_setup(overrides=overrides)
    return Controller(world, setup, network), MemoryConnector(network)


def open_address(rest: str) -> MemoryConnector:
    """There is no controller at an address of its own: a twin brings its controller along.

    Raises
    ------
    ConfigError
        Always; says where such an address does mean something.
    """
    raise ConfigError(
        f"'sim-abb:{rest}' is the controller of a simulated cell, as `binpick demo` runs it; for "
        "one that stands alone start `binpick sim abb` and write tcp:127.0.0.1"
    )


@asynccontextmanager
async def running_package(
    world: World, overrides: Mapping[str, str] | None = None
) -> AsyncIterator[MemoryConnector]:
    """Switch the controller on, motors on, press Start; off again at the end."""
    controller, connector = shipped_controller(world, overrides)
    async with controller:
        controller.motors_on()
        controller.look()
        await controller.start()
        yield connector
