"""The shipped package on real sockets of this machine, and the driver's way to it."""

from collections.abc import Mapping

from drivers.transports import TcpConnector
from drivers.transports.tcp import TcpTransport
from sims.controller.controller import Controller
from sims.controller.package import package_setup
from sims.rapid.network import TcpNetwork
from sims.world import World

__all__ = ["LoopbackConnector", "loopback_controller"]

LOOPBACK = "127.0.0.1"
PORTS = (5010, 5011)


class LoopbackConnector(TcpConnector):
    """Finds the ports that the network chose, and can be cut like a cable."""

    def __init__(self, network: TcpNetwork) -> None:
        super().__init__(LOOPBACK)
        self._network = network
        self._is_cut = False
        self._opened: list[TcpTransport] = []

    @property
    def ports(self) -> dict[int, int]:
        """The program's ports and the ones chosen for them, as far as it listens."""
        return dict(self._network.chosen)

    async def connect(self, port: int) -> TcpTransport:
        """Open a stream; refused while nobody listens, or cut."""
        if self._is_cut or port not in self._network.chosen:
            raise ConnectionRefusedError(111, "nobody listens")
        self._ports = self.ports
        transport = await super().connect(port)
        self._opened.append(transport)
        return transport

    def cut(self) -> None:
        """Pull the cable."""
        self._is_cut = True
        for transport in self._opened:
            transport.abort()
        self._opened.clear()

    def mend(self) -> None:
        """Plug it in."""
        self._is_cut = False


def loopback_controller(
    world: World, overrides: Mapping[str, str] | None = None
) -> tuple[Controller, LoopbackConnector]:
    """Return a controller that listens on free ports, switched off, and the way to it."""
    network = TcpNetwork(LOOPBACK, dict.fromkeys(PORTS, 0))
    peers = {"BP_PEERS": f'["{LOOPBACK}", "", "", ""]'}
    setup = package_setup(overrides={**peers, **(overrides or {})})
    return Controller(world, setup, network), LoopbackConnector(network)
