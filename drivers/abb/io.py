"""The controller's digital signals as a ``hal.DigitalIo``, over the monitor connection."""

import asyncio
import contextlib
from collections.abc import Mapping
from types import MappingProxyType

from drivers.abb.messages import Accepted, Code, ControllerState, Pulse, Refused, WaitFor, Write
from drivers.abb.session import MONITOR_PORT, REPLY_TIMEOUT_S, Session, expected
from drivers.transports import Connector
from hal import DigitalIo, Direction, Identity, Motion
from hal.errors import CellError, DeviceTimeoutError, LinkError

__all__ = ["RapidIo"]

LONGEST_PULSE_S = 2000.0


class RapidIo(DigitalIo):
    """Inputs and outputs as the controller package names them (``BP_INPUTS``, ``BP_OUTPUTS``).

    It works whatever the arm does, and with the program stopped. Shares the connection of a
    robot with the same address.
    """

    def __init__(
        self, connector: Connector, *, name: str = "io", monitor_port: int = MONITOR_PORT
    ) -> None:
        self.name = name
        self._connector = connector
        self._port = monitor_port
        self._session: Session | None = None
        self._opening = asyncio.Lock()
        self._signals: dict[str, Direction] = {}
        self._numbers: dict[str, int] = {}

    @property
    def signals(self) -> Mapping[str, Direction]:
        return MappingProxyType(self._signals)

    @property
    def is_open(self) -> bool:
        return self._session is not None and self._session.is_open

    async def open(self) -> None:
        async with self._opening:
            if not self.is_open:
                await self.close()
                await self._join()

    async def _join(self) -> None:
        session = await Session.join(self._connector, self.name, self._port)
        names = session.signals
        self._signals = {
            **dict.fromkeys(names.inputs, Direction.INPUT),
            **dict.fromkeys(names.outputs, Direction.OUTPUT),
        }
        for group in (names.inputs, names.outputs):
            self._numbers.update({name: number for number, name in enumerate(group, 1)})
        self._session = session

    async def close(self) -> None:
        session, self._session = self._session, None
        if session is not None:
            await session.leave()

    async def identity(self) -> Identity:
        identity = await self._linked().who()
        return Identity("ABB", f"{identity.robot_type} I/O", identity.serial, identity.version)

    async def read(self, name: str) -> bool:
        self._check(name)
        return self._value(await self._linked().fresh_state(), name)

    def write(self, name: str, value: bool) -> Motion[None]:
        self._check_output(name)
        return Motion(self._write(name, value), name=f"{self.name} write")

    def pulse(self, name: str, duration_s: float) -> Motion[None]:
        self._check_output(name)
        if not 0 < duration_s <= LONGEST_PULSE_S:
            raise ValueError(f"a pulse of {duration_s:g} s is not in 0..{LONGEST_PULSE_S:g} s")
        return Motion(self._pulse(name, duration_s), name=f"{self.name} pulse")

    def wait_for(self, name: str, value: bool, *, timeout_s: float) -> Motion[None]:
        self._check(name)
        if not timeout_s > 0:
            raise ValueError(f"a time-out is longer than {timeout_s:g} s")
        return Motion(self._wait_for(name, value, timeout_s), name=f"{self.name} wait_for")

    def _linked(self) -> Session:
        if self._session is None:
            raise LinkError("is not open", device=self.name)
        if self._session.channel.error is not None:
            raise LinkError("the link is gone; reopen the device", device=self.name)
        return self._session

    def _check(self, name: str) -> None:
        if name not in self._signals:
            known = ", ".join(self._signals) or "none before it is opened"
            raise ValueError(f"no signal {name!r}; there are {known}")

    def _check_output(self, name: str) -> None:
        self._check(name)
        if self._signals[name] is not Direction.OUTPUT:
            raise ValueError(f"{name} is an input")

    def _value(self, state: ControllerState, name: str) -> bool:
        is_input = self._signals[name] is Direction.INPUT
        bits = state.inputs if is_input else state.outputs
        return bool(bits >> (self._numbers[name] - 1) & 1)

    async def _write(self, name: str, value: bool) -> None:
        await self._linked().ask(Write(self._numbers[name], int(value)), Accepted)

    async def _pulse(self, name: str, duration_s: float) -> None:
        session = self._linked()
        await session.ask(Pulse(self._numbers[name], duration_s), Accepted)
        try:
            await asyncio.sleep(duration_s)
            await session.until(lambda state: not self._value(state, name))
        except asyncio.CancelledError:
            with contextlib.suppress(CellError):
                await self._write(name, False)
            raise
        self._linked()

    async def _wait_for(self, name: str, value: bool, timeout_s: float) -> None:
        session = self._linked()
        is_output = self._signals[name] is Direction.OUTPUT
        request = WaitFor(int(is_output), self._numbers[name], int(value), timeout_s)
        # The controller keeps the time; ours is only for a controller that has gone.
        patience_s = timeout_s + REPLY_TIMEOUT_S
        answer = await session.channel.ask(request, timeout_s=patience_s)
        if isinstance(answer, Refused) and answer.code is Code.TIMED_OUT:
            raise DeviceTimeoutError(
                device=self.name, action=f"wait for {name}", timeout_s=timeout_s
            )
        expected(answer, Accepted, self.name)
