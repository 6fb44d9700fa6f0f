"""What a loop drives: something that steps."""

from typing import Protocol

__all__ = ["NoWorld", "Ticker"]


class Ticker(Protocol):
    """A world; ``step`` lets one tick of ``tick_ns`` pass."""

    @property
    def tick_ns(self) -> int:
        """Length of a tick."""

    def step(self) -> None:
        """Go one tick on."""


class NoWorld:
    """Time without a world: nothing happens at the ticks."""

    def __init__(self, tick_ns: int = 2_000_000) -> None:
        self.tick_ns = tick_ns
        self.ticks = 0

    def step(self) -> None:
        """Count."""
        self.ticks += 1
