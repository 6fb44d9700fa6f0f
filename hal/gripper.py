"""The electric two-finger gripper. Results are values; exceptions are for faults."""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from hal.device import Device
from hal.motion import Motion

__all__ = [
    "GraspOutcome",
    "GraspResult",
    "Gripper",
    "GripperCapability",
    "GripperEvent",
    "GripperLimits",
    "GripperMode",
    "GripperState",
    "HomeResult",
    "MoveResult",
]


class GripperMode(StrEnum):
    """What the gripper is doing."""

    OFF = "off"
    HOMING = "homing"
    READY = "ready"
    MOVING = "moving"
    GRIPPING = "gripping"
    HOLDING = "holding"
    NO_PART = "no part"
    WRONG_PART = "wrong part"
    PART_LOST = "part lost"
    STOPPED = "stopped"
    FAULT = "fault"


class GraspOutcome(StrEnum):
    """How closing on a part ended."""

    HELD = "held"
    NO_PART = "no part"
    WRONG_PART = "wrong part"


class GripperEvent(StrEnum):
    """What a gripper says without being asked."""

    PART_LOST = "part lost"
    FAULT = "fault"
    WATCHDOG = "watchdog"
    LINK_LOST = "link lost"
    LINK_BACK = "link back"


class GripperCapability(StrEnum):
    """What a backend can do; a gripper on digital I/O knows neither width nor force."""

    WIDTH = "width"
    FORCE = "force"
    SIZE = "size"
    EVENTS = "events"


@dataclass(frozen=True)
class GripperLimits:
    """Paper table 2: 35 mm stroke, 70-100 N, 1-50 mm/s, 0.01 mm."""

    stroke_m: float = 0.035
    min_force_n: float = 70.0
    max_force_n: float = 100.0
    min_speed_mps: float = 0.001
    max_speed_mps: float = 0.050
    resolution_m: float = 1e-5

    def check(
        self,
        *,
        width_m: float | None = None,
        force_n: float | None = None,
        speed_mps: float | None = None,
    ) -> None:
        """Refuse what the gripper cannot do.

        Raises
        ------
        ValueError
            Names the quantity, what was asked and the range.
        """
        for name, value, lower, upper, unit in (
            ("width", width_m, 0.0, self.stroke_m, "m"),
            ("force", force_n, self.min_force_n, self.max_force_n, "N"),
            ("speed", speed_mps, self.min_speed_mps, self.max_speed_mps, "m/s"),
        ):
            if value is not None and not lower <= value <= upper:
                raise ValueError(f"{name} {value:g} {unit} is outside {lower:g}..{upper:g} {unit}")


@dataclass(frozen=True)
class GripperState:
    """A snapshot. ``None``: this gripper does not know."""

    stamp_s: float
    mode: GripperMode
    is_homed: bool
    width_m: float | None
    force_n: float | None
    size_m: float | None = None
    fault: str = ""


@dataclass(frozen=True)
class HomeResult:
    """The stroke found between the stops, and how far the zero moved."""

    stroke_m: float
    correction_m: float


@dataclass(frozen=True)
class MoveResult:
    """``is_blocked``: something stopped the fingers before the width was reached."""

    width_m: float
    is_blocked: bool


@dataclass(frozen=True)
class GraspResult:
    """Measured size between the fingers and force per finger."""

    outcome: GraspOutcome
    size_m: float | None
    force_n: float | None

    @property
    def is_held(self) -> bool:
        """Whether the right part is in the fingers."""
        return self.outcome is GraspOutcome.HELD


class Gripper(Device):
    """Two parallel fingers; widths are between the finger pads, forces per finger.

    A new command preempts the one under way (its await raises ``PreemptedError``). Never
    homed by itself; homing while holding drops the part and must be forced.
    """

    @property
    @abstractmethod
    def limits(self) -> GripperLimits:
        """Stroke, force and speed ranges."""

    @property
    @abstractmethod
    def capabilities(self) -> frozenset[GripperCapability]:
        """What this backend can do."""

    @abstractmethod
    def home(self, *, force_if_holding: bool = False) -> Motion[HomeResult]:
        """Find the stops.

        Raises
        ------
        RejectedError
            Holding a part and not forced (code ``holding``).
        """

    @abstractmethod
    def move_to(
        self, width_m: float, *, speed_mps: float | None = None, force_n: float | None = None
    ) -> Motion[MoveResult]:
        """Open or close to a width.

        Raises
        ------
        ValueError
            Outside ``limits``; raised before anything is sent.
        RejectedError
            Not homed (code ``not homed``).
        FaultError
            A fault is active; ``clear_fault`` after its cause is gone.
        """

    @abstractmethod
    def grasp(
        self,
        *,
        expected_m: float | None = None,
        inner_tolerance_m: float = 5e-4,
        outer_tolerance_m: float = 5e-4,
        speed_mps: float | None = None,
        force_n: float | None = None,
    ) -> Motion[GraspResult]:
        """Close until something is held, and say what.

        Held if ``expected_m - inner_tolerance_m <= size <= expected_m + outer_tolerance_m``
        or nothing was expected; closed all the way is ``NO_PART``. Raises as ``move_to``.
        """

    @abstractmethod
    def release(self, *, width_m: float | None = None) -> Motion[MoveResult]:
        """Let go: open to ``width_m``, or fully."""

    @abstractmethod
    def stop(self) -> Motion[None]:
        """Stop the fingers; a held part stays held."""

    @abstractmethod
    async def state(self) -> GripperState:
        """A snapshot."""

    @abstractmethod
    def clear_fault(self) -> Motion[None]:
        """Acknowledge a fault whose cause is gone."""

    @abstractmethod
    def on_event(self, callback: Callable[[GripperEvent], None]) -> Callable[[], None]:
        """Call back on the loop's thread at each event; returns what ends it."""
