"""What every device is: named, opened, closed."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from types import TracebackType
from typing import Self

__all__ = ["Device", "Identity"]


@dataclass(frozen=True)
class Identity:
    """Who a device says it is; empty strings where it does not say."""

    vendor: str
    model: str
    serial: str = ""
    firmware: str = ""


class Device(ABC):
    """A device's lifecycle.

    ``open`` reads the device's state and never moves anything; opening an open device and
    closing a closed one change nothing. Commands of a closed device raise ``LinkError``.
    """

    name: str

    @property
    @abstractmethod
    def is_open(self) -> bool:
        """Whether commands may be given."""

    @abstractmethod
    async def open(self) -> None:
        """Connect and read the state.

        Raises
        ------
        LinkError
            The device cannot be reached.
        """

    @abstractmethod
    async def close(self) -> None:
        """Let go of the device; a motion under way is stopped first."""

    @abstractmethod
    async def identity(self) -> Identity:
        """Vendor, model, serial number, firmware."""

    async def __aenter__(self) -> Self:
        await self.open()
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.close()
