"""How fast each place of a piece of the way may be passed, and how hard one may speed up there."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sims.motion.corners import Piece
from sims.motion.leg import Leg
from sims.motion.pace import Pace

__all__ = ["Limits", "limits_of", "widened"]

Array = NDArray[np.float64]

JOINT_BEND_SHARE = 0.5  # of an acceleration, for what the way's bends need
TOOL_BEND_SHARE = 0.9
JOINT_SPEED_SHARE = 0.999  # rounding must not carry a joint over its limit
LEAST = 1e-9


class Limits(NamedTuple):
    """Along a piece: ``places`` on the way; ``fastest`` the square of the speed; accelerations.

    ``slope`` and ``bend`` are the joints' derivatives, shape (n, 6), not negative.
    """

    places: Array
    fastest: Array
    speeding: Array
    slowing: Array
    slope: Array
    bend: Array

    def hardest_stop(self, joint_radps2: Array) -> Array:
        """How hard the joints can brake along the way, having to follow its bends as well."""
        spare = joint_radps2 - self.bend * self.fastest[:, None]
        return np.asarray((spare / self.slope).min(axis=1))


def limits_of(piece: Piece, start: float, most_mps: float) -> Limits:
    """The limits from a place on the way, or the piece's beginning, to the piece's end.

    Those of a whole piece are kept with it: a way is planned anew at every move that is added.
    """
    if start > piece.at:
        return _computed(piece, start, most_mps)
    kept = piece.kept.get(most_mps)
    if kept is None:
        kept = piece.kept[most_mps] = _computed(piece, piece.at, most_mps)
    return kept


def widened(places: Array, fastest: Array, smoothing_s: float) -> Array:
    """Stretch each slow place so that an average over ``smoothing_s`` is still slow in it."""
    middle = fastest[1:-1]
    lowest = 1 + np.flatnonzero((middle < fastest[:-2]) & (middle <= fastest[2:]))
    wide = fastest.copy()
    for k in lowest:
        reach = float(np.sqrt(fastest[k])) * smoothing_s / 2
        first = max(0, int(np.searchsorted(places, places[k] - reach)) - 1)
        last = int(np.searchsorted(places, places[k] + reach, side="right")) + 1
        np.minimum(wide[first:last], fastest[k], out=wide[first:last])
    return wide


def _computed(piece: Piece, start: float, most_mps: float) -> Limits:
    leg = piece.leg
    first = min(piece.begin + max(0.0, start - piece.at), piece.end)
    inner = leg.knots[(leg.knots > first + LEAST) & (leg.knots < piece.end - LEAST)]
    if len(inner) == 0:
        inner = np.array([(first + piece.end) / 2])
    at = np.concatenate([[first], inner, [piece.end]])
    if piece.next_pace is not None:  # a corner may bend most between two knots
        at = np.sort(np.concatenate([at, (at[1:] + at[:-1]) / 2]))
    slope = np.maximum(np.abs(leg.curve(at, 1)), LEAST)
    bend = np.maximum(np.abs(leg.curve(at, 2)), LEAST)
    rates = (leg.tcp_rate, leg.turn_rate, leg.tcp_bend)
    tool = [np.maximum(np.interp(at, leg.knots, rate), LEAST) for rate in rates]
    rows = _paced(leg, piece.pace, slope, bend, tool, most_mps)
    if piece.next_pace is not None:
        others = _paced(leg, piece.next_pace, slope, bend, tool, most_mps)
        later = at > leg.length / 2
        rows = tuple(np.where(later, b, a) for a, b in zip(rows, others, strict=True))
    fastest, speeding, slowing = rows
    return Limits(piece.at + at - piece.begin, fastest, speeding, slowing, slope, bend)


def _paced(
    leg: Leg, pace: Pace, slope: Array, bend: Array, tool: list[Array], most_mps: float
) -> tuple[Array, ...]:
    tcp, turn, tcp_bend = tool
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
