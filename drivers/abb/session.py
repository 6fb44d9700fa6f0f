"""The monitor connection, shared by the devices of one controller: state, heartbeat, stop."""

import asyncio
import contextlib
from collections.abc import Callable
from typing import TypeVar
from weakref import WeakKeyDictionary

from drivers.abb.channel import Channel
from drivers.abb.checklist import connection_advice, refusal
from drivers.abb.messages import (
    MAJOR,
    MINOR,
    AskSignals,
    AskState,
    ControllerState,
    Frame,
    Hello,
    Identify,
    IdentityReply,
    Message,
    Ping,
    Refused,
    SignalNames,
    Stop,
    Welcome,
)
from drivers.transports import Connector
from hal.errors import DeviceError, DeviceTimeoutError, LinkError, RemoteProtocolError

__all__ = ["MONITOR_PORT", "MOTION_PORT", "Session"]

MOTION_PORT, MONITOR_PORT = 5010, 5011
CONNECT_TIMEOUT_S = 3.0
REPLY_TIMEOUT_S = 2.0
STOP_TIMEOUT_S = 5.0
HEARTBEATS_PER_WATCHDOG = 4
LONGEST_SILENCE_S = 1.0
TURN_S = 64.0

M = TypeVar("M")

_SESSIONS: "WeakKeyDictionary[Connector, Session]" = WeakKeyDictionary()
_LOCKS: "WeakKeyDictionary[Connector, asyncio.Lock]" = WeakKeyDictionary()


def expected(message: Message, kind: type[M], device: str) -> M:
    """Return the answer if it is of the kind, else raise what it says instead.

    Raises
    ------
    CellError
        It was refused; see ``checklist.refusal``.
    RemoteProtocolError
        Another kind of answer.
    """
    if isinstance(message, kind):
        return message
    if isinstance(message, Refused):
        raise refusal(device, message.code, at=message.at)
    raise RemoteProtocolError(f"{type(message).__name__} instead of {kind.__name__}", device=device)


