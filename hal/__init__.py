"""What a camera, a robot, a gripper and an I/O block are: interfaces, values, errors."""

from hal.arc import Arc
from hal.calibration import CameraIntrinsics, Region, StereoCalibration
from hal.camera import Projector, StereoCamera, StereoCapture, StereoShot
from hal.compute import compute
from hal.device import Device, Identity
from hal.figures import Figure
from hal.gripper import (
    GraspOutcome,
    GraspResult,
    Gripper,
    GripperCapability,
    GripperEvent,
    GripperLimits,
    GripperMode,
    GripperState,
    HomeResult,
    MoveResult,
)
from hal.io import DigitalIo, Direction
from hal.layout import Bin, Fingers, Layout, Tray
from hal.motion import Motion
from hal.registry import Address, Backend, Kind, Registry, Scheme
from hal.robot import (
    CircularTarget,
    JointTarget,
    LinearTarget,
    Load,
    OperatingMode,
    Robot,
    RobotLimits,
    RobotState,
    Target,
    Tool,
)
from hal.transform import Transform, rotation_from_rotvec, rotvec_from_rotation
from hal.vacuum import VacuumState, VacuumTool

__all__ = [
    "Address",
    "Arc",
    "Backend",
    "Bin",
    "CameraIntrinsics",
    "CircularTarget",
    "Device",
    "DigitalIo",
    "Direction",
    "Figure",
    "Fingers",
    "GraspOutcome",
    "GraspResult",
    "Gripper",
    "GripperCapability",
    "GripperEvent",
    "GripperLimits",
    "GripperMode",
    "GripperState",
    "HomeResult",
    "Identity",
    "JointTarget",
    "Kind",
    "Layout",
    "LinearTarget",
    "Load",
    "Motion",
    "MoveResult",
    "OperatingMode",
    "Projector",
    "Region",
    "Registry",
    "Robot",
    "RobotLimits",
    "RobotState",
    "Scheme",
    "StereoCalibration",
    "StereoCamera",
    "StereoCapture",
    "StereoShot",
    "Target",
    "Tool",
    "Transform",
    "Tray",
    "VacuumState",
    "VacuumTool",
    "compute",
    "rotation_from_rotvec",
    "rotvec_from_rotation",
]
