"""Where two fingers can take a shaft: across its axis, or by an end that stands up."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cell.grasp.candidates import GraspCandidates, GraspKind
from hal import Fingers, GripperLimits, Transform
from perception.parts import Part

__all__ = ["is_graspable", "shaft_candidates"]

UP = np.array([0.0, 0.0, 1.0])
TIP_PAST_TCP_M = 0.010
STATION_MARGIN_M = 0.0005
ROLLS_RAD = np.radians([0, 12, -12, 25, -25, 36, -36, 44, -44])  # steep ones reach along walls
PITCHES_RAD = np.radians([0, 15, -15, 30, -30])
BACK_OFFS_M = (0.0, 0.004, 0.0085)
END_DEPTHS_M = (0.012, 0.020)
MIN_MARGIN_M = 0.002
NARROW_BELOW_M, NARROW_COST = 0.035, 0.2
TIGHT_SHARE = 0.65
END_DIRECTIONS = 8
MIN_HORIZONTAL = 0.35
MIN_STANDING = 0.55


def shaft_candidates(
    part: Part,
    T_base_object: Transform,
    *,
    index: int,
    fingers: Fingers,
    limits: GripperLimits,
    opening_margin_m: float,
    max_tilt_rad: float,
) -> GraspCandidates:
    """Every grasp worth trying on one shaft.

    The score is the part's height in units of 20 mm, less 1.5 per radian of tilt, 8 per metre
    from the middle and 20 per metre of back-off; a grasp by the end costs 0.5.
    """
    axis = T_base_object.rotation[:, 2]
    sign = 1.0 if axis[2] >= 0 else -1.0
    groups = []
    if np.hypot(axis[0], axis[1]) > MIN_HORIZONTAL:
        for station in _stations(part, fingers):
            pitches_rad = PITCHES_RAD[station.holds(fingers.width_m, PITCHES_RAD)]
            for opening_m in _openings(station.diameter_m, limits, opening_margin_m):
                groups.append(
                    _across(T_base_object, sign, station, pitches_rad, opening_m, max_tilt_rad)
                )
    if sign * axis[2] > MIN_STANDING:
        for depth_m in END_DEPTHS_M:
            diameter_m = _end_diameter(part, sign, depth_m + TIP_PAST_TCP_M)
            for opening_m in _openings(diameter_m, limits, opening_margin_m):
                groups.append(_end(T_base_object, sign, part, depth_m, diameter_m, opening_m))
    found = GraspCandidates.joined(groups)
    found.detection[:] = index
    return found


@dataclass(frozen=True)
class _Station:
    """A place on the axis.

    ``room_m`` to the next shoulder, which reaches ``step_m`` above and below the line on which
    the pads touch.
    """

    along_m: float
    diameter_m: float
    room_m: float
    step_m: float

    def holds(self, width_m: float, pitch_rad: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether a finger of this width, pitched along the axis, clears the shoulders."""
        needed_m = width_m / 2 / np.cos(pitch_rad) + self.step_m * np.abs(np.tan(pitch_rad))
        return np.asarray(needed_m + STATION_MARGIN_M <= self.room_m + 1e-9)


def _stations(part: Part, fingers: Fingers) -> Iterator[_Station]:
    """Places along the axis where the whole finger width meets one diameter."""
    edges_m, radii_m = part.profile.z_edges_m, part.profile.radii_m
    half_m = fingers.width_m / 2 + STATION_MARGIN_M
    for k, radius_m in enumerate(radii_m):
        lower_m, upper_m = float(edges_m[k]), float(edges_m[k + 1])
        spare_m = upper_m - lower_m - 2 * half_m
        if spare_m < 0:
            continue
        middle_m = (lower_m + upper_m) / 2
        stations_m = {middle_m, lower_m + half_m, upper_m - half_m}
        if spare_m > 0.03:
            stations_m |= {middle_m - spare_m / 4, middle_m + spare_m / 4}
        largest_m = max(radii_m[max(k - 1, 0) : k + 2])
        step_m = float(np.sqrt(max(largest_m**2 - radius_m**2, 0.0)))
        for along_m in sorted(stations_m, key=lambda z: (abs(z), z)):
            room_m = min(along_m - lower_m, upper_m - along_m)
            yield _Station(along_m, 2 * float(radius_m), room_m, step_m)


def _openings(diameter_m: float, limits: GripperLimits, margin_m: float) -> list[float]:
    """The whole stroke, and two narrow ones for tight places; none if the part is too wide."""
    narrow_m = [diameter_m + margin_m, diameter_m + margin_m * TIGHT_SHARE]
    if diameter_m + MIN_MARGIN_M > limits.stroke_m:
        return []
    return [limits.stroke_m, *(width_m for width_m in narrow_m if width_m < limits.stroke_m)]


