"""The networks a controller may be on: in memory (lock-step) and TCP (paced)."""

from sims.rapid.network.memory import MemoryListener, MemoryNetwork, MemoryStream
from sims.rapid.network.tcp import TcpListener, TcpNetwork, TcpStream

__all__ = [
    "MemoryListener",
    "MemoryNetwork",
    "MemoryStream",
    "TcpListener",
    "TcpNetwork",
    "TcpStream",
]
