"""The RAPID program we ship as a network service: any bytes may come, and the next is served."""

import asyncio
import contextlib
from collections.abc import Sequence

from drivers.abb import RapidRobot
from drivers.abb import messages as m
from drivers.abb.codec import encode
from drivers.abb.session import Session
from drivers.transports import Transport
from hal.errors import DeviceError
from sims.controller.wire import shipped_controller
from sims.loop import LockstepLoop
from sims.world import World

__all__ = ["AbbServer", "ServerError"]

MONITOR_PORT, MOTION_PORT = 5011, 5010
PAUSES_S = (0.0, 0.001, 0.05, 0.3)
PATIENCE_S = 1.0
SETTLING_S = 0.7
POSE = ((0.45, 0.0, 0.8), (0.0, 0.0, 1.0, 0.0))
MOTION: tuple[m.Message, ...] = (
    m.Drop(),
    m.SetTool(*POSE, 0.5, (0.0, 0.0, 0.1)),
    m.SetWorkObject((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)),
    m.SetLoad(0.3, (0.0, 0.0, 0.1)),
    m.SetAcceleration(50.0, 50.0),
    m.AddLinear(*POSE, (0, 0, 0, 0), 0.25, 0.01),
    m.AddCircular(*POSE, *POSE, (0, 0, 0, 0), 0.25, 0.01),
    m.AddJoint((0.1, 0.0, 0.0, 0.0, 1.5, 0.0), 1.0, 0.0),
    m.Run(1, 1, 3),
)


class ServerError(AssertionError):
    """The service did not survive, or the arm moved for somebody who may not move it."""


class AbbServer:
    """One controller serves all inputs. An input says the port, the pace, and the bytes."""

    name = "abb-server"
    modules: Sequence[str] = ()
    # What the peer's bytes reach is compiled RAPID.
    prefixes: tuple[str, ...] = ("<Bp",)

    def __init__(self) -> None:
        world = World()
        self._loop = LockstepLoop(world)
        self._controller, self._connector = shipped_controller(world)
        self._loop.run_until_complete(self._start())
        self._joints_rad = world.arm.measured_rad

    def seeds(self) -> list[bytes]:
        """A greeting, and each request after it."""
        hello = encode(1, m.Hello(1, 0, 0))
        requests: list[m.Message] = [
            m.Identify(),
            m.AskState(),
            m.AskSignals(),
            m.Stop(),
            m.Ping(),
            m.Write(1, 1),
            m.Pulse(1, 0.1),
            m.WaitFor(0, 1, 1, 0.1),
        ]
        frames = [hello + encode(2, request) for request in requests]
        frames += [encode(2, message) for message in MOTION]
        frames.append(b"".join(encode(3, message) for message in MOTION[-2:]))
        return [bytes([door, 60]) + frame for frame in frames for door in (0, 1, 2)]

    def pieces(self) -> list[bytes]:
        """Frames, headers, lengths that lie."""
        frames = [seed[2:] for seed in self.seeds()]
        lies = [
            b"\xb1\x30\xff\xff\0\0\0\1",
            b"\xb1\x10\x00\x01\0\0\0\1",
            b"\xb1\x30\0\0\xff\xff\xff\xff",
        ]
        return [
            *frames,
            *(frame[14:] for frame in frames),
            *lies,
            b"GET / HTTP/1.1\r\n\r\n",
            b"\xb1",
        ]

    def run(self, data: bytes) -> None:
        """Be a hostile client, then a good one."""
        self._loop.run_until_complete(self._attack(data))

    async def _start(self) -> None:
        await self._controller.power_on()
        await self._controller.start()
        await asyncio.sleep(0.1)

    async def _attack(self, data: bytes) -> None:
        head = data[:2].ljust(2, b"\0")
        step, pause_s = head[1] % 61 + 1, PAUSES_S[head[1] // 64]
        if head[0] & 2:
            await self._attack_as_motion_client(data[2:], step, pause_s)
        else:
            port = MONITOR_PORT if head[0] & 1 else MOTION_PORT
            with contextlib.suppress(OSError):
                stream = await self._connector.connect(port)
                await self._send(stream, data[2:], step, pause_s)
        await asyncio.sleep(SETTLING_S)
        await self._be_served()

    async def _attack_as_motion_client(self, data: bytes, step: int, pause_s: float) -> None:
        """With a live monitor connection and a greeting: such a client may move the arm."""
        session = await Session.join(self._connector, "fuzz", MONITOR_PORT)
        with contextlib.suppress(OSError):
            stream = await self._connector.connect(MOTION_PORT)
            await stream.send(encode(1, m.Hello(1, 0, session.welcome.epoch)))
            await self._send(stream, data, step, pause_s)
        await session.leave()
        await asyncio.sleep(SETTLING_S)
        self._joints_rad = self._controller.world.arm.measured_rad

    async def _send(self, stream: Transport, data: bytes, step: int, pause_s: float) -> None:
        with contextlib.suppress(ConnectionError):
            for k in range(0, len(data), step):
                await stream.send(data[k : k + step])
                await asyncio.sleep(pause_s)
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(PATIENCE_S):
                    while await stream.receive(4096):
                        pass
        stream.close()

    async def _be_served(self) -> None:
        if not self._controller.is_running or self._controller.has_failed:
            raise ServerError("the RAPID program stopped")
        moved = abs(self._controller.world.arm.measured_rad - self._joints_rad).max()
        if moved > 1e-3:
            raise ServerError(f"the arm moved by {moved:.4f} rad")
        robot = RapidRobot(self._connector)
        try:
            await robot.open()
            await robot.state()
            await robot.set_acceleration(1.0)
        except DeviceError as error:
            raise ServerError(f"the next client was not served: {error}") from error
        finally:
            await robot.close()
        await asyncio.sleep(SETTLING_S)
