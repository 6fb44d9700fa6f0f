"""The promises of ``hal.DigitalIo``."""

import asyncio

import pytest

from hal.conformance.base import Conformance
from hal.conformance.stage import Stage
from hal.errors import DeviceTimeoutError, LinkError
from hal.io import DigitalIo, Direction

__all__ = ["IoConformance"]


class IoConformance(Conformance):
    """The first input and the first output must be free to be switched."""

    interface = "io"

    @pytest.fixture
    def io(self, device: DigitalIo) -> DigitalIo:
        return device

    @pytest.fixture
    def output(self, io: DigitalIo) -> str:
        return next(name for name, way in io.signals.items() if way is Direction.OUTPUT)

    @pytest.fixture
    def input_(self, io: DigitalIo) -> str:
        return next(name for name, way in io.signals.items() if way is Direction.INPUT)

    async def test_an_output_reads_as_it_was_set(
        self, io: DigitalIo, output: str, stage: Stage
    ) -> None:
        for value in (True, True, False):
            await io.write(output, value)
            assert await io.read(output) is value
            assert await stage.true_output(output) is value

    async def test_an_input_follows_the_world(
        self, io: DigitalIo, input_: str, stage: Stage
    ) -> None:
        for value in (True, False):
            await stage.set_input(input_, value)
            await asyncio.sleep(0.05)
            assert await io.read(input_) is value

    async def test_unknown_signals_and_inputs_cannot_be_written(
        self, io: DigitalIo, input_: str, output: str
    ) -> None:
        with pytest.raises(ValueError, match=output):
            io.write("no such signal", True)
        with pytest.raises(ValueError, match="no such"):
            await io.read("no such")
        with pytest.raises(ValueError, match=input_):
            io.write(input_, True)
        with pytest.raises(ValueError, match=input_):
            io.pulse(input_, 0.1)
        with pytest.raises(ValueError, match="0"):
            io.pulse(output, 0.0)
        with pytest.raises(ValueError, match="0"):
            io.wait_for(input_, True, timeout_s=0.0)

    async def test_a_pulse_rises_and_falls(self, io: DigitalIo, output: str) -> None:
        pulse = io.pulse(output, 0.2)
        await asyncio.sleep(0.1)
        assert await io.read(output)
        await pulse
        assert not await io.read(output)

    async def test_a_cancelled_pulse_falls_at_once(self, io: DigitalIo, output: str) -> None:
        pulse = io.pulse(output, 5.0)
        await asyncio.sleep(0.1)
        pulse.cancel()
        with pytest.raises(asyncio.CancelledError):
            await pulse
        await asyncio.sleep(0.05)
        assert not await io.read(output)

    async def test_waiting_ends_when_the_signal_comes(
        self, io: DigitalIo, input_: str, stage: Stage
    ) -> None:
        await stage.set_input(input_, False)
        await asyncio.sleep(0.05)
        waiting = io.wait_for(input_, True, timeout_s=2.0)
        await asyncio.sleep(0.1)
        assert not waiting.done()
        await stage.set_input(input_, True)
        await waiting
        await io.wait_for(input_, True, timeout_s=0.1)

    async def test_waiting_gives_up_in_time(self, io: DigitalIo, input_: str, stage: Stage) -> None:
        await stage.set_input(input_, False)
        await asyncio.sleep(0.05)
        with pytest.raises(DeviceTimeoutError) as caught:
            await io.wait_for(input_, True, timeout_s=0.2)
        assert caught.value.timeout_s == 0.2
        assert input_ in caught.value.action

    async def test_a_link_cut_while_waiting_is_an_error(
        self, io: DigitalIo, input_: str, stage: Stage
    ) -> None:
        waiting = io.wait_for(input_, True, timeout_s=5.0)
        await asyncio.sleep(0.1)
        await stage.cut_link()
        with pytest.raises(LinkError):
            await waiting

    async def test_closed_it_neither_reads_nor_writes(self, io: DigitalIo, output: str) -> None:
        await io.close()
        with pytest.raises(LinkError):
            await io.read(output)
        with pytest.raises(LinkError):
            await io.write(output, True)
