"""What an arm is, as plain data: geometry, limits, masses, servo gains."""

from dataclasses import dataclass

from hal import RobotLimits

__all__ = ["ArmModel", "Axis", "Inertial", "LinkShape", "OpwParameters"]

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class OpwParameters:
    """The seven lengths of an ortho-parallel arm with a spherical wrist (Brandstoetter 2014)."""

    a1_m: float
    a2_m: float
    b_m: float
    c1_m: float
    c2_m: float
    c3_m: float
    c4_m: float
    offsets_rad: tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class LinkShape:
    """A capsule or cylinder from ``start_m`` to ``end_m`` in its link's frame."""

    kind: str
    start_m: Vector
    end_m: Vector
    radius_m: float

    def __post_init__(self) -> None:
        if self.kind not in {"capsule", "cylinder"}:
            raise ValueError(f"a link shape is a capsule or a cylinder, not {self.kind!r}")


@dataclass(frozen=True)
class Inertial:
    """Mass, centre of mass in the link's frame, and the inertia's diagonal about it (kg m2)."""

    mass_kg: float
    centre_m: Vector
    diagonal: Vector


@dataclass(frozen=True)
class Axis:
    """One joint and the link it moves.

    ``offset_m`` places the link's frame in its parent's, both parallel at zero; ``axis`` is
    the joint's direction in it. ``acceleration_radps2`` limits planned motion. The last four
    are the simulated servo: rotor inertia seen at the joint (kg m2), torque limit, and the
    gains of position (N m/rad) and velocity (N m s/rad).
    """

    offset_m: Vector
    axis: Vector
    acceleration_radps2: float
    shapes: tuple[LinkShape, ...]
    inertial: Inertial
    armature: float
    torque_nm: float
    position_gain: float
    velocity_gain: float


@dataclass(frozen=True)
class ArmModel:
    """A six-axis arm.

    ``base_shapes`` stand still. The flange frame has z outwards; with all joints at zero it
    is the last link's frame turned so that its z is that link's x. ``path_*`` limit straight
    motion of the tool centre point; ``home_rad`` is a posture with the tool pointing down.
    """

    name: str
    vendor: str
    model: str
    opw: OpwParameters
    limits: RobotLimits
    axes: tuple[Axis, ...]
    base_shapes: tuple[LinkShape, ...]
    path_acceleration_mps2: float
    path_turn_speed_radps: float
    path_turn_acceleration_radps2: float
    jerk_time_s: float
    home_rad: tuple[float, ...]

    @property
    def accelerations_radps2(self) -> tuple[float, ...]:
        """Per joint."""
        return tuple(axis.acceleration_radps2 for axis in self.axes)
