"""The vacuum cup."""

from abc import abstractmethod
from dataclasses import dataclass

from hal.device import Device
from hal.motion import Motion

__all__ = ["VacuumState", "VacuumTool"]


@dataclass(frozen=True)
class VacuumState:
    """``vacuum_pa`` is below atmosphere, positive; ``None``: this tool has no gauge."""

    stamp_s: float
    vacuum_pa: float | None
    has_part: bool
    is_sucking: bool


class VacuumTool(Device):
    """Suction, blow-off, part present. Never blows on connecting."""

    @abstractmethod
    def pick(self, *, timeout_s: float = 1.0) -> Motion[VacuumState]:
        """Suck until a part is present or the time is up: see ``has_part`` of the result.

        Raises
        ------
        ValueError
            ``timeout_s`` <= 0.
        """

    @abstractmethod
    def release(self, *, blow_s: float = 0.2) -> Motion[VacuumState]:
        """Vent, and blow the part off for ``blow_s`` (0: do not blow).

        Raises
        ------
        ValueError
            ``blow_s`` outside 0..0.5 s.
        """

    @abstractmethod
    async def state(self) -> VacuumState:
        """A snapshot."""
