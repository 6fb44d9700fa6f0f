"""The simulated controller's digital signals as a ``hal.DigitalIo``."""

import asyncio
from collections.abc import Mapping
from types import MappingProxyType

from hal import DigitalIo, Direction, Identity, Motion
from hal.errors import DeviceTimeoutError
from sims.direct.link import DirectLink
from sims.world import World

__all__ = ["DirectIo"]


class DirectIo(DigitalIo):
    """Inputs ``di1``..``di8``, which the world sets, and outputs ``do1``..``do8``."""

    def __init__(self, world: World, *, name: str = "io") -> None:
        self.name = name
        self._world = world
        self._link = DirectLink(world, name, Identity("binpick", "digital I/O", "simulated"))
        cabinet = world.cabinet
        self._signals = {
            **dict.fromkeys(cabinet.inputs, Direction.INPUT),
            **dict.fromkeys(cabinet.outputs, Direction.OUTPUT),
        }

    @property
    def signals(self) -> Mapping[str, Direction]:
        return MappingProxyType(self._signals)

    @property
    def is_open(self) -> bool:
        return self._link.is_open

    async def open(self) -> None:
        self._link.open()

    async def close(self) -> None:
        self._link.close()

    async def identity(self) -> Identity:
        self._link.check()
        return self._link.identity

    async def read(self, name: str) -> bool:
        self._check(name)
        self._link.check()
        return self._value(name)

    def write(self, name: str, value: bool) -> Motion[None]:
        self._check_output(name)
        return Motion(self._write(name, value), name=f"{self.name} write")

    def pulse(self, name: str, duration_s: float) -> Motion[None]:
        self._check_output(name)
        if not duration_s > 0:
            raise ValueError(f"a pulse lasts longer than {duration_s:g} s")
        return Motion(self._pulse(name, duration_s), name=f"{self.name} pulse")

    def wait_for(self, name: str, value: bool, *, timeout_s: float) -> Motion[None]:
        self._check(name)
        if not timeout_s > 0:
            raise ValueError(f"a time-out is longer than {timeout_s:g} s")
        return Motion(self._wait_for(name, value, timeout_s), name=f"{self.name} wait_for")

    def _check(self, name: str) -> None:
        if name not in self._signals:
            raise ValueError(f"no signal {name!r}; there are {', '.join(self._signals)}")

    def _check_output(self, name: str) -> None:
        self._check(name)
        if self._signals[name] is not Direction.OUTPUT:
            raise ValueError(f"{name} is an input")

    def _value(self, name: str) -> bool:
        cabinet = self._world.cabinet
        return cabinet.inputs[name] if name in cabinet.inputs else cabinet.outputs[name]

    async def _write(self, name: str, value: bool) -> None:
        self._link.check()
        self._world.cabinet.outputs[name] = value

    async def _pulse(self, name: str, duration_s: float) -> None:
        await self._write(name, True)
        try:
            await asyncio.sleep(duration_s)
        finally:
            # Also when cancelled; without a link the output stays as it is.
            if self._link.is_open:
                self._world.cabinet.outputs[name] = False
        self._link.check()

    async def _wait_for(self, name: str, value: bool, timeout_s: float) -> None:
        self._link.check()
        try:
            async with asyncio.timeout(timeout_s):
                await self._link.wait(lambda: self._value(name) is value)
        except TimeoutError as error:
            raise DeviceTimeoutError(
                device=self.name, action=f"wait for {name}", timeout_s=timeout_s
            ) from error
