"""Arms as data and kinematics: what planning, drivers and the simulated world agree on."""

from drivers.arms.irb1200 import IRB1200_5_09
from drivers.arms.kinematics import InverseSolutions, Kinematics
from drivers.arms.model import ArmModel, Axis, Inertial, LinkShape, OpwParameters

__all__ = [
    "ARMS",
    "IRB1200_5_09",
    "ArmModel",
    "Axis",
    "Inertial",
    "InverseSolutions",
    "Kinematics",
    "LinkShape",
    "OpwParameters",
]

ARMS: dict[str, ArmModel] = {IRB1200_5_09.name: IRB1200_5_09}