def is_graspable(part: Part, fingers: Fingers, limits: GripperLimits) -> bool:
    """Whether the fingers fit the part anywhere, however it lies."""
    lies_down = any(_openings(s.diameter_m, limits, 0.006) for s in _stations(part, fingers))
    return lies_down or any(
        _openings(_end_diameter(part, sign, depth_m + TIP_PAST_TCP_M), limits, 0.006)
        for depth_m in END_DEPTHS_M
        for sign in (1.0, -1.0)
        if part.length_m > depth_m
    )


def _across(
    T_base_object: Transform,
    sign: float,
    station: _Station,
    pitches_rad: NDArray[np.float64],
    opening_m: float,
    max_tilt_rad: float,
) -> GraspCandidates:
    axis = sign * T_base_object.rotation[:, 2]
    point = T_base_object.translation_m + T_base_object.rotation[:, 2] * station.along_m
    down = -UP + axis * (axis @ UP)
    down /= np.linalg.norm(down)
    side = np.cross(down, axis)
    pitched = _turned(down, side, pitches_rad)
    z = np.concatenate([_turned(direction, axis, ROLLS_RAD) for direction in pitched])
    y = np.tile(_turned(side, axis, ROLLS_RAD), (len(pitches_rad), 1))
    tilt_rad = np.arccos(np.clip(-z[:, 2], -1, 1))
    keep = tilt_rad <= max_tilt_rad
    z, y, tilt_rad = z[keep], y[keep], tilt_rad[keep]
    groups = []
    for back_off_m in BACK_OFFS_M:
        score = (
            point[2] / 0.02
            - 1.5 * tilt_rad
            - 8 * abs(station.along_m)
            - 20 * back_off_m
            - NARROW_COST * (1 - opening_m / NARROW_BELOW_M if opening_m < NARROW_BELOW_M else 0.0)
        )
        groups.append(
            _pack(
                point - z * back_off_m,
                z,
                y,
                opening_m,
                station.diameter_m,
                score,
                GraspKind.ACROSS,
            )
        )
    return GraspCandidates.joined(groups)


def _end_diameter(part: Part, sign: float, reach_m: float) -> float:
    """Return the widest diameter within ``reach_m`` of the upper end."""
    edges_m, radii_m = part.profile.z_edges_m, part.profile.radii_m
    if sign > 0:
        meets = edges_m[1:] > edges_m[-1] - reach_m
    else:
        meets = edges_m[:-1] < edges_m[0] + reach_m
    return 2 * float(radii_m[meets].max())


def _end(
    T_base_object: Transform,
    sign: float,
    part: Part,
    depth_m: float,
    diameter_m: float,
    opening_m: float,
) -> GraspCandidates:
    axis = sign * T_base_object.rotation[:, 2]
    top = T_base_object.translation_m + axis * part.length_m / 2
    across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    across /= np.linalg.norm(across)
    y = _turned(across, axis, np.arange(END_DIRECTIONS) * np.pi / END_DIRECTIONS)
    z = np.broadcast_to(-axis, y.shape)
    score = np.full(len(y), top[2] / 0.02 - 1.5 * np.arccos(np.clip(axis[2], -1, 1)) - 0.5)
    points = np.broadcast_to(top - axis * depth_m, y.shape)
    return _pack(points, z, y, opening_m, diameter_m, score, GraspKind.END)


def _turned(
    vector: NDArray[np.float64], axis: NDArray[np.float64], angles_rad: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Rodrigues for many angles: shape (K, 3)."""
    cosine, sine = np.cos(angles_rad)[:, None], np.sin(angles_rad)[:, None]
    along = axis * (axis @ vector)
    return np.asarray(along + cosine * (vector - along) + sine * np.cross(axis, vector))


def _pack(
    points: NDArray[np.float64],
    z: NDArray[np.float64],
    y: NDArray[np.float64],
    opening_m: float,
    expected_m: float,
    score: NDArray[np.float64],
    kind: GraspKind,
) -> GraspCandidates:
    count = len(score)
    T = np.zeros((count, 4, 4))
    T[:, :3, 0], T[:, :3, 1], T[:, :3, 2] = np.cross(y, z), y, z
    T[:, :3, 3], T[:, 3, 3] = points, 1
    return GraspCandidates(
        T,
        np.full(count, opening_m),
        np.full(count, expected_m),
        np.asarray(score),
        np.zeros(count, int),
        np.full(count, str(kind)),
    )
