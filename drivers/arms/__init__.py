"""Arms as data and kinematics: what planning, drivers and the simulated world agree on."""

from drivers.arms.irb1200 import IRB1200_5_09
from drivers.arms.irb1200_7_07 import IRB1200_7_07
from drivers.arms.kinematics import InverseSolutions, Kinematics
from drivers.arms.model import ArmModel, Axis, Inertial, LinkShape, OpwParameters

__all__ = [
    "ARMS",
    "IRB1200_5_09",
    "IRB1200_7_07",
    "ArmModel",
    "Axis",
    "Inertial",
    "InverseSolutions",
    "Kinematics",
    "LinkShape",
    "OpwParameters",
]

ARMS: dict[str, ArmModel] = {arm.name: arm for arm in (IRB1200_5_09, IRB1200_7_07)}
