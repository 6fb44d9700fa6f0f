"""ABB IRB 1200-7/0.7: the short arm of the family.

Lengths, ranges and speeds: the maker's product specification. It shares base, wrist and drives
with the IRB 1200-5/0.9; what the maker does not publish is that arm's estimate, for an arm of
52 kg.
"""

from dataclasses import replace

from drivers.arms.irb1200 import IRB1200_5_09
from drivers.arms.model import Axis, Inertial, LinkShape
from hal import RobotLimits

__all__ = ["IRB1200_7_07"]

LOWER_ARM_M = 0.350
FOREARM_M = 0.351
MASS_SCALE = 52.0 / 54.0
LONG = IRB1200_5_09


def _lighter(inertial: Inertial, centre_m: tuple[float, float, float] | None = None) -> Inertial:
    x, y, z = (part * MASS_SCALE for part in inertial.diagonal)
    return Inertial(inertial.mass_kg * MASS_SCALE, centre_m or inertial.centre_m, (x, y, z))


def _axes() -> tuple[Axis, ...]:
    one, two, three, four, five, six = (
        replace(axis, inertial=_lighter(axis.inertial)) for axis in LONG.axes
    )
    x, y, z = two.inertial.centre_m
    shrunk = LOWER_ARM_M / LONG.opw.c2_m
    two = replace(
        two,
        shapes=(LinkShape("capsule", (0.0, 0.0, 0.02), (0.0, 0.0, LOWER_ARM_M - 0.02), 0.065),),
        inertial=replace(two.inertial, centre_m=(x, y, z * shrunk)),
    )
    three = replace(three, offset_m=(0.0, 0.0, LOWER_ARM_M))
    x, y, z = four.inertial.centre_m
    four = replace(
        four,
        shapes=(LinkShape("capsule", (0.07, 0.0, 0.0), (FOREARM_M - 0.03, 0.0, 0.0), 0.048),),
        inertial=replace(four.inertial, centre_m=(x - 0.1, y, z)),
    )
    return one, two, three, four, replace(five, offset_m=(FOREARM_M, 0.0, 0.0)), six


IRB1200_7_07 = replace(
    LONG,
    name="irb1200-7-0.7",
    model="IRB 1200-7/0.7",
    opw=replace(LONG.opw, c2_m=LOWER_ARM_M, c3_m=FOREARM_M),
    limits=RobotLimits(
        lower_rad=LONG.limits.lower_rad,
        upper_rad=(2.967, 2.356, *LONG.limits.upper_rad[2:]),
        speed_radps=LONG.limits.speed_radps,
        tcp_speed_mps=LONG.limits.tcp_speed_mps,
        payload_kg=7.0,
    ),
    axes=_axes(),
)
