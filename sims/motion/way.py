"""Moves joined to one way, and the limits that hold along it.

A way is a value: adding to it makes another one, so that whoever plays it is not disturbed.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drivers.arms import Kinematics
from sims.motion.corners import Piece, corner_between
from sims.motion.legs import Leg
from sims.motion.pace import Pace, Zone
from sims.motion.timing import Grid

__all__ = ["Way"]

Array = NDArray[np.float64]

JOINT_BEND_SHARE = 0.5  # of an acceleration, for what the way's bends need
TOOL_BEND_SHARE = 0.9
JOINT_SPEED_SHARE = 0.985  # smoothing may carry speed a little into a narrow place
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

    def grid(self, start: float, *, ratio: float = 1.0, most_mps: float = np.inf) -> Grid:
        """The limits from a place to the end.

        ``ratio`` scales all speeds; ``most_mps`` bounds the tool's, whatever a move says.
        """
        parts = [self._limits(piece, start, most_mps) for piece in self._ahead(start)]
        places, fastest, speeding, slowing = (
            np.concatenate(rows) for rows in zip(*parts, strict=True)
        )
        fastest = fastest * ratio**2
        for stand in self.stands:
            fastest[np.abs(places - stand) < LEAST] = 0.0
        return Grid(places, fastest, speeding, slowing)

    def _ahead(self, start: float) -> Iterator[Piece]:
        for piece in self.pieces:
            if piece.until > start or piece is self.pieces[-1]:
                yield piece

    def _limits(
        self, piece: Piece, start: float, most_mps: float
    ) -> tuple[Array, Array, Array, Array]:
        leg = piece.leg
        first = min(piece.begin + max(0.0, start - piece.at), piece.end)
        inner = leg.knots[(leg.knots > first + LEAST) & (leg.knots < piece.end - LEAST)]
        if len(inner) == 0:
            inner = np.array([(first + piece.end) / 2])
        at = np.concatenate([[first], inner, [piece.end]])
        slope, bend = np.abs(leg.curve(at, 1)), np.abs(leg.curve(at, 2))
        tool = [np.interp(at, leg.knots, v) for v in (leg.tcp_rate, leg.turn_rate, leg.tcp_bend)]
        rows = self._paced(leg, piece.pace, slope, bend, tool, most_mps)
        if piece.next_pace is not None:
            others = self._paced(leg, piece.next_pace, slope, bend, tool, most_mps)
            later = at > leg.length / 2
            rows = tuple(np.where(later, b, a) for a, b in zip(rows, others, strict=True))
        fastest, speeding, slowing = rows
        return piece.at + at - piece.begin, fastest, speeding, slowing

    def _paced(
        self, leg: Leg, pace: Pace, slope: Array, bend: Array, tool: list[Array], most_mps: float
    ) -> tuple[Array, ...]:
        tcp, turn, tcp_bend = (np.maximum(v, LEAST) for v in tool)
        slope, bend = np.maximum(slope, LEAST), np.maximum(bend, LEAST)
        speed = np.minimum(min(pace.tcp_mps, most_mps) / tcp, pace.turn_radps / turn)
        joints = (JOINT_SPEED_SHARE * pace.joint_radps / slope).min(axis=1)
        fastest = np.minimum(np.minimum(speed, joints), pace.way_radps) ** 2
        fastest = np.minimum(fastest, (JOINT_BEND_SHARE * pace.joint_radps2 / bend).min(axis=1))
        if leg.is_cartesian:
            fastest = np.minimum(fastest, TOOL_BEND_SHARE * pace.tcp_mps2 / tcp_bend)
        most = ((pace.joint_radps2 - bend * fastest[:, None]) / slope).min(axis=1)
        if not leg.is_cartesian:
            return fastest, most, most
        most = np.minimum(most, pace.turn_radps2 / turn)
        # Across the way and along it: the tool's acceleration is the hypotenuse.
        across = np.minimum(fastest * tcp_bend, TOOL_BEND_SHARE * pace.tcp_brake_mps2)
        speeding = np.sqrt(pace.tcp_mps2**2 - (fastest * tcp_bend) ** 2) / tcp
        slowing = np.sqrt(pace.tcp_brake_mps2**2 - across**2) / tcp
        return fastest, np.minimum(most, speeding), np.minimum(most, slowing)

    def stopping_grid(self, start: float, joint_radps2: Array) -> Grid:
        """The limits of a stop: what the joints can brake, whatever the move says."""
        grid = self.grid(start)
        slowing = np.concatenate(
            [self._hardest(piece, start, joint_radps2) for piece in self._ahead(start)]
        )
        return replace(grid, slowing=slowing)

    def _hardest(self, piece: Piece, start: float, joint_radps2: Array) -> Array:
        leg = piece.leg
        first = min(piece.begin + max(0.0, start - piece.at), piece.end)
        inner = leg.knots[(leg.knots > first + LEAST) & (leg.knots < piece.end - LEAST)]
        if len(inner) == 0:
            inner = np.array([(first + piece.end) / 2])
        at = np.concatenate([[first], inner, [piece.end]])
        slope = np.maximum(np.abs(leg.curve(at, 1)), LEAST)
        return np.asarray((joint_radps2 / slope).min(axis=1))
