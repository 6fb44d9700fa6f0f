"""Between RAPID's values (mm, degrees, w x y z) and the planner's (metres, radians, matrices)."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivers.arms import ArmModel
from sims.rapid.errors import RapidError

__all__ = [
    "MM",
    "UNUSED_AXIS",
    "bounded",
    "extax_unused",
    "frame_of",
    "from_robax",
    "pose_of",
    "to_robax",
    "tool_frame",
    "wobj_frame",
]

Array = NDArray[np.float64]

UNUSED_AXIS = 9e9
MM = 1e-3
MOST_NORM_ERROR = 0.1


def extax_unused() -> list[float]:
    """``[9E9, ...]``: no external axis."""
    return [UNUSED_AXIS] * 6


def frame_of(pose: Sequence[Any]) -> Array:
    """A RAPID ``pose`` (or the first two components of a robtarget) as a (4, 4) matrix, metres.

    Raises
    ------
    RapidError
        The quaternion is not one, or a place is not a number.
    """
    (x, y, z), quaternion = pose[0], pose[1]
    w, i, j, k = (float(q) for q in quaternion)
    place = np.array([x, y, z], float) * MM
    norm = float(np.sqrt(w * w + i * i + j * j + k * k))
    if not np.isfinite(place).all() or not abs(norm - 1) <= MOST_NORM_ERROR:
        raise RapidError(
            "ERR_ARGVALERR",
            f"orientation [{w:g}, {i:g}, {j:g}, {k:g}] has the norm {norm:.4f}: normalise it "
            "with NOrient",
        )
    w, i, j, k = w / norm, i / norm, j / norm, k / norm
    T = np.eye(4)
    T[:3, :3] = (
        (1 - 2 * (j * j + k * k), 2 * (i * j - w * k), 2 * (i * k + w * j)),
        (2 * (i * j + w * k), 1 - 2 * (i * i + k * k), 2 * (j * k - w * i)),
        (2 * (i * k - w * j), 2 * (j * k + w * i), 1 - 2 * (i * i + j * j)),
    )
    T[:3, 3] = place
    return T


def pose_of(T: Array) -> list[list[float]]:
    """A matrix as a RAPID ``pose``; the quaternion's first component is not negative."""
    r = T[:3, :3]
    trace = float(np.trace(r))
    # The largest component first: dividing by a small one would lose digits.
    squares = np.array([1 + trace, *(1 + 2 * np.diag(r) - trace)])
    largest = int(np.argmax(squares))
    s = 2 * float(np.sqrt(squares[largest]))
    off = {
        0: (s / 4, (r[2, 1] - r[1, 2]) / s, (r[0, 2] - r[2, 0]) / s, (r[1, 0] - r[0, 1]) / s),
        1: ((r[2, 1] - r[1, 2]) / s, s / 4, (r[0, 1] + r[1, 0]) / s, (r[0, 2] + r[2, 0]) / s),
        2: ((r[0, 2] - r[2, 0]) / s, (r[0, 1] + r[1, 0]) / s, s / 4, (r[1, 2] + r[2, 1]) / s),
        3: ((r[1, 0] - r[0, 1]) / s, (r[0, 2] + r[2, 0]) / s, (r[1, 2] + r[2, 1]) / s, s / 4),
    }[largest]
    sign = -1.0 if off[0] < 0 else 1.0
    return [[float(v) / MM for v in T[:3, 3]], [sign * float(q) for q in off]]


def tool_frame(tool: Sequence[Any]) -> Array:
    """``T_flange_tcp`` of a tooldata.

    Raises
    ------
    RapidError
        The tool stands still (``robhold`` FALSE): not supported.
    """
    if not tool[0]:
        raise RapidError(
            "ERR_ARGVALERR", "stationary tools (robhold FALSE) are not supported", is_fatal=True
        )
    return frame_of(tool[1])


def wobj_frame(wobj: Sequence[Any] | None) -> Array:
    """``T_base_object`` of a wobjdata; the base frame for None.

    Raises
    ------
    RapidError
        The object is held by the robot or moved by another unit: not supported.
    """
    if wobj is None:
        return np.eye(4)
    is_held, is_fixed, unit = wobj[0], wobj[1], wobj[2]
    if is_held or (not is_fixed and unit):
        raise RapidError(
            "ERR_ARGVALERR",
            "work objects held by the robot or moved by another unit are not supported",
            is_fatal=True,
        )
    return np.asarray(frame_of(wobj[3]) @ frame_of(wobj[4]))


def from_robax(robax: Sequence[float]) -> Array:
    """Degrees to radians, shape (6,)."""
    return np.asarray(np.radians(np.array(robax, float)))


def to_robax(joints_rad: Array) -> list[float]:
    """Radians to degrees."""
    return [float(q) for q in np.degrees(joints_rad)]


def bounded(arm: ArmModel, lower_rad: Array, upper_rad: Array) -> ArmModel:
    """The arm with a controller's own joint bounds."""
    limits = replace(
        arm.limits,
        lower_rad=tuple(float(q) for q in lower_rad),
        upper_rad=tuple(float(q) for q in upper_rad),
    )
    return replace(arm, limits=limits)