class Session:
    """One epoch: from connecting to the monitor task until the connection ends."""

    def __init__(self, connector: Connector, device: str) -> None:
        self.connector = connector
        self.device = device
        self.welcome: Welcome
        self.signals: SignalNames
        self.state: ControllerState
        self.channel: Channel
        self._users = 0
        self._clock_s = 0.0
        self._heard_s = 0.0
        self._waiting: list[tuple[Callable[[ControllerState], bool], asyncio.Future[None]]] = []
        self._heart: asyncio.Task[None] | None = None

    @classmethod
    async def join(cls, connector: Connector, device: str, port: int) -> "Session":
        """Share the controller's session, or begin one.

        Raises
        ------
        LinkError
            The controller cannot be reached; says what to check.
        """
        lock = _LOCKS.setdefault(connector, asyncio.Lock())
        async with lock:
            session = _SESSIONS.get(connector)
            if session is None or not session.is_open:
                session = cls(connector, device)
                await session._connect(port)
                _SESSIONS[connector] = session
            session._users += 1
            return session

    @property
    def is_open(self) -> bool:
        """Whether the connection holds."""
        return self.channel.is_open

    async def leave(self) -> None:
        """The last one out closes it."""
        self._users -= 1
        if self._users <= 0:
            await self._close()

    def check(self) -> None:
        """Refuse to go on without a connection.

        Raises
        ------
        LinkError
            It is gone.
        """
        if self.channel.error is not None:
            raise LinkError("the link is gone; reopen the device", device=self.device)

    async def ask(
        self, message: Message, kind: type[M], *, timeout_s: float = REPLY_TIMEOUT_S
    ) -> M:
        """Ask on the monitor connection; see ``expected`` and ``Channel.ask``."""
        return expected(await self.channel.ask(message, timeout_s=timeout_s), kind, self.device)

    async def fresh_state(self) -> ControllerState:
        """Ask for the state now."""
        self._take_state(await self.ask(AskState(), ControllerState))
        return self.state

    async def who(self) -> IdentityReply:
        """Ask who it is."""
        return await self.ask(Identify(), IdentityReply)

    def stamp_s(self, state: ControllerState) -> float:
        """Return the controller's time of a state, on the loop's clock."""
        return self._clock_s + state.turns * TURN_S + state.time_s

    async def stop(self) -> None:
        """Brake, clear the path, and wait until the arm stands."""
        answer = await self.channel.ask(Stop(), timeout_s=STOP_TIMEOUT_S)
        if isinstance(answer, Refused):
            raise refusal(self.device, answer.code)
        await self.until(lambda state: not state.flags & state.flags.MOVING)

    async def until(
        self, condition: Callable[[ControllerState], bool], *, timeout_s: float = STOP_TIMEOUT_S
    ) -> None:
        """Wait until a state fulfils the condition.

        Raises
        ------
        DeviceTimeoutError
            None did in time.
        LinkError
            The connection ended.
        """
        try:
            async with asyncio.timeout(timeout_s):
                await self.reached(condition)
        except TimeoutError as error:
            raise DeviceTimeoutError(
                device=self.device, action="wait for the state", timeout_s=timeout_s
            ) from error

    def reached(self, condition: Callable[[ControllerState], bool]) -> "asyncio.Future[None]":
        """Return a future that is done when a state from now on fulfils the condition."""
        future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        if self.channel.error is not None:
            future.set_exception(self.channel.error)
        else:
            self._waiting.append((condition, future))
        return future

    async def _connect(self, port: int) -> None:
        self.channel = await Channel.connect(
            self.connector,
            port,
            device=self.device,
            name="monitor",
            timeout_s=CONNECT_TIMEOUT_S,
            on_event=self._hear,
        )
        self.channel.on_end(self._ended)
        try:
            self.welcome = await self.ask(Hello(MAJOR, MINOR, 0), Welcome)
            self._heard_s = asyncio.get_running_loop().time()
            self._heart = asyncio.get_running_loop().create_task(self._beat(), name="abb heartbeat")
            self.signals = await self.ask(AskSignals(), SignalNames)
            self.state = await self.ask(AskState(), ControllerState)
        except DeviceError as error:
            await self._close()
            where = f"{self.connector.where} port {port}"
            why = str(error).removeprefix(f"{self.device}: ")
            advice = connection_advice(port, was_refused=False)
            raise LinkError(
                f"{where} does not answer as binpick's monitor does ({why}); {advice}",
                device=self.device,
            ) from error
        except BaseException:
            await self._close()
            raise
        own_s = self.state.turns * TURN_S + self.state.time_s
        self._clock_s = asyncio.get_running_loop().time() - own_s

    async def _close(self) -> None:
        if self._heart is not None:
            self._heart.cancel()
        await self.channel.close()
        if self._heart is not None:
            with contextlib.suppress(asyncio.CancelledError):
                await self._heart

    def _ended(self) -> None:
        if self._heart is not None and self._heart is not asyncio.current_task():
            self._heart.cancel()
        assert self.channel.error is not None
        for _, future in self._waiting:
            if not future.done():
                future.set_exception(self.channel.error)
        self._waiting.clear()

    def _hear(self, frame: Frame) -> None:
        if not isinstance(frame.message, ControllerState):
            raise RemoteProtocolError(
                f"{type(frame.message).__name__} came unasked", device=self.device
            )
        self._take_state(frame.message)

    def _take_state(self, state: ControllerState) -> None:
        self.state = state
        self._heard_s = asyncio.get_running_loop().time()
        if not self._waiting:
            return
        still = []
        for condition, future in self._waiting:
            if future.done():
                continue
            if condition(state):
                future.set_result(None)
            else:
                still.append((condition, future))
        self._waiting = still

    async def _beat(self) -> None:
        """Be heard well within the controller's watchdog; notice when it falls silent."""
        loop = asyncio.get_running_loop()
        while True:
            await asyncio.sleep(self.welcome.watchdog_s / HEARTBEATS_PER_WATCHDOG)
            silence_s = loop.time() - self._heard_s
            if silence_s > LONGEST_SILENCE_S:
                self.channel.end(
                    LinkError(
                        f"the controller has been silent for {silence_s:.1f} s; reopen the device",
                        device=self.device,
                    )
                )
                return
            with contextlib.suppress(DeviceError):
                await self.channel.tell(Ping())
