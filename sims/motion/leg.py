"""The way of one move as a value: joints over a length, without time.

A leg's ``length`` is measured in joint space (radians, all axes together), so that legs of any
kind can be joined: along each of them joints change by one radian per radian. How fast the tool
goes for it stands at the knots.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from drivers.arms import Kinematics

__all__ = ["STILL_M", "STILL_RAD", "Leg", "leg_through", "standing_leg"]

Array = NDArray[np.float64]

STILL_RAD = 1e-9
STILL_M = 1e-7


@dataclass(frozen=True, eq=False)
class Leg:
    """A way from ``joints_rad(0)`` to ``joints_rad(length)``.

    ``knots`` has shape (n,), from 0 to ``length``. At each of them: ``tcp_m`` the tool centre
    point (n, 3) in frame ``base``; ``tcp_rate`` and ``turn_rate`` how far it goes (m) and turns
    (rad) per unit of length; ``tcp_bend`` the second derivative of its place (m); ``slope`` and
    ``bend`` the derivatives of the joints (n, 6). ``is_cartesian`` tells lines and circles from
    joint moves; ``way_m`` and ``turn_rad`` are the tool's.
    """

    curve: CubicSpline
    length: float
    knots: Array
    tcp_m: Array
    tcp_rate: Array
    turn_rate: Array
    tcp_bend: Array
    slope: Array
    bend: Array
    way_m: float
    turn_rad: float
    is_cartesian: bool

    def joints_rad(self, at: Array | float) -> Array:
        """Joints at a length, shape (6,) or (n, 6)."""
        return np.asarray(self.curve(at))

    @property
    def end_rad(self) -> Array:
        """Where it leads."""
        return self.joints_rad(self.length)

    def length_before_end(self, distance_m: float, angle_rad: float = 0.0) -> float:
        """The length at which the tool is this far from the end; a turn counts where it stands."""
        if self.way_m > STILL_M:
            away = np.linalg.norm(self.tcp_m - self.tcp_m[-1], axis=1)
            return _last_crossing(self.knots, away, distance_m)
        return self.length * max(0.0, 1.0 - angle_rad / max(self.turn_rad, 1e-12))

    def length_after_start(self, distance_m: float, angle_rad: float = 0.0) -> float:
        """The length at which the tool is this far from the start."""
        if self.way_m > STILL_M:
            away = np.linalg.norm(self.tcp_m - self.tcp_m[0], axis=1)
            return self.length - _last_crossing(
                (self.length - self.knots)[::-1], away[::-1], distance_m
            )
        return self.length * min(1.0, angle_rad / max(self.turn_rad, 1e-12))


def _last_crossing(knots: Array, away: Array, distance: float) -> float:
    """Where ``away``, which ends at 0, was last greater than ``distance``."""
    outside = np.flatnonzero(away > distance)
    if len(outside) == 0:
        return float(knots[0])
    k = int(outside[-1])
    share = (away[k] - distance) / max(away[k] - away[k + 1], 1e-15)
    return float(knots[k] + share * (knots[k + 1] - knots[k]))


def standing_leg(kinematics: Kinematics, at_rad: Array, tool: Array) -> Leg:
    """A leg without length."""
    return leg_through(kinematics, np.array([at_rad, at_rad]), tool, is_cartesian=False)


def leg_through(
    kinematics: Kinematics, joints_rad: Array, tool: Array, *, is_cartesian: bool
) -> Leg:
    """A leg through joints, shape (n, 6), with its derivatives."""
    steps = np.linalg.norm(np.diff(joints_rad, axis=0), axis=1)
    joints = joints_rad[np.concatenate([[True], steps > STILL_RAD])]
    if len(joints) < 2:
        joints, knots = np.repeat(joints_rad[-1:], 2, axis=0), np.array([0.0, 1e-12])
    else:
        chords = np.linalg.norm(np.diff(joints, axis=0), axis=1)
        knots = np.concatenate([[0.0], np.cumsum(chords)])
    curve = CubicSpline(knots, joints, bc_type="natural" if len(knots) < 4 else "not-a-knot")
    poses = kinematics.forward(joints) @ tool
    tcp = poses[:, :3, 3]
    chord = np.linalg.norm(np.diff(poses[:, :3, :3], axis=0), axis=(1, 2))
    turns = 2 * np.arcsin(np.minimum(chord / np.sqrt(8), 1.0))
    rate = turns / np.diff(knots)
    place = CubicSpline(knots, tcp, bc_type="natural" if len(knots) < 4 else "not-a-knot")
    return Leg(
        curve=curve,
        length=float(knots[-1]) if len(steps) and steps.max() > STILL_RAD else 0.0,
        knots=knots,
        tcp_m=tcp,
        tcp_rate=np.linalg.norm(np.asarray(place(knots, 1)), axis=1),
        turn_rate=np.maximum(np.append(rate, rate[-1]), np.insert(rate, 0, rate[0])),
        tcp_bend=np.linalg.norm(np.asarray(place(knots, 2)), axis=1),
        slope=np.asarray(curve(knots, 1)),
        bend=np.asarray(curve(knots, 2)),
        way_m=float(np.linalg.norm(np.diff(tcp, axis=0), axis=1).sum()),
        turn_rad=float(turns.sum()),
        is_cartesian=is_cartesian,
    )
