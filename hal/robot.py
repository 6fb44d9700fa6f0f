"""The arm."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike

from hal.device import Device
from hal.motion import Motion
from hal.transform import Transform

__all__ = [
    "CircularTarget",
    "JointTarget",
    "LinearTarget",
    "Load",
    "OperatingMode",
    "Robot",
    "RobotLimits",
    "RobotState",
    "Target",
    "Tool",
]


class OperatingMode(StrEnum):
    """The controller's key switch, as ABB names its positions."""

    AUTO = "auto"
    MANUAL_REDUCED = "manual reduced speed"
    MANUAL_FULL = "manual full speed"


@dataclass(frozen=True)
class RobotLimits:
    """Per joint, radians and seconds; payload in kilograms."""

    lower_rad: tuple[float, ...]
    upper_rad: tuple[float, ...]
    speed_radps: tuple[float, ...]
    tcp_speed_mps: float
    payload_kg: float

    def check_joints(self, joints_rad: Sequence[float]) -> None:
        """Refuse joints outside the range.

        Raises
        ------
        ValueError
            Wrong number, not finite, or outside; names the joint and the range.
        """
        if len(joints_rad) != len(self.lower_rad):
            raise ValueError(f"{len(joints_rad)} joints given, the arm has {len(self.lower_rad)}")
        limits = zip(joints_rad, self.lower_rad, self.upper_rad, strict=True)
        for axis, (q, lower, upper) in enumerate(limits, 1):
            if not lower <= q <= upper:
                raise ValueError(f"joint {axis}: {q:.4f} rad is outside {lower:.4f}..{upper:.4f}")

    def check_load(self, load: "Load") -> None:
        """Refuse a load above the payload.

        Raises
        ------
        ValueError
            Too heavy.
        """
        if load.mass_kg > self.payload_kg:
            raise ValueError(
                f"load {load.mass_kg:g} kg is above the payload of {self.payload_kg:g} kg"
            )

    def check_target(self, target: "Target") -> None:
        """Refuse what can be seen to be wrong without looking at the way.

        Raises
        ------
        ValueError
            Joints outside the ranges, speed above the arm's, other frames than base and tcp.
        """
        if isinstance(target, JointTarget):
            self.check_joints(target.joints_rad)
            return
        if target.speed_mps > self.tcp_speed_mps:
            raise ValueError(f"speed {target.speed_mps:g} m/s is above {self.tcp_speed_mps:g} m/s")
        poses = [target.T_base_tcp]
        if isinstance(target, CircularTarget):
            poses.append(target.T_base_via)
        for pose in poses:
            if (pose.parent, pose.child) != ("base", "tcp"):
                raise ValueError(
                    f"a target relates base and tcp, not {pose.parent} and {pose.child}"
                )


@dataclass(frozen=True)
class Load:
    """What the flange or the gripper carries: mass and centre of gravity in the flange frame."""

    mass_kg: float = 0.0
    centre_m: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not (0 <= self.mass_kg < np.inf and np.isfinite(self.centre_m).all()):
            raise ValueError(f"not a load: {self}")


@dataclass(frozen=True)
class Tool:
    """Where the tool centre point sits on the flange, and what the tool weighs."""

    T_flange_tcp: Transform
    load: Load = field(default_factory=Load)

    def __post_init__(self) -> None:
        frames = (self.T_flange_tcp.parent, self.T_flange_tcp.child)
        if frames != ("flange", "tcp"):
            raise ValueError(f"a tool relates flange and tcp, not {frames[0]} and {frames[1]}")


@dataclass(frozen=True)
class JointTarget:
    """Go there in joint space, all joints arriving together.

    ``speed`` is the fraction of the joint speeds (0, 1]. ``zone_m`` is the distance from the
    target at which the next move may begin (0: come to a stand, RAPID's ``fine``).
    """

    joints_rad: tuple[float, ...]
    speed: float = 1.0
    zone_m: float = 0.0

    def __post_init__(self) -> None:
        if not np.isfinite(self.joints_rad).all():
            raise ValueError(f"joints are not finite: {self.joints_rad}")
        if not 0 < self.speed <= 1:
            raise ValueError(f"speed is a fraction in (0, 1], got {self.speed:g}")
        _check_zone(self.zone_m)


