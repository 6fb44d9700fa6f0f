"""The simulated cell: one MuJoCo model, stepped a tick at a time by the event loop.

Only the loop's thread may touch ``model`` and ``data``. The order of a tick is fixed: arm,
fingers, lock, physics, then whoever waits for a condition.
"""

import asyncio
import copy
import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from drivers.arms import ARMS, ArmModel
from hal import Layout, Transform
from sims.world.arm import ArmServo
from sims.world.cabinet import Cabinet
from sims.world.errors import SimulationError
from sims.world.fingers import FingerAxis
from sims.world.lock import Lock
from sims.world.mjcf import GUIDE_BIT, GUIDE_GROUP, cell_mjcf
from sims.world.settings import Physics
from sims.world.shapes import PartShape

__all__ = ["BodyPoses", "World"]

log = logging.getLogger(__name__)

# The engine would otherwise write its warnings to a file in whatever folder one stands in.
mujoco.set_mju_user_warning(lambda text: log.warning("engine: %s", text))

DEFAULT_ARM = "irb1200-5-0.9"
TROUBLES = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)
PARKED_AT_M = (-1.2, -1.5, 2.5)


@dataclass(frozen=True, eq=False)
class BodyPoses:
    """Where every body was at one instant: a copy, safe to use in another thread.

    ``position_m`` has shape (nbody, 3), ``rotation`` (nbody, 3, 3), frame ``base``, in the
    model's order; the same for geoms.
    """

    tick: int
    position_m: NDArray[np.float64]
    rotation: NDArray[np.float64]
    geom_position_m: NDArray[np.float64]
    geom_rotation: NDArray[np.float64]


