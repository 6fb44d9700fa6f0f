"""A measured figure, as every bench reports it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

__all__ = ["Figure"]


@dataclass(frozen=True)
class Figure:
    """One number with its spread, and a peer's number from the same run where there is one.

    ``name`` is dotted (``depth.bias_8pairs``); ``value`` is the median of ``n`` repeats or the
    pooled figure over ``n`` samples, as the bench's help says.
    """

    name: str
    value: float
    unit: str
    n: int = 1
    min: float | None = None
    max: float | None = None
    peer: str = ""
    peer_value: float | None = None

    @property
    def ratio(self) -> float | None:
        """Ours over the peer's."""
        return self.value / self.peer_value if self.peer_value else None

    @classmethod
    def median(
        cls,
        name: str,
        values: Sequence[float],
        unit: str,
        *,
        peer: str = "",
        peer_value: float | None = None,
    ) -> Self:
        """The median of repeats, with its range."""
        ordered = sorted(values)
        middle = len(ordered) // 2
        value = ordered[middle] if len(ordered) % 2 else sum(ordered[middle - 1 : middle + 1]) / 2
        return cls(name, value, unit, len(ordered), ordered[0], ordered[-1], peer, peer_value)

    def as_json(self) -> dict[str, object]:
        """The record of ``binpick bench --json``."""
        return {
            "name": self.name,
            "value": self.value,
            "unit": self.unit,
            "n": self.n,
            "min": self.min,
            "max": self.max,
            "peer": self.peer,
            "peer_value": self.peer_value,
            "ratio": self.ratio,
        }
