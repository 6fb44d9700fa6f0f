"""What a mechanical unit has queued."""

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from sims.motion import Leg, Pace, Way, Zone

__all__ = ["Happening", "Move", "Stored"]


@dataclass(eq=False)
class Happening:
    """Something to do at a place on a move, ``lead_s`` earlier than the arm gets there.

    ``distance_m`` is the way to the move's end there (``is_from_start``: from its start). With
    ``is_at_corner`` it is the middle of the corner at the move's end, or where the arm stands.
    """

    action: Callable[[], None]
    distance_m: float = 0.0
    lead_s: float = 0.0
    is_from_start: bool = False
    is_at_corner: bool = False
    place: float = 0.0


@dataclass(eq=False)
class Move:
    """One queued move: ``zone`` None means that the arm stands at its end."""

    leg: Leg
    pace: Pace
    zone: Zone | None
    happenings: Sequence[Happening] = ()
    until: float = np.inf
    ended: "asyncio.Future[None] | None" = field(default=None, repr=False)
    is_awaited: bool = False


@dataclass(frozen=True, eq=False)
class Stored:
    """A path put aside by StorePath."""

    way: Way
    place: float
    moves: tuple[Move, ...]
