"""Which of an arm's postures a robtarget means: confdata ``[cf1, cf4, cf6, cfx]``.

cf1, cf4 and cf6 count the quarter turns of axes 1, 4 and 6, from 0 upwards and from -1
downwards; cfx has three bits: wrist centre behind axis 1 (4), behind the lower arm (2), axis 5
negative (1).
"""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from drivers.arms import ArmModel, Kinematics
from sims.controller.frames import bounded

__all__ = ["confdata_of", "is_in", "postures", "solution_in", "wide"]

Array = NDArray[np.float64]

QUARTER = np.pi / 2
EDGE_RAD = np.radians(0.5)
PRINTED_EDGE_RAD = 1e-7
TURNING_AXES = (0, 3, 5)


def confdata_of(arm: ArmModel, joints_rad: Array) -> list[float]:
    """The confdata of a posture. A hair below an edge counts as on it."""
    quarters = [float(np.floor((joints_rad[j] + PRINTED_EDGE_RAD) / QUARTER)) for j in TURNING_AXES]
    return [*quarters, float(_cfx(arm, joints_rad))]


def _cfx(arm: ArmModel, q: Array) -> int:
    opw = arm.opw
    lean = float(np.arctan2(-opw.a2_m, opw.c3_m))
    reach = float(np.hypot(opw.a2_m, opw.c3_m))
    elbow = q[2] + QUARTER - lean
    behind_axis = opw.a1_m + opw.c2_m * np.sin(q[1]) + reach * np.sin(q[1] + elbow) < 0
    behind_arm = np.sin(elbow) < 0
    return 4 * int(behind_axis) + 2 * int(behind_arm) + int(q[4] < 0)


def is_in(joints_rad: Array, confdata: Sequence[float]) -> bool:
    """Whether axes 1, 4 and 6 lie in the quarters asked for, edges included."""
    if not np.isfinite(confdata).all():
        return False
    for axis, quarter in zip(TURNING_AXES, confdata, strict=False):
        low = round(quarter) * QUARTER
        if not low - EDGE_RAD <= joints_rad[axis] <= low + QUARTER + EDGE_RAD:
            return False
    return True


def postures(kinematics: Kinematics, T_base_flange: Array) -> Array:
    """All joints that reach a pose, whole turns of axes 4 and 6 included; shape (n, 6)."""
    found = kinematics.inverse_all(T_base_flange).joints_rad[0]
    rows = [
        row for joints in found if not np.isnan(joints).any() for row in _turned(kinematics, joints)
    ]
    return np.array(rows).reshape(-1, 6)


def _turned(kinematics: Kinematics, joints: Array) -> Iterator[Array]:
    turn = 2 * np.pi
    copies = [
        [q + k * turn for k in (-1, 0, 1) if low <= q + k * turn <= high]
        for q, low, high in zip(joints, kinematics.lower_rad, kinematics.upper_rad, strict=True)
    ]
    for row in product(*copies):
        yield np.array(row)


def solution_in(
    kinematics: Kinematics, T_base_flange: Array, confdata: Sequence[float], near_rad: Array
) -> Array | None:
    """The posture with this confdata; cfx decides where several have the same quarters."""
    choices = postures(kinematics, T_base_flange)
    fitting = [row for row in choices if is_in(row, confdata)]
    if not fitting:
        return None
    wanted = round(confdata[3]) if len(confdata) > 3 else 0

    def rank(row: Array) -> tuple[int, float]:
        wrong_bits = (_cfx(kinematics.arm, row) ^ wanted).bit_count()
        return wrong_bits, float(np.abs(row - near_rad).max())

    best: Array = min(fitting, key=rank)
    return best


def wide(arm: ArmModel) -> Kinematics:
    """Kinematics without joint bounds: to tell out of reach from out of range."""
    return Kinematics(bounded(arm, np.full(6, -2 * np.pi), np.full(6, 2 * np.pi)))
