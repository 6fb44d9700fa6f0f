import asyncio
import contextlib
import socket
import struct

import pytest

from drivers.transports import TcpConnector, open_tcp
from drivers.transports.tcp import HIGH_WATER_BYTES
from hal.errors import ConfigError


def with_server(serve, client):
    """Run ``client(port)`` against ``serve(reader, writer)`` on a port of its own."""

    async def main():
        async def handle(reader, writer):
            try:
                await serve(reader, writer)
            finally:
                writer.close()

        server = await asyncio.start_server(handle, "127.0.0.1", 0)
        async with server:
            return await client(server.sockets[0].getsockname()[1])

    return asyncio.run(asyncio.wait_for(main(), 30))


async def echo(reader, writer):
    while data := await reader.read(4096):
        writer.write(data)
        await writer.drain()


def test_what_is_sent_comes_back():
    async def client(port):
        transport = await TcpConnector("127.0.0.1").connect(port)
        await transport.send(b"hello")
        data = await transport.receive(100)
        transport.close()
        return data

    assert with_server(echo, client) == b"hello"


def test_no_more_is_received_than_asked_for_and_nothing_is_lost():
    async def client(port):
        transport = await TcpConnector("127.0.0.1").connect(port)
        await transport.send(bytes(range(256)))
        parts = []
        while sum(map(len, parts)) < 256:
            parts.append(await transport.receive(7))
        transport.close()
        return parts

    parts = with_server(echo, client)
    assert b"".join(parts) == bytes(range(256))
    assert max(map(len, parts)) <= 7


def test_a_cancelled_receive_loses_nothing():
    async def client(port):
        transport = await TcpConnector("127.0.0.1").connect(port)
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.02):
                await transport.receive(100)
        await transport.send(b"later")
        data = await transport.receive(100)
        transport.close()
        return data

    assert with_server(echo, client) == b"later"


def test_the_end_is_empty_bytes_after_all_that_was_sent():
    async def serve(reader, writer):
        writer.write(b"bye")

    async def client(port):
        transport = await TcpConnector("127.0.0.1").connect(port)
        received = [await transport.receive(100), await transport.receive(100)]
        transport.close()
        with pytest.raises(ConnectionError):
            await transport.send(b"x")
        return received

    assert with_server(serve, client) == [b"bye", b""]


def test_a_reset_is_a_connection_error():
    async def serve(reader, writer):
        await reader.read(1)
        # Lingering for no time makes the kernel send a reset.
        linger = struct.pack("ii", 1, 0)
        writer.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, linger)
        writer.transport.abort()

    async def client(port):
        transport = await TcpConnector("127.0.0.1").connect(port)
        await transport.send(b"x" * 100)
        with pytest.raises(ConnectionError):
            await transport.receive(100)

    with_server(serve, client)


def test_a_peer_that_sends_without_end_is_held_back():
    sent = 0

    async def serve(reader, writer):
        nonlocal sent
        with contextlib.suppress(ConnectionError, asyncio.CancelledError):
            while True:
                writer.write(bytes(4096))
                sent += 4096
                await writer.drain()

    async def client(port):
        transport = await TcpConnector("127.0.0.1").connect(port)
        full = await settled()
        held = transport._held
        while sent == full:
            await transport.receive(65536)
            await asyncio.sleep(0)
        transport.close()
        return held

    async def settled():
        """How much was sent when no more goes in; ever growing ends in the server's time limit."""
        before = -1
        while before != sent:
            before = sent
            await asyncio.sleep(0.2)
        return sent

    held = with_server(serve, client)
    assert 0 < held <= HIGH_WATER_BYTES + 262_144


def test_forwarded_ports_are_used_instead():
    async def client(port):
        transport = await TcpConnector("127.0.0.1", {5010: port}).connect(5010)
        await transport.send(b"x")
        return await transport.receive(1)

    assert with_server(echo, client) == b"x"


def test_devices_with_one_address_share_a_connector():
    first = open_tcp("192.168.125.1")
    assert open_tcp("192.168.125.1") is first
    assert open_tcp("192.168.125.2") is not first
    assert first.where == "tcp:192.168.125.1"


@pytest.mark.parametrize("rest", ["", " ", "a b"])
def test_an_address_without_a_host_is_refused(rest):
    with pytest.raises(ConfigError, match=r"192\.168\.125\.1"):
        open_tcp(rest)
