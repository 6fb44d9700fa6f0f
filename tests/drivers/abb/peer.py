"""A scripted controller: answers as the protocol has it, or as a test orders."""

import asyncio
import contextlib
from dataclasses import replace

from drivers.abb import messages as m
from drivers.abb.codec import encode, request_decoder
from sims.loop import LockstepLoop, NoWorld
from sims.rapid.network import MemoryNetwork

__all__ = ["HERE", "Connector", "Peer", "run"]

HERE = "192.168.125.1"
STATE = m.ControllerState(
    turns=0,
    time_s=0.0,
    flags=m.Flag.MOTORS_ON | m.Flag.AUTO | m.Flag.EXECUTING,
    hold=m.Code.NONE,
    tick=3,
    active=0,
    joints_rad=(0.0, 0.0, 0.0, 0.0, 1.57, 0.0),
    position_m=(0.451, 0.0, 0.807),
    quaternion=(0.0, 0.0, 1.0, 0.0),
    inputs=0b101,
    outputs=0b10,
)


class Connector:
    """The driver's end of the network."""

    where = f"memory:{HERE}"

    def __init__(self, network):
        self.network = network
        self.streams = []

    async def connect(self, port):
        stream = await self.network.connect(HERE, port)
        self.streams.append(stream)
        return stream


class Peer:
    """``heard`` is what was asked; ``script`` maps a message's type to what is done instead.

    A script is called with the frame and returns the bytes to send.
    """

    def __init__(self, *, sends_state=True):
        self.network = MemoryNetwork(HERE)
        self.connector = Connector(self.network)
        self.state = STATE
        self.heard = []
        self.script = {}
        self.sends_state = sends_state
        self.motion_s = 0.2
        self.streams = {}
        self._tasks = []

    async def start(self):
        loop = asyncio.get_running_loop()
        for port in (5010, 5011):
            listener = await self.network.listen(HERE, port)
            self._tasks.append(loop.create_task(self._accept(listener, port)))

    async def stop(self):
        for task in self._tasks:
            task.cancel()
        for task in self._tasks:
            with contextlib.suppress(asyncio.CancelledError, ConnectionError):
                await task

    async def _accept(self, listener, port):
        loop = asyncio.get_running_loop()
        while True:
            stream = await listener.accept()
            self.streams[port] = stream
            self._tasks.append(loop.create_task(self._serve(stream)))
            if port == 5011 and self.sends_state:
                self._tasks.append(loop.create_task(self._stream_state(stream)))

    async def _stream_state(self, stream):
        with contextlib.suppress(ConnectionError):
            while True:
                await asyncio.sleep(0.04)
                await stream.send(encode(0, self.now()))

    async def _serve(self, stream):
        decoder = request_decoder()
        with contextlib.suppress(ConnectionError):
            while data := await stream.receive(4096):
                decoder.feed(data)
                while (frame := decoder.next_frame()) is not None:
                    self.heard.append(frame.message)
                    await self._answer(stream, frame)

    def now(self):
        return replace(self.state, time_s=asyncio.get_running_loop().time())

    async def _answer(self, stream, frame):
        seq, message = frame.seq, frame.message
        if (script := self.script.get(type(message))) is not None:
            await stream.send(script(frame))
            return
        match message:
            case m.Ping():
                return
            case m.Hello():
                reply = m.Welcome(1, 0, 77, 50, 0.5)
            case m.Identify():
                reply = m.IdentityReply("IRB 1200-5/0.9", "12-34567", "6.08")
            case m.AskSignals():
                reply = m.SignalNames(("di1", "di2", "di3"), ("do1", "do2"))
            case m.AskState():
                reply = self.now()
            case m.Run():
                await stream.send(encode(seq, m.Accepted(message.id)))
                self._tasks.append(
                    asyncio.get_running_loop().create_task(self._drive(stream, seq, message))
                )
                return
            case _:
                reply = m.Accepted(0)
        await stream.send(encode(seq, reply))

    async def _drive(self, stream, seq, run):
        self.state = replace(self.state, flags=self.state.flags | m.Flag.MOVING)
        await asyncio.sleep(self.motion_s)
        self.state = replace(self.state, flags=self.state.flags & ~m.Flag.MOVING)
        with contextlib.suppress(ConnectionError):
            await stream.send(encode(seq, m.Outcome(m.Result.DONE, m.Code.NONE, run.id, run.count)))


def run(main, **options):
    """Run a test's coroutine with a started peer, in lock-step without a world."""
    loop = LockstepLoop(NoWorld())

    async def whole():
        peer = Peer(**options)
        await peer.start()
        try:
            return await main(peer)
        finally:
            await peer.stop()

    try:
        return loop.run_until_complete(whole())
    finally:
        loop.close()
