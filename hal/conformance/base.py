"""What all conformance suites share: the bench, the guard, the promises of every device."""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import pytest

from hal.conformance.stage import Stage
from hal.device import Device
from hal.errors import LinkError

__all__ = ["DECLARED", "Bench", "Conformance", "cancel_all"]

DECLARED = "declared: "


@dataclass
class Bench:
    """One device, closed, with the loop it runs on and the stage around it."""

    loop: asyncio.AbstractEventLoop
    device: Device
    stage: Stage


class Conformance(ABC):
    """The promises of ``hal.Device``; each interface has a subclass with its own.

    ``backend`` is the registered name, ``wire`` tells apart ways to reach it. ``lacks`` maps a
    promise or an ability of the stage to the reason why it is not there.
    """

    backend: ClassVar[str] = ""
    wire: ClassVar[str] = ""
    interface: ClassVar[str] = "device"
    lacks: ClassVar[Mapping[str, str]] = {}

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        inherited = {
            name
            for base in cls.__mro__[1:]
            if issubclass(base, Conformance)
            for name in vars(base)
            if name.startswith("test_")
        }
        replaced = sorted(inherited & set(vars(cls)))
        if replaced:
            raise TypeError(
                f"{cls.__name__} replaces promises: {', '.join(replaced)}; a promise that cannot "
                "be kept belongs in 'lacks', with the reason"
            )
        if cls.backend and (extra := [n for n in vars(cls) if n.startswith("test_")]):
            raise TypeError(f"{cls.__name__} adds promises of its own: {', '.join(extra)}")

    @abstractmethod
    def make_bench(self) -> Bench:
        """Make a fresh device; every promise gets its own."""

    async def prepare(self, device: Any) -> None:
        """Bring a freshly opened device to where its promises begin."""
        assert device.is_open

    @pytest.fixture(autouse=True)
    def bench(self, request: pytest.FixtureRequest) -> Iterator[Bench]:
        """Open the device before a promise, close it after."""
        bench = self.make_bench()
        loop = bench.loop
        try:
            loop.run_until_complete(bench.device.open())
            if request.node.get_closest_marker("unprepared") is None:
                loop.run_until_complete(self.prepare(bench.device))
            yield bench
            loop.run_until_complete(bench.device.close())
        finally:
            cancel_all(loop)
            loop.close()

    @pytest.fixture
    def device(self, bench: Bench) -> Any:
        return bench.device

    @pytest.fixture
    def stage(self, bench: Bench) -> Stage:
        return bench.stage

    async def test_opening_an_open_device_changes_nothing(self, device: Device) -> None:
        assert device.is_open
        await device.open()
        assert device.is_open
        await device.identity()

    async def test_closing_twice_is_harmless(self, device: Device) -> None:
        await device.close()
        assert not device.is_open
        await device.close()
        assert not device.is_open

    async def test_a_closed_device_refuses_to_speak(self, device: Device) -> None:
        await device.close()
        with pytest.raises(LinkError) as caught:
            await device.identity()
        assert caught.value.device == device.name

    async def test_a_closed_device_can_be_opened_again(self, device: Device) -> None:
        await device.close()
        await device.open()
        assert device.is_open
        await device.identity()

    async def test_it_says_who_it_is(self, device: Device) -> None:
        identity = await device.identity()
        assert identity.vendor
        assert identity.model

    async def test_a_cut_link_is_an_error_until_it_is_reopened(
        self, device: Device, stage: Stage
    ) -> None:
        await stage.cut_link()
        with pytest.raises(LinkError):
            await device.identity()
        assert not device.is_open
        with pytest.raises(LinkError):
            await device.open()
        await stage.restore_link()
        await device.open()
        await device.identity()

    async def test_leaving_the_with_block_closes_it(self, device: Device) -> None:
        await device.close()
        async with device as same:
            assert same is device
            assert device.is_open
        assert not device.is_open


def cancel_all(loop: asyncio.AbstractEventLoop) -> None:
    """Cancel what a loop still has to do, and let it end."""
    tasks = asyncio.all_tasks(loop)
    for task in tasks:
        task.cancel()
    if tasks:
        loop.run_until_complete(asyncio.gather(*tasks, return_exceptions=True))
