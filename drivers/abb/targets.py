"""Targets of ``hal`` as messages."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivers.abb.messages import AddCircular, AddJoint, AddLinear, Message, Quaternion, Triple
from drivers.abb.reach import confdata
from drivers.arms import ArmModel
from hal import CircularTarget, JointTarget, Target, Transform

__all__ = ["MAX_TARGETS", "pose_numbers", "triple", "wire_targets"]

# BP_QUEUE of the controller package.
MAX_TARGETS = 50


def wire_targets(
    targets: Sequence[Target],
    joints_rad: Sequence[NDArray[np.float64]],
    T_object_base: Transform,
    arm: ArmModel,
) -> list[Message]:
    """Return the queue's messages.

    ``joints_rad`` are the joints at each target; ``T_object_base`` takes targets to the work
    object, in whose frame the controller is told of them.
    """
    return [
        _wire(target, joints, T_object_base, arm)
        for target, joints in zip(targets, joints_rad, strict=True)
    ]


def _wire(
    target: Target, joints_rad: NDArray[np.float64], T_object_base: Transform, arm: ArmModel
) -> Message:
    if isinstance(target, JointTarget):
        a, b, c, d, e, f = (float(q) for q in target.joints_rad)
        return AddJoint((a, b, c, d, e, f), target.speed, target.zone_m)
    position_m, quaternion = pose_numbers(T_object_base @ target.T_base_tcp)
    conf = confdata(arm, joints_rad)
    way = (target.speed_mps, target.zone_m)
    if isinstance(target, CircularTarget):
        via = pose_numbers(T_object_base @ target.T_base_via)
        return AddCircular(*via, position_m, quaternion, conf, *way)
    return AddLinear(position_m, quaternion, conf, *way)


def triple(values: Any) -> Triple:
    """Three floats of whatever holds three."""
    x, y, z = (float(v) for v in values)
    return x, y, z


def pose_numbers(pose: Transform) -> tuple[Triple, Quaternion]:
    """Position and quaternion."""
    w, i, j, k = (float(v) for v in pose.quaternion_wxyz)
    return triple(pose.translation_m), (w, i, j, k)
