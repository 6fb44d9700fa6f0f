import asyncio
import errno

import pytest

from sims.loop import LockstepLoop, NoWorld, PacedLoop
from sims.rapid.network import MemoryNetwork, TcpNetwork

CONTROLLER, PC = "192.168.125.1", "192.168.125.50"


async def refusal(opening):
    try:
        await opening
    except OSError as error:
        return error.errno
    return None


def lockstep(main):
    loop = LockstepLoop(NoWorld())
    try:
        return loop.run_until_complete(main())
    finally:
        loop.close()


def paced(main):
    loop = PacedLoop(NoWorld(20_000_000))
    try:
        return loop.run_until_complete(asyncio.wait_for(main(), 20))
    finally:
        loop.close()


async def pair(network=None):
    network = network or MemoryNetwork()
    listener = await network.listen(CONTROLLER, 1025)
    client = await network.connect(CONTROLLER, 1025, peer=PC)
    return network, listener, client, await listener.accept()


def test_bytes_go_both_ways_and_merge():
    async def main():
        _, _, client, server = await pair()
        assert (client.peer, server.peer) == (CONTROLLER, PC)
        await client.send(b"one ")
        await client.send(b"two")
        assert server.pending() == 7
        assert await server.receive(5) == b"one t"
        assert await server.receive(80) == b"wo"
        await server.send(b"ok")
        assert await client.receive(80) == b"ok"

    lockstep(main)


def test_a_sender_waits_for_a_slow_receiver():
    async def main():
        _, _, client, server = await pair()
        sending = asyncio.ensure_future(client.send(bytes(200_000)))
        await asyncio.sleep(1)
        assert not sending.done()
        assert server.pending() == 65_536
        got = 0
        while got < 200_000:
            got += len(await server.receive(1024))
        await sending
        assert server.pending() == 0

    lockstep(main)


def test_an_end_arrives_after_the_data_and_an_abort_before():
    async def main():
        _, _, client, server = await pair()
        await client.send(b"bye")
        client.close()
        assert await server.receive(80) == b"bye"
        assert await server.receive(80) == b""
        with pytest.raises(BrokenPipeError):
            await server.send(b"x")
        _, _, client, server = await pair()
        await client.send(b"bye")
        client.abort()
        with pytest.raises(ConnectionResetError):
            await server.receive(80)

    lockstep(main)


def test_a_half_closed_stream_still_receives():
    async def main():
        _, _, client, server = await pair()
        client.end()
        assert await server.receive(80) == b""
        await server.send(b"late")
        assert await client.receive(80) == b"late"
        with pytest.raises(BrokenPipeError):
            await client.send(b"x")

    lockstep(main)


def test_closing_ends_ones_own_receive_and_a_cancelled_receive_loses_nothing():
    async def main():
        _, _, client, server = await pair()
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(server.receive(80), 0.5)
        await client.send(b"kept")
        assert await server.receive(80) == b"kept"
        waiting = asyncio.ensure_future(server.receive(80))
        await asyncio.sleep(0.1)
        server.close()
        with pytest.raises(ConnectionAbortedError):
            await waiting

    lockstep(main)


def test_addresses_are_in_use_foreign_or_only_for_the_host_itself():
    async def main():
        network, listener, _, _ = await pair()
        assert await refusal(network.listen(CONTROLLER, 1025)) == errno.EADDRINUSE
        assert await refusal(network.listen("10.0.0.9", 1025)) == errno.EADDRNOTAVAIL
        listener.close()
        with pytest.raises(ConnectionRefusedError):
            await network.connect(CONTROLLER, 1025, peer=PC)
        await network.listen("127.0.0.1", 1025)
        with pytest.raises(ConnectionRefusedError):
            await network.connect(CONTROLLER, 1025, peer=PC)
        with pytest.raises(ConnectionRefusedError):
            await network.at(PC).connect("127.0.0.1", 1025)
        await network.connect("127.0.0.1", 1025)
        server = await network.at(PC).listen(PC, 0)
        await network.connect(PC, server.port)
        assert (await server.accept()).peer == CONTROLLER

    lockstep(main)


def test_a_full_backlog_refuses_and_a_closed_listener_drops_who_waits():
    async def main():
        network = MemoryNetwork()
        listener = await network.listen("0.0.0.0", 1025)
        clients = [await network.connect(CONTROLLER, 1025, peer=PC) for _ in range(16)]
        with pytest.raises(ConnectionRefusedError):
            await network.connect(CONTROLLER, 1025, peer=PC)
        listener.close()
        with pytest.raises(ConnectionResetError):
            await clients[0].receive(1)

    lockstep(main)


def test_tcp_maps_the_address_and_keeps_the_port_it_chose():
    async def main():
        network = TcpNetwork(ports={1025: 0})
        listener = await network.listen(CONTROLLER, 1025)
        port = network.chosen[1025]
        assert port not in {0, 1025}
        assert await refusal(network.listen(CONTROLLER, 1025)) == errno.EADDRINUSE
        client = await network.connect("127.0.0.1", port)
        server = await listener.accept()
        await client.send(b"hello")
        assert await server.receive(80) == b"hello"
        assert server.peer == "127.0.0.1"
        listener.close()
        again = await network.listen(CONTROLLER, 1025)
        assert again.port == port
        server.close()
        assert await client.receive(1) == b""
        client.close()
        again.close()
        await asyncio.sleep(0.01)

    paced(main)


def test_tcp_receivers_are_not_flooded():
    async def main():
        network = TcpNetwork(ports={1025: 0})
        listener = await network.listen(CONTROLLER, 1025)
        client = await network.connect("127.0.0.1", listener.port)
        server = await listener.accept()
        sending = asyncio.ensure_future(client.send(bytes(20_000_000)))
        await asyncio.sleep(0.2)
        assert server.pending() < 1_000_000
        got = 0
        while got < 20_000_000:
            got += len(await server.receive(100_000))
        await sending
        client.abort()
        server.close()
        listener.close()
        await asyncio.sleep(0.01)

    paced(main)
