"""Moves joined to one way, and the limits that hold along it.

A way is a value: adding to it makes another one, so that whoever plays it is not disturbed.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drivers.arms import Kinematics
from sims.motion.corners import Piece, corner_between
from sims.motion.leg import Leg
from sims.motion.limits import limits_of, widened
from sims.motion.pace import Pace, Zone
from sims.motion.timing import Grid

__all__ = ["Way"]

Array = NDArray[np.float64]

LEAST = 1e-9


@dataclass(frozen=True, eq=False)
class Way:
    """Pieces one behind the other; ``stands`` are the places at which the arm must stand."""

    pieces: tuple[Piece, ...] = ()
    stands: tuple[float, ...] = ()

    @property
    def end(self) -> float:
        """Where it ends."""
        return self.pieces[-1].until if self.pieces else 0.0

    def joined(
        self,
        kinematics: Kinematics,
        tool: Array,
        leg: Leg,
        pace: Pace,
        *,
        zone: Zone | None = None,
        not_before: float = 0.0,
    ) -> "tuple[Way, float]":
        """Add a leg; with a zone, round the corner before it.

        ``not_before`` is the place the arm has reached: a corner cannot begin there any more.
        Returns the way and the place at which the leg begins: the middle of its corner, or the
        place where the arm stands between the two.
        """
        corner = self._corner(kinematics, tool, leg, zone, not_before) if zone else None
        if corner is None:
            piece = Piece(leg, self.end, 0.0, leg.length, pace)
            stands = (*self.stands, self.end) if self.pieces else ()
            return Way((*self.pieces, piece), stands), self.end
        last, between, leaving = corner
        round_it = Piece(between, last.until, 0.0, between.length, last.pace, pace)
        piece = Piece(leg, round_it.until, leaving, leg.length, pace)
        way = Way((*self.pieces[:-1], last, round_it, piece), self.stands)
        return way, last.until + between.length / 2

    def _corner(
        self, kinematics: Kinematics, tool: Array, leg: Leg, zone: Zone, not_before: float
    ) -> tuple[Piece, Leg, float] | None:
        if not self.pieces or leg.length <= 0:
            return None
        last = self.pieces[-1]
        before = last.leg
        entry = max(
            before.length_before_end(zone.distance_m, zone.angle_rad),
            before.length / 2,
            last.begin,
        )
        if last.at + entry - last.begin < not_before:
            return None
        leaving = min(leg.length_after_start(zone.distance_m, zone.angle_rad), leg.length / 2)
        between = corner_between(kinematics, tool, (before, entry), (leg, leaving))
        return None if between is None else (last.ended_at(entry), between, leaving)

    def without_passed(self, place: float) -> "Way":
        """Forget the pieces that lie behind; places keep their meaning."""
        first = next((k for k, p in enumerate(self.pieces[:-1]) if p.until >= place), None)
        if first is None:
            first = max(0, len(self.pieces) - 1)
        return replace(
            self,
            pieces=self.pieces[first:],
            stands=tuple(s for s in self.stands if s > place),
        )

    def joints_rad(self, places: Array) -> Array:
        """Joints at places, shape (n, 6)."""
        starts = np.array([piece.at for piece in self.pieces[1:]])
        which = np.searchsorted(starts, places, side="right")
        joints = np.empty((len(places), 6))
        for k in np.unique(which):
            piece, here = self.pieces[k], which == k
            inside = np.clip(places[here] - piece.at + piece.begin, piece.begin, piece.end)
            joints[here] = piece.leg.joints_rad(inside)
        return joints

    def grid(
        self,
        start: float,
        *,
        ratio: float = 1.0,
        most_mps: float = np.inf,
        smoothing_s: float = 0.0,
    ) -> Grid:
        """The limits from a place to the end.

        ``ratio`` scales all speeds; ``most_mps`` bounds the tool's, whatever a move says. The
        run is going to be averaged over ``smoothing_s``: slow places are widened by that.
        """
        parts = [limits_of(piece, start, most_mps) for piece in self._ahead(start)]
        places, fastest, speeding, slowing = (
            np.concatenate([part[k] for part in parts]) for k in range(4)
        )
        fastest = widened(places, fastest * ratio**2, smoothing_s)
        for stand in self.stands:
            fastest[np.abs(places - stand) < LEAST] = 0.0
        return Grid(places, fastest, speeding, slowing)

    def _ahead(self, start: float) -> Iterator[Piece]:
        for piece in self.pieces:
            if piece.until > start or piece is self.pieces[-1]:
                yield piece

    def stopping_grid(self, start: float, joint_radps2: Array) -> Grid:
        """The limits of a stop: what the joints can brake, whatever the move says."""
        parts = [limits_of(piece, start, np.inf) for piece in self._ahead(start)]
        slowing = np.concatenate([part.hardest_stop(joint_radps2) for part in parts])
        return replace(self.grid(start), slowing=slowing)
