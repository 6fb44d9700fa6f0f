"""Hands at a simulated controller for the conformance suites; only tests import this."""

import asyncio
from typing import Protocol

from hal import OperatingMode
from sims.controller.controller import Controller
from sims.direct.stage import WorldStage

__all__ = ["Cable", "ControllerStage"]

# Relays switch and system outputs follow within this time.
NOTICED_S = 0.02


class Cable(Protocol):
    """What can be pulled out."""

    def cut(self) -> None:
        """Pull it."""

    def mend(self) -> None:
        """Plug it in."""


class ControllerStage(WorldStage):
    """The operator: what stops the program is mended, and then Start is pressed."""

    def __init__(self, controller: Controller, cable: Cable) -> None:
        super().__init__(controller.world, "controller")
        self.controller = controller
        self._cable = cable

    async def cut_link(self) -> None:
        self._cable.cut()

    async def restore_link(self) -> None:
        self._cable.mend()

    async def press_emergency_stop(self) -> None:
        await super().press_emergency_stop()
        await asyncio.sleep(NOTICED_S)

    async def release_emergency_stop(self) -> None:
        await super().release_emergency_stop()
        await self._start()

    async def press_protective_stop(self) -> None:
        await super().press_protective_stop()
        await asyncio.sleep(NOTICED_S)

    async def release_protective_stop(self) -> None:
        await super().release_protective_stop()
        await self._start()

    async def switch_motors(self, is_on: bool) -> None:
        await super().switch_motors(is_on)
        await asyncio.sleep(NOTICED_S)
        if is_on:
            await self._start()

    async def turn_key(self, mode: OperatingMode) -> None:
        await super().turn_key(mode)
        await asyncio.sleep(NOTICED_S)
        if mode is OperatingMode.AUTO:
            await self._start()

    async def set_input(self, name: str, value: bool) -> None:
        await super().set_input(name, value)
        await asyncio.sleep(NOTICED_S)

    async def _start(self) -> None:
        await asyncio.sleep(NOTICED_S)
        await self.controller.start()
        await asyncio.sleep(NOTICED_S)
