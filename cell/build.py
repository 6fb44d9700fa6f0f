"""From a cell file to a line: devices opened, planning made, slots laid out."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cell.config import CellConfig
from cell.devices import make_device, registry
from cell.grasp import is_graspable
from cell.journal import Journal
from cell.line import Line
from cell.planning.collision import CollisionModel, Obstacle
from cell.planning.pick import PickPlanner
from cell.planning.reach import Reach
from cell.planning.transit import Joints
from cell.scene import Eyes
from cell.slots import Slots
from drivers.arms import ARMS, ArmModel, Kinematics
from hal import Gripper, Kind, Projector, Robot, StereoCamera, Transform
from hal.errors import ConfigError, UnreachableError
from perception.parts import Part

__all__ = ["Devices", "build_line", "make_devices", "make_rig"]

HOME_HEIGHT_M = 0.25
HOME_INSIDE_M = 0.02
HOME_YAWS = 12
SLOT_CHECK_M = 0.10


@dataclass(frozen=True)
class Devices:
    """One of each; none opened yet."""

    robot: Robot
    gripper: Gripper
    camera: StereoCamera
    projector: Projector


def make_devices(config: CellConfig, opened: Mapping[str, Any]) -> Devices:
    """Make every device of the cell file; see ``cell.devices.make_device``."""
    known = registry()
    camera, projector = make_rig(config, opened)
    return Devices(
        robot=make_device("robot", Kind.ROBOT, config.robot, known, opened),
        gripper=make_device("gripper", Kind.GRIPPER, config.gripper, known, opened),
        camera=camera,
        projector=projector,
    )


def make_rig(config: CellConfig, opened: Mapping[str, Any]) -> tuple[StereoCamera, Projector]:
    """Make what looks, and nothing that moves."""
    known = registry()
    return (
        make_device("camera", Kind.CAMERA, config.camera, known, opened),
        make_device("projector", Kind.PROJECTOR, config.projector, known, opened),
    )


def build_line(
    config: CellConfig, part: Part, devices: Devices, eyes: Eyes, journal: Journal, *, seed: int
) -> Line:
    """Put a line together.

    Raises
    ------
    ConfigError
        An arm we do not know, or a part that the fingers fit nowhere.
    UnreachableError
        No slot of the tray can be reached.
    """
    arm = ARMS.get(config.arm)
    if arm is None:
        raise ConfigError(f"{config.arm!r} is unknown; known: {', '.join(sorted(ARMS))}", key="arm")
    layout = config.layout
    if not is_graspable(part, layout.fingers, devices.gripper.limits):
        stroke_m = devices.gripper.limits.stroke_m
        raise ConfigError(
            f"the fingers fit it nowhere: every section is wider than the stroke of {stroke_m:g} m "
            f"or shorter than the fingers' {layout.fingers.width_m:g} m",
            source=f"part {part.name}",
        )
    T_flange_tcp = Transform.from_translation("flange", "tcp", (0, 0, layout.fingers.tcp_m))
    reach = Reach(Kinematics(arm), T_flange_tcp.matrix)
    obstacles = (_housing(config),)
    home_rad = _home(config, arm, reach, part, obstacles)
    slots = Slots.grid(
        layout.tray, part, layout.fingers, release_margin_m=config.grasp.release_margin_m
    )
    return Line(
        config=config,
        part=part,
        arm=arm,
        robot=devices.robot,
        gripper=devices.gripper,
        eyes=eyes,
        planner=PickPlanner(
            reach,
            arm.limits,
            layout,
            home_rad,
            stroke_m=devices.gripper.limits.stroke_m,
            release_margin_m=config.grasp.release_margin_m,
        ),
        slots=_reachable(slots, config, reach, home_rad),
        journal=journal,
        obstacles=obstacles,
        seed=seed,
    )


def _housing(config: CellConfig) -> Obstacle:
    camera = config.camera
    place = Transform.from_translation("base", "housing", camera.housing_position_m)
    return Obstacle("camera", camera.housing_size_m, place)


def _down(position_m: np.ndarray, yaw_rad: float) -> np.ndarray:
    """Tool pointing down, closing direction turned by ``yaw_rad``: (4, 4)."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    pose = np.eye(4)
    pose[:3, :3] = [[c, s, 0], [s, -c, 0], [0, 0, -1]]
    pose[:3, 3] = position_m
    return pose


def _home(
    config: CellConfig, arm: ArmModel, reach: Reach, part: Part, obstacles: tuple[Obstacle, ...]
) -> Joints:
    """Over the tray's edge nearest to the bin, outside the camera's view, joints at ease."""
    layout = config.layout
    x, y, z = layout.tray.T_base_tray.translation_m
    towards_bin = np.sign(layout.bin.T_base_bin.translation_m[1] - y)
    inside_m = layout.tray.size_m[1] / 2 - HOME_INSIDE_M
    position_m = np.array([x, y + towards_bin * inside_m, z + HOME_HEIGHT_M])
    yaws = np.arange(HOME_YAWS) * np.pi / HOME_YAWS
    poses = np.stack([_down(position_m, yaw) for yaw in yaws])
    joints = reach.solutions(poses, np.zeros(6)).reshape(-1, 6)
    joints = joints[~np.isnan(joints).any(axis=1)]
    model = CollisionModel(arm, layout, part, obstacles=obstacles)
    joints = np.array([q for q in joints if not model.hits(q, 0.035)])
    if not len(joints):
        raise UnreachableError(
            f"tray at ({x:.3f}, {y:.3f}, {z:.3f}) m: the arm cannot stand over its edge; "
            "move tray.position_m nearer to the arm or away from the bin"
        )
    return np.asarray(joints[np.abs(joints).max(axis=1).argmin()])


def _reachable(slots: Slots, config: CellConfig, reach: Reach, home_rad: Joints) -> Slots:
    """Leave out slots over which the arm cannot bring the tool, pointing down either way."""
    tray = config.layout.tray
    kept = []
    for position_m in slots.positions_m:
        above_m = tray.T_base_tray.apply(np.array([*position_m, SLOT_CHECK_M]))
        low_m = tray.T_base_tray.apply(np.array([*position_m, 0.01]))
        poses = np.stack([_down(p, yaw) for p in (above_m, low_m) for yaw in (np.pi / 2,)])
        if not np.isnan(reach.nearest(poses, home_rad)).any():
            kept.append(position_m)
    if not kept:
        x, y, z = tray.T_base_tray.translation_m
        raise UnreachableError(
            f"tray at ({x:.3f}, {y:.3f}, {z:.3f}) m: none of its {len(slots)} slots can be "
            "reached; move tray.position_m"
            if len(slots)
            else f"tray of {tray.size_m[0]:.3f} x {tray.size_m[1]:.3f} m has no room for one part; "
            "enlarge tray.size_m"
        )
    return replace(slots, positions_m=tuple(kept))
