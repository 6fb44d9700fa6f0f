"""How long a question to the controller takes: our driver against a bare socket.

The peer is a process of its own that answers every request at once with bytes made beforehand.
"""

import asyncio
import multiprocessing
import signal
import socket
import struct
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection

import numpy as np

from drivers.abb import RapidRobot
from drivers.abb.codec import encode
from drivers.abb.messages import (
    AskState,
    Code,
    ControllerState,
    Flag,
    IdentityReply,
    SignalNames,
    Welcome,
)
from drivers.transports import TcpConnector
from hal import Figure

__all__ = ["round_trips", "scripted_peer"]

LOOPBACK = "127.0.0.1"
HEADER_BYTES = 8
STATE = ControllerState(
    turns=0,
    time_s=0.0,
    flags=Flag.MOTORS_ON | Flag.AUTO | Flag.EXECUTING,
    hold=Code.NONE,
    tick=1,
    active=0,
    joints_rad=(0.0, 0.0, 0.0, 0.0, 1.5, 0.0),
    position_m=(0.451, 0.0, 0.807),
    quaternion=(0.0, 0.0, 1.0, 0.0),
    inputs=0,
    outputs=0,
)
ANSWERS = {
    1: encode(0, Welcome(1, 0, 1, 50, 60.0)),
    2: encode(0, IdentityReply("IRB 1200", "0", "0")),
    64: encode(0, SignalNames((), ())),
    48: encode(0, STATE),
}


def serve(pipe: Connection) -> None:
    """Answer clients, one after the other, until killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the bench ends it
    with socket.create_server((LOOPBACK, 0)) as listener:
        pipe.send(listener.getsockname()[1])
        while True:
            client, _ = listener.accept()
            with client:
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                _answer(client)


def _answer(client: socket.socket) -> None:
    buffer = bytearray()
    while data := client.recv(4096):
        buffer += data
        while len(buffer) >= HEADER_BYTES:
            size = HEADER_BYTES + int.from_bytes(buffer[2:4], "big")
            if len(buffer) < size:
                break
            answer = bytearray(ANSWERS.get(buffer[1], b""))
            if answer:
                answer[4:8] = buffer[4:8]
                client.sendall(answer)
            del buffer[:size]


@contextmanager
def scripted_peer() -> Iterator[int]:
    """Run the peer; yields its port."""
    ours, theirs = multiprocessing.Pipe()
    process = multiprocessing.get_context("spawn").Process(
        target=serve, args=(theirs,), daemon=True
    )
    process.start()
    theirs.close()  # so that its end is seen here
    try:
        yield int(ours.recv())
    finally:
        process.kill()
        process.join()


def round_trips(*, count: int = 5000) -> list[Figure]:
    """``abb.round_trip_median|p99``, with a bare blocking socket and bare streams beside."""
    with scripted_peer() as port:
        ours, streams, bare = [], [], []
        # By turns, so that what else the machine does falls on all of them.
        for _ in range(5):
            ours += asyncio.run(_ask_by_driver(port, count // 5))
            streams += asyncio.run(_ask_by_streams(port, count // 5))
            bare += _ask_bare(port, count // 5)
    figures = []
    for name, share in (("median", 50.0), ("p99", 99.0)):
        values = [float(np.percentile(times, share)) for times in (ours, streams, bare)]
        figures += [
            Figure(
                f"abb.round_trip_{name}",
                values[0],
                "s",
                len(ours),
                min(ours),
                max(ours),
                "asyncio streams, same peer and bytes",
                values[1],
            ),
            Figure(f"abb.round_trip_{name}_bare_socket", values[2], "s", len(bare)),
        ]
    return figures


async def _ask_by_driver(port: int, count: int) -> list[float]:
    robot = RapidRobot(TcpConnector(LOOPBACK), monitor_port=port)
    await robot.open()
    times = []
    for _ in range(count):
        began = time.perf_counter()
        await robot.state()
        times.append(time.perf_counter() - began)
    await robot.close()
    return times


async def _ask_by_streams(port: int, count: int) -> list[float]:
    reader, writer = await asyncio.open_connection(LOOPBACK, port)
    times = []
    for number in range(count):
        began = time.perf_counter()
        writer.write(encode(number + 1, AskState()))
        header = await reader.readexactly(HEADER_BYTES)
        await reader.readexactly(struct.unpack(">H", header[2:4])[0])
        times.append(time.perf_counter() - began)
    writer.close()
    await writer.wait_closed()
    return times


def _ask_bare(port: int, count: int) -> list[float]:
    times = []
    with socket.create_connection((LOOPBACK, port)) as client:
        client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for number in range(count):
            began = time.perf_counter()
            client.sendall(encode(number + 1, AskState()))
            received = b""
            while len(received) < len(ANSWERS[48]):
                received += client.recv(4096)
            times.append(time.perf_counter() - began)
    return times