class World:
    """Arm, gripper, bin, tray and ``parts`` parts of one shape.

    Parts begin parked: weightless, out of sight, asleep. ``piles.fill`` drops them.
    The frame ``base`` is the world's.
    """

    def __init__(
        self,
        *,
        shape: PartShape | None = None,
        parts: int = 0,
        layout: Layout | None = None,
        arm: ArmModel | None = None,
        physics: Physics | None = None,
    ) -> None:
        if parts and shape is None:
            raise ValueError("parts need a shape")
        self.layout = layout or Layout()
        self.physics = physics or Physics()
        self.arm_model = arm or ARMS[DEFAULT_ARM]
        self.shape = shape
        self.parts = parts
        text = cell_mjcf(self.layout, self.arm_model, shape, parts, self.physics)
        self.model: Any = mujoco.MjModel.from_xml_string(text)
        self.data: Any = mujoco.MjData(self.model)
        self._troubles = [self.data.warning[kind] for kind in TROUBLES]
        self._scratch: Any = mujoco.MjData(self.model)
        self.ticks = 0
        self.arm = ArmServo(
            self.model, self.data, self.arm_model, self.layout.fingers, self.physics
        )
        self.fingers = FingerAxis(self.model, self.data, self.physics)
        self.lock = Lock(self.model, self.data, self.fingers, parts)
        self.cabinet = Cabinet(self.arm)
        self._bodies = [self.model.body(f"part{k}").id for k in range(parts)]
        self._guides = np.flatnonzero(self.model.geom_group == GUIDE_GROUP)
        self.set_guides(is_solid=False)
        self._stiffen_pads()
        self._waiting: list[tuple[Callable[[], bool], asyncio.Future[None]]] = []
        joints = [self.model.joint(f"part{k}").id for k in range(parts)]
        self._qpos = [int(self.model.jnt_qposadr[j]) for j in joints]
        self._dof = [int(self.model.jnt_dofadr[j]) for j in joints]
        self.arm.jump_to(np.array(self.arm_model.home_rad))
        for k in range(parts):
            self.park(k)
        mujoco.mj_forward(self.model, self.data)

    @property
    def tick_ns(self) -> int:
        """Length of a tick."""
        return self.physics.tick_ns

    def step(self) -> None:
        """Let one tick pass.

        Raises
        ------
        SimulationError
            The state is no longer finite.
        """
        self.cabinet.apply()
        self.arm.apply()
        self.fingers.apply()
        self.lock.apply(self.ticks)
        mujoco.mj_step(self.model, self.data)
        self.ticks += 1
        if any(trouble.number for trouble in self._troubles):
            raise SimulationError(f"the physics blew up in tick {self.ticks}")
        if self._waiting:
            self._wake()

    def step_for(self, duration_s: float) -> None:
        """Step without a loop, for setting a scene."""
        for _ in range(round(duration_s / self.physics.tick_s)):
            self.step()

    def until(self, condition: Callable[[], bool]) -> "asyncio.Future[None]":
        """Return a future that is done once the condition holds, looked at after each tick."""
        future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        if condition():
            future.set_result(None)
        else:
            self._waiting.append((condition, future))
        return future

    def _wake(self) -> None:
        still = []
        for condition, future in self._waiting:
            if future.done():
                continue
            if condition():
                future.set_result(None)
            else:
                still.append((condition, future))
        self._waiting = still

    # Parts.

    def part_pose(self, part: int) -> Transform:
        """Return where a part truly is, ``T_base_object``."""
        start = self._qpos[part]
        qpos = self.data.qpos
        return Transform.from_quaternion(
            "base", "object", qpos[start + 3 : start + 7], qpos[start : start + 3]
        )

    def part_speed(self, part: int) -> tuple[float, float]:
        """Return linear (m/s) and angular (rad/s) speed."""
        velocity = self.data.qvel[self._dof[part] : self._dof[part] + 6]
        return float(np.linalg.norm(velocity[:3])), float(np.linalg.norm(velocity[3:]))

    def put_part(self, part: int, T_base_object: Transform, *, is_floating: bool = False) -> None:
        """Put a part somewhere at rest; floating, it stays there until something pushes it."""
        if self.lock.part == part:
            self.lock.open(self.ticks, "taken away")
        start, dof = self._qpos[part], self._dof[part]
        self.data.qpos[start : start + 3] = T_base_object.translation_m
        self.data.qpos[start + 3 : start + 7] = T_base_object.quaternion_wxyz
        self.data.qvel[dof : dof + 6] = 0.0
        self.data.qacc_warmstart[dof : dof + 6] = 0.0
        self.set_floating(part, is_floating)
        self.refresh()

    def refresh(self) -> None:
        """Work out everything that follows from where things were put."""
        # Kinematics is not enough: a sleeping tree keeps its old place until all is computed.
        mujoco.mj_forward(self.model, self.data)

    def set_guides(self, *, is_solid: bool) -> None:
        """Put the invisible walls over the bin up for filling, or take them away."""
        self.model.geom_conaffinity[self._guides] = GUIDE_BIT if is_solid else 0

    def _stiffen_pads(self) -> None:
        weight = self.model.body_invweight0[:, 0]
        part = weight[self._bodies[0]] if self._bodies else 0.0
        for name in ("finger_left", "finger_right"):
            finger = weight[self.model.body(name).id]
            impedance = self.physics.pad_impedance(float(finger + part))
            self.model.geom_solimp[self.model.geom(name).id, :2] = impedance

    def set_floating(self, part: int, is_floating: bool) -> None:
        """Take a part's weight away, or give it back."""
        self.model.body_gravcomp[self._bodies[part]] = 1.0 if is_floating else 0.0

    def park(self, part: int) -> None:
        """Take a part out of the cell."""
        reach = self.shape.reach_m if self.shape is not None else 0.1
        row, column = divmod(part, 10)
        x, y, z = PARKED_AT_M
        place = (x - row * 2.5 * reach, y + column * 2.5 * reach, z)
        start, dof = self._qpos[part], self._dof[part]
        self.data.qpos[start : start + 3] = place
        self.data.qpos[start + 3 : start + 7] = (1.0, 0.0, 0.0, 0.0)
        self.data.qvel[dof : dof + 6] = 0.0
        self.set_floating(part, True)

    def is_parked(self, part: int) -> bool:
        """Whether a part is out of the cell."""
        return bool(self.data.qpos[self._qpos[part]] < PARKED_AT_M[0] + 0.2)

    def dof_address(self, part: int) -> int:
        """Where a part's six velocities begin."""
        return self._dof[part]

    def is_awake(self, part: int) -> bool:
        """Whether a part is not asleep."""
        return bool(self.data.tree_asleep[self.model.body_treeid[self._bodies[part]]] < 0)

    # Looking.

    def body_poses(self) -> BodyPoses:
        """Copy where everything is now; for the camera, at exposure."""
        # In another MjData: the physics must not notice that somebody looked.
        data = self._scratch
        data.qpos[:] = self.data.qpos
        mujoco.mj_kinematics(self.model, data)
        return BodyPoses(
            self.ticks,
            data.xpos.copy(),
            data.xmat.reshape(-1, 3, 3).copy(),
            data.geom_xpos.copy(),
            data.geom_xmat.reshape(-1, 3, 3).copy(),
        )

    # Snapshots.

    def save(self) -> "Snapshot":
        """Copy the whole world and its controllers, not the devices in front of it."""
        return Snapshot(
            self.ticks,
            copy.copy(self.data),
            {name: getattr(self.model, name).copy() for name in CHANGING},
            self.arm.save(),
            self.fingers.save(),
            self.lock.save(),
            self.cabinet.save(),
        )

    def restore(self, snapshot: "Snapshot") -> None:
        """Go on from a snapshot of this very world, bit for bit.

        Commands under way at devices are not part of it: their futures stay pending.
        """
        mujoco.mj_copyData(self.data, self.model, snapshot.data)
        for name, value in snapshot.changing.items():
            getattr(self.model, name)[:] = value
        self.ticks = snapshot.ticks
        self.arm.restore(snapshot.arm)
        self.fingers.restore(snapshot.fingers)
        self.lock.restore(snapshot.lock)
        self.cabinet.restore(snapshot.cabinet)


# What of the model a running world changes: weight, locks, guides, faults, finger force.
CHANGING = (
    "body_gravcomp",
    "eq_data",
    "geom_conaffinity",
    "geom_friction",
    "jnt_range",
    "dof_damping",
    "actuator_forcerange",
)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A world at an instant, in memory."""

    ticks: int
    data: Any
    changing: dict[str, NDArray[np.float64]]
    arm: dict[str, Any]
    fingers: Any
    lock: dict[str, Any]
    cabinet: Any
