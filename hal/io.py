"""Digital signals by name."""

from abc import abstractmethod
from collections.abc import Mapping
from enum import StrEnum

from hal.device import Device
from hal.motion import Motion

__all__ = ["DigitalIo", "Direction"]


class Direction(StrEnum):
    """Seen from the controller."""

    INPUT = "input"
    OUTPUT = "output"


class DigitalIo(Device):
    """A block of named signals."""

    @property
    @abstractmethod
    def signals(self) -> Mapping[str, Direction]:
        """What there is."""

    @abstractmethod
    async def read(self, name: str) -> bool:
        """An input, or an output as last set.

        Raises
        ------
        ValueError
            No such signal; names the ones there are.
        """

    @abstractmethod
    def write(self, name: str, value: bool) -> Motion[None]:
        """Set an output.

        Raises
        ------
        ValueError
            No such signal, or an input.
        """

    @abstractmethod
    def pulse(self, name: str, duration_s: float) -> Motion[None]:
        """Set an output, wait, clear it; cleared also when cancelled.

        Raises
        ------
        ValueError
            As ``write``, or ``duration_s`` <= 0.
        """

    @abstractmethod
    def wait_for(self, name: str, value: bool, *, timeout_s: float) -> Motion[None]:
        """Wait until a signal has a value; at once if it has.

        Raises
        ------
        ValueError
            No such signal, or ``timeout_s`` <= 0.
        DeviceTimeoutError
            It did not come.
        """
