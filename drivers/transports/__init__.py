"""Byte streams to devices, and how they are opened."""

from drivers.transports.base import Connector, PushTransport, Transport
from drivers.transports.tcp import TcpConnector, open_tcp

__all__ = ["Connector", "PushTransport", "TcpConnector", "Transport", "open_tcp"]
