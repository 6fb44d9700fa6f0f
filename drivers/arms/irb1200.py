"""ABB IRB 1200-5/0.9.

Lengths, ranges and speeds: data sheet ROB0275EN_A. Everything else the maker does not
publish, and is an estimate, stated here and nowhere else: joint accelerations, torques, rotor
inertias, gains, link shapes (capsules, not checked against meshes), and masses (mesh-derived
at constant density, scaled to a 54 kg arm).
"""

from drivers.arms.model import ArmModel, Axis, Inertial, LinkShape, OpwParameters
from hal import RobotLimits

__all__ = ["IRB1200_5_09"]

MASS_SCALE = 54.0 / 18.146

LIMITS = RobotLimits(
    lower_rad=(-2.967, -1.745, -3.491, -4.712, -2.269, -6.283),
    upper_rad=(2.967, 2.269, 1.222, 4.712, 2.269, 6.283),
    speed_radps=(5.027, 4.189, 5.236, 6.981, 7.069, 10.472),
    tcp_speed_mps=3.0,
    payload_kg=5.0,
)

OPW = OpwParameters(
    a1_m=0.0,
    a2_m=-0.042,
    b_m=0.0,
    c1_m=0.3991,
    c2_m=0.448,
    c3_m=0.451,
    c4_m=0.082,
    offsets_rad=(0.0, 0.0, -1.5707963267948966, 0.0, 0.0, 0.0),
)


def _inertial(
    mass_kg: float, centre_m: tuple[float, float, float], diagonal: tuple[float, float, float]
) -> Inertial:
    x, y, z = diagonal
    return Inertial(
        mass_kg * MASS_SCALE, centre_m, (x * MASS_SCALE, y * MASS_SCALE, z * MASS_SCALE)
    )


AXES = (
    Axis(
        offset_m=(0.0, 0.0, 0.3991),
        axis=(0.0, 0.0, 1.0),
        acceleration_radps2=22.0,
        shapes=(LinkShape("capsule", (0.0, 0.0, -0.12), (0.0, 0.0, 0.02), 0.090),),
        inertial=_inertial(3.067, (0.0001, -0.0001, -0.1607), (0.014218, 0.014404, 0.010453)),
        armature=1.2,
        torque_nm=1000.0,
        position_gain=60000.0,
        velocity_gain=1000.0,
    ),
    Axis(
        offset_m=(0.0, 0.0, 0.0),
        axis=(0.0, 1.0, 0.0),
        acceleration_radps2=18.0,
        shapes=(LinkShape("capsule", (0.0, 0.0, 0.02), (0.0, 0.0, 0.428), 0.065),),
        inertial=_inertial(3.909, (0.0008, -0.0021, 0.1012), (0.060311, 0.041569, 0.025955)),
        armature=1.2,
        torque_nm=1000.0,
        position_gain=60000.0,
        velocity_gain=1000.0,
    ),
    Axis(
        offset_m=(0.0, 0.0, 0.448),
        axis=(0.0, 1.0, 0.0),
        acceleration_radps2=30.0,
        shapes=(LinkShape("capsule", (-0.03, 0.0, 0.042), (0.10, 0.0, 0.042), 0.062),),
        inertial=_inertial(2.944, (0.0228, 0.0011, 0.0579), (0.008356, 0.016713, 0.012698)),
        armature=0.6,
        torque_nm=520.0,
        position_gain=30000.0,
        velocity_gain=500.0,
    ),
    Axis(
        offset_m=(0.0, 0.0, 0.042),
        axis=(1.0, 0.0, 0.0),
        acceleration_radps2=50.0,
        shapes=(LinkShape("capsule", (0.17, 0.0, 0.0), (0.421, 0.0, 0.0), 0.048),),
        inertial=_inertial(1.328, (0.2247, 0.0002, 0.0004), (0.002847, 0.004013, 0.005254)),
        armature=0.12,
        torque_nm=200.0,
        position_gain=4000.0,
        velocity_gain=40.0,
    ),
    Axis(
        offset_m=(0.451, 0.0, 0.0),
        axis=(0.0, 1.0, 0.0),
        acceleration_radps2=60.0,
        shapes=(LinkShape("capsule", (0.0, 0.0, 0.0), (0.02, 0.0, 0.0), 0.042),),
        inertial=_inertial(0.546, (-0.0011, 0.0, 0.0), (0.000405, 0.000893, 0.000815)),
        armature=0.10,
        torque_nm=160.0,
        position_gain=3000.0,
        velocity_gain=30.0,
    ),
    Axis(
        offset_m=(0.082, 0.0, 0.0),
        axis=(1.0, 0.0, 0.0),
        acceleration_radps2=80.0,
        shapes=(LinkShape("cylinder", (-0.02, 0.0, 0.0), (0.0, 0.0, 0.0), 0.030),),
        inertial=_inertial(0.137, (-0.0071, 0.0, 0.0), (0.0001, 0.0001, 0.0001)),
        armature=0.05,
        torque_nm=80.0,
        position_gain=1200.0,
        velocity_gain=12.0,
    ),
)

IRB1200_5_09 = ArmModel(
    name="irb1200-5-0.9",
    vendor="ABB",
    model="IRB 1200-5/0.9",
    opw=OPW,
    limits=LIMITS,
    axes=AXES,
    base_shapes=(LinkShape("cylinder", (0.0, 0.0, 0.0), (0.0, 0.0, 0.24), 0.100),),
    path_acceleration_mps2=4.0,
    path_turn_speed_radps=4.0,
    path_turn_acceleration_radps2=30.0,
    jerk_time_s=0.03,
    home_rad=(0.0, 0.0, 0.0, 0.0, 1.5707963267948966, 0.0),
)
