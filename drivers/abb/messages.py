"""What can be said on the wire, as frozen values in SI units (docs/reference/abb-protocol.md)."""

from dataclasses import dataclass
from enum import IntEnum, IntFlag

__all__ = [
    "Accepted",
    "AddCircular",
    "AddJoint",
    "AddLinear",
    "AskSignals",
    "AskState",
    "Code",
    "ControllerState",
    "Drop",
    "Flag",
    "Frame",
    "Hello",
    "Identify",
    "IdentityReply",
    "Message",
    "Outcome",
    "Ping",
    "Pulse",
    "Quaternion",
    "Refused",
    "Result",
    "Run",
    "SetAcceleration",
    "SetLoad",
    "SetTool",
    "SetWorkObject",
    "SignalNames",
    "Stop",
    "Triple",
    "WaitFor",
    "Welcome",
    "Write",
]

MAJOR, MINOR = 1, 0

Triple = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Joints = tuple[float, float, float, float, float, float]


class Code(IntEnum):
    """Why something was refused, failed or is held."""

    NONE = 0
    BAD_FRAME = 1
    BAD_LENGTH = 2
    UNKNOWN = 3
    BAD_VERSION = 4
    NOT_PAIRED = 5
    BUSY = 6
    QUEUE_FULL = 7
    BAD_ARGUMENT = 8
    OUT_OF_REACH = 10
    JOINT_LIMIT = 11
    SINGULARITY = 12
    CONFIGURATION = 13
    COLLISION = 14
    OUTSIDE_BOX = 15
    TOO_FAST = 16
    TOO_HEAVY = 17
    MOTORS_OFF = 20
    NOT_IN_AUTO = 21
    EMERGENCY_STOP = 22
    PROTECTIVE_STOP = 23
    PROGRAM_STOPPED = 24
    STOP_ORDERED = 25
    CLIENT_SILENT = 26
    CLIENT_GONE = 27
    NO_SIGNAL = 30
    TIMED_OUT = 31
    INTERNAL = 99


class Result(IntEnum):
    """How a motion ended."""

    DONE = 1
    FAILED = 2
    STOPPED = 3


class Flag(IntFlag):
    """Bits of the controller's state."""

    MOTORS_ON = 1
    AUTO = 2
    MANUAL_FULL = 4
    EMERGENCY_STOP = 8
    PROTECTIVE_STOP = 16
    EXECUTING = 32
    MOVING = 64
    HAS_MOTION_CLIENT = 128


# Of the client.


@dataclass(frozen=True, slots=True)
class Hello:
    """First frame of a connection. ``epoch``: the monitor's, on the motion connection; else 0."""

    major: int
    minor: int
    epoch: int


@dataclass(frozen=True, slots=True)
class Identify:
    """Ask who it is."""


@dataclass(frozen=True, slots=True)
class AddJoint:
    """Queue a joint target; ``share`` of the joint speeds."""

    joints_rad: Joints
    share: float
    zone_m: float


@dataclass(frozen=True, slots=True)
class AddLinear:
    """Queue a straight move; ``conf`` is cf1, cf4, cf6, cfx."""

    position_m: Triple
    quaternion: Quaternion
    conf: tuple[int, int, int, int]
    speed_mps: float
    zone_m: float


@dataclass(frozen=True, slots=True)
class AddCircular:
    """Queue an arc through the via point."""

    via_m: Triple
    via_quaternion: Quaternion
    position_m: Triple
    quaternion: Quaternion
    conf: tuple[int, int, int, int]
    speed_mps: float
    zone_m: float


@dataclass(frozen=True, slots=True)
class Run:
    """Drive the queue of ``count`` targets, if no stop came since ``tick``."""

    id: int
    count: int
    tick: int


@dataclass(frozen=True, slots=True)
class Drop:
    """Empty the queue."""


@dataclass(frozen=True, slots=True)
class SetTool:
    """Tool frame in the flange; ``centre_m`` in the flange frame."""

    position_m: Triple
    quaternion: Quaternion
    mass_kg: float
    centre_m: Triple


@dataclass(frozen=True, slots=True)
class SetWorkObject:
    """User frame of the work object in the base frame."""

    position_m: Triple
    quaternion: Quaternion


@dataclass(frozen=True, slots=True)
class SetLoad:
    """What the tool holds; ``centre_m`` in the tool frame."""

    mass_kg: float
    centre_m: Triple


@dataclass(frozen=True, slots=True)
class SetAcceleration:
    """Percent of the normal acceleration and of its ramp."""

    percent: float
    ramp_percent: float


@dataclass(frozen=True, slots=True)
class AskState:
    """Ask for the state now."""


@dataclass(frozen=True, slots=True)
class Stop:
    """Brake on the path and clear it; answered when the arm stands."""


@dataclass(frozen=True, slots=True)
class Ping:
    """A sign of life."""


@dataclass(frozen=True, slots=True)
class AskSignals:
    """Ask for the names of the signals."""


@dataclass(frozen=True, slots=True)
class Write:
    """Set an output; ``which`` counts from 1."""

    which: int
    value: int


@dataclass(frozen=True, slots=True)
class Pulse:
    """Set an output for a time."""

    which: int
    duration_s: float


@dataclass(frozen=True, slots=True)
class WaitFor:
    """Be told when a signal has a value."""

    is_output: int
    which: int
    value: int
    timeout_s: float


# Of the controller.


@dataclass(frozen=True, slots=True)
class Welcome:
    """Answer to ``Hello``."""

    major: int
    minor: int
    epoch: int
    queue: int
    watchdog_s: float


@dataclass(frozen=True, slots=True)
class IdentityReply:
    """Answer to ``Identify``."""

    robot_type: str
    serial: str
    version: str


@dataclass(frozen=True, slots=True)
class Accepted:
    """It is done, or for ``Run``: it begins."""

    value: int


@dataclass(frozen=True, slots=True)
class Outcome:
    """How the motion ``id`` ended, and at which of its targets (from 1)."""

    result: Result
    code: Code
    id: int
    at: int


@dataclass(frozen=True, slots=True)
class Refused:
    """No, and why; ``at`` is the target that was wrong, or 0."""

    code: Code
    at: int


@dataclass(frozen=True, slots=True)
class ControllerState:
    """``turns`` x 64 s + ``time_s`` is the controller's clock. Bit 0 is the first signal."""

    turns: int
    time_s: float
    flags: Flag
    hold: Code
    tick: int
    active: int
    joints_rad: Joints
    position_m: Triple
    quaternion: Quaternion
    inputs: int
    outputs: int


@dataclass(frozen=True, slots=True)
class SignalNames:
    """Answer to ``AskSignals``."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


Message = (
    Hello
    | Identify
    | AddJoint
    | AddLinear
    | AddCircular
    | Run
    | Drop
    | SetTool
    | SetWorkObject
    | SetLoad
    | SetAcceleration
    | AskState
    | Stop
    | Ping
    | AskSignals
    | Write
    | Pulse
    | WaitFor
    | Welcome
    | IdentityReply
    | Accepted
    | Outcome
    | Refused
    | ControllerState
    | SignalNames
)


@dataclass(frozen=True, slots=True)
class Frame:
    """A message with the number of the request it belongs to; 0: nobody asked."""

    seq: int
    message: Message