@dataclass(frozen=True)
class LinearTarget:
    """Move the tool centre point on a straight line, on the branch the arm is in."""

    T_base_tcp: Transform
    speed_mps: float = 0.25
    zone_m: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.speed_mps < np.inf:
            raise ValueError(f"speed must be positive, got {self.speed_mps:g} m/s")
        _check_zone(self.zone_m)


@dataclass(frozen=True)
class CircularTarget:
    """Move the tool centre point on the arc through where it is and ``T_base_via``.

    The tool turns evenly from its start to ``T_base_tcp``; the rotation at the via point does
    not matter.
    """

    T_base_via: Transform
    T_base_tcp: Transform
    speed_mps: float = 0.25
    zone_m: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.speed_mps < np.inf:
            raise ValueError(f"speed must be positive, got {self.speed_mps:g} m/s")
        _check_zone(self.zone_m)


def _check_zone(zone_m: float) -> None:
    if not 0 <= zone_m < np.inf:
        raise ValueError(f"zone must be >= 0, got {zone_m:g} m")


Target = JointTarget | LinearTarget | CircularTarget


@dataclass(frozen=True)
class RobotState:
    """What the controller measures and reports; read, never commanded, for the last four."""

    stamp_s: float
    joints_rad: tuple[float, ...]
    T_base_tcp: Transform
    is_moving: bool
    mode: OperatingMode
    motors_on: bool
    protective_stop: bool
    emergency_stop: bool

    @property
    def may_move(self) -> bool:
        """Whether a motion command would be taken."""
        return self.motors_on and not self.protective_stop and not self.emergency_stop


class Robot(Device):
    """A six-axis arm.

    One motion is under way at a time. A new one while it runs preempts nothing: it is
    refused with ``RejectedError`` (code ``busy``); buffered moves are one command.
    Done means standing at the last target.
    """

    @property
    @abstractmethod
    def limits(self) -> RobotLimits:
        """Joint ranges and speeds, payload."""

    @abstractmethod
    def move(self, targets: Sequence[Target]) -> Motion[RobotState]:
        """Go through the targets in order, blending where they have a zone.

        Raises
        ------
        ValueError
            No targets, joints outside the limits, speed above the arm's, other frames.
        RejectedError
            Busy, motors off, not in auto.
        UnreachableError
            A linear or circular target, or a point on the way to it, is out of reach; or no
            circle goes through the three points.
        SafetyError
            A protective or emergency stop is active, or came during the motion.
        """

    def move_joints(
        self, joints_rad: ArrayLike, *, speed: float = 1.0, zone_m: float = 0.0
    ) -> Motion[RobotState]:
        """One joint move; see ``move``."""
        joints = tuple(float(q) for q in np.asarray(joints_rad, float).ravel())
        return self.move([JointTarget(joints, speed, zone_m)])

    def move_linear(
        self, T_base_tcp: Transform, *, speed_mps: float = 0.25, zone_m: float = 0.0
    ) -> Motion[RobotState]:
        """One straight move of the tool centre point; see ``move``."""
        return self.move([LinearTarget(T_base_tcp, speed_mps, zone_m)])

    @abstractmethod
    def set_tool(self, tool: Tool) -> Motion[None]:
        """Use this tool from now on; refused while moving."""

    @abstractmethod
    def set_load(self, load: Load) -> Motion[None]:
        """Tell the controller what the gripper now carries (``Load()``: nothing).

        Raises
        ------
        ValueError
            Above the payload.
        """

    @abstractmethod
    def stop(self) -> Motion[RobotState]:
        """Brake on the path and drop what is buffered; the motion under way is preempted."""

    @abstractmethod
    async def state(self) -> RobotState:
        """Measured joints and pose, mode, motors, stops."""
