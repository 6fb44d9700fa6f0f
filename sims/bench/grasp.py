"""One grasp under known conditions: close on a hanging part, hold it, drive it about fast."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from drivers.arms import Kinematics
from hal import JointTarget, Load, Tool, Transform, rotvec_from_rotation
from sims.motion import plan_program
from sims.world import PartShape, Physics, World

__all__ = [
    "GraspTrial",
    "GraspTrialResult",
    "drive",
    "hanging_pose",
    "home_fingers",
    "wait_fingers",
]

LONGEST_CLOSE_S = 6.0
HOLD_S = 3.0
FAST_WAY_RAD = (
    (0.9, 0.3, 0.1, 0.2, 1.2, 0.5),
    (-0.9, -0.1, 0.3, -0.2, 1.2, -0.9),
    (0.9, 0.3, 0.1, 0.2, 1.2, 0.5),
)


@dataclass(frozen=True)
class GraspTrialResult:
    """Distances are of the part's origin in the gripper.

    ``size_m`` is what the gripper measured, None if it holds nothing; ``use_peak`` the
    largest share of friction in use while locked; ``was_locked`` whether the lock ever closed.
    """

    size_m: float | None
    hold_force_n: float
    close_s: float
    slip_static_m: float
    slip_moving_m: float
    turn_moving_rad: float
    is_held: bool
    was_locked: bool
    slides: int
    use_peak: float


@dataclass(frozen=True)
class GraspTrial:
    """``offset_m`` is where the part's origin hangs from the tool centre point, tool frame.

    The part's axis lies along the tool's x. Without ``has_both_fingers`` the right one passes
    through the part. ``prepare`` may change the new world.
    """

    shape: PartShape
    physics: Physics = field(default_factory=Physics)
    offset_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    force_n: float = 80.0
    speed_mps: float = 0.05
    has_both_fingers: bool = True
    has_lock: bool = True
    prepare: Callable[[World], None] | None = None

    def run(self) -> GraspTrialResult:
        """Home, close, weigh in, hold, drive three fast transfers."""
        world = World(shape=self.shape, parts=1, physics=self.physics)
        world.lock.is_disabled = not self.has_lock
        if self.prepare is not None:
            self.prepare(world)
        home_fingers(world)
        if not self.has_both_fingers:
            finger = world.model.geom("finger_right").id
            world.model.geom_contype[finger] = world.model.geom_conaffinity[finger] = 0
        world.put_part(0, hanging_pose(world, self.offset_m), is_floating=True)
        began = world.ticks
        world.fingers.close(window=None, speed_mps=self.speed_mps, force_n=self.force_n)
        wait_fingers(world)
        close_s = (world.ticks - began) * world.physics.tick_s
        size_m = world.fingers.size_m if world.fingers.is_holding else None
        world.set_floating(0, False)
        world.arm.set_load(Load(self.shape.mass_kg, (0.0, 0.0, world.layout.fingers.tcp_m)))
        world.step_for(0.1)
        grip = world.lock.grip()
        first, _ = _part_in_gripper(world)
        world.step_for(HOLD_S)
        second, turned_before = _part_in_gripper(world)
        for joints in (*FAST_WAY_RAD, world.arm_model.home_rad):
            drive(world, joints)
        last, turned_after = _part_in_gripper(world)
        events = world.lock.events
        return GraspTrialResult(
            size_m=size_m,
            hold_force_n=min(grip.normal_n) if grip is not None else 0.0,
            close_s=close_s,
            slip_static_m=float(np.linalg.norm(second - first)),
            slip_moving_m=float(np.linalg.norm(last - second)),
            turn_moving_rad=_angle_rad(turned_before, turned_after),
            is_held=_is_between(world),
            was_locked=any(event.is_locked for event in events),
            slides=sum(event.reason == "friction exceeded" for event in events),
            use_peak=max([world.lock.peak_use, *(event.use for event in events)]),
        )

    def with_friction(self, friction: float) -> "GraspTrial":
        """The same with other pads."""
        return replace(self, physics=replace(self.physics, pad_friction=friction))


def drive(world: World, joints_rad: tuple[float, ...], *, speed: float = 1.0) -> float:
    """Make one joint move without a loop; returns its largest tracking error at the tool, m."""
    kinematics = Kinematics(world.arm_model)
    tool = Tool(Transform.from_translation("flange", "tcp", (0, 0, world.layout.fingers.tcp_m)))
    T_flange_tcp = tool.T_flange_tcp.matrix
    target = JointTarget(tuple(joints_rad), speed)
    program = plan_program(kinematics, world.arm.target_rad, [target], tool, world.physics.tick_s)
    world.arm.follow(program)
    measured, wanted = [], []
    while not world.arm.is_standing:
        world.step()
        measured.append(world.arm.measured_rad)
        wanted.append(world.arm.target_rad.copy())
    places = [
        (kinematics.forward(np.array(joints)) @ T_flange_tcp)[:, :3, 3]
        for joints in (measured, wanted)
    ]
    return float(np.linalg.norm(places[0] - places[1], axis=1).max())


def home_fingers(world: World) -> None:
    """Home, and open fully."""
    world.fingers.home()
    wait_fingers(world)
    world.fingers.move(world.fingers.limits.stroke_m, speed_mps=0.05, force_n=80.0)
    wait_fingers(world)


def wait_fingers(world: World) -> None:
    """Step until the fingers have done what they were told."""
    limit = world.ticks + round(LONGEST_CLOSE_S / world.physics.tick_s)
    while world.fingers.is_busy and world.ticks < limit:
        world.step()


def hanging_pose(world: World, offset_m: tuple[float, float, float]) -> Transform:
    """Where a part hangs whose axis lies along the tool's x: base, object."""
    T = Kinematics(world.arm_model).forward(world.arm.measured_rad)
    tool = T[:3, :3]
    place = T[:3, 3] + tool @ (np.array(offset_m) + (0, 0, world.layout.fingers.tcp_m))
    rotation = np.column_stack([tool[:, 1], tool[:, 2], tool[:, 0]])
    return Transform.from_parts("base", "object", rotation, place)


def _is_between(world: World) -> bool:
    grip = world.lock.grip()
    return grip is not None and grip.part == 0


def _part_in_gripper(world: World) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    poses = world.body_poses()
    part, grip = (
        mujoco.mj_name2id(world.model, mujoco.mjtObj.mjOBJ_BODY, n) for n in ("part0", "grip")
    )
    R = poses.rotation[grip]
    return R.T @ (poses.position_m[part] - poses.position_m[grip]), R.T @ poses.rotation[part]


def _angle_rad(before: NDArray[np.float64], after: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(rotvec_from_rotation(before.T @ after)))
