"""The simulated arm's servo: joints follow their set-points, standing or on a path."""

import copy
from typing import Any, Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray

from drivers.arms import ArmModel
from hal import Fingers, Load
from sims.world.mjcf import inverse_mjcf
from sims.world.settings import Physics

__all__ = ["ArmServo", "Player"]

Joints = NDArray[np.float64]

STANDING_ERROR_RAD = 5e-5
STANDING_SPEED_RADPS = 2e-3
LONGEST_SETTLING_S = 0.25


class Player(Protocol):
    """What the servo follows: a path, a tick at a time. A shallow copy goes on by itself."""

    @property
    def is_done(self) -> bool:
        """Whether the last set-point has been given."""

    def next_joints_rad(self) -> Joints:
        """Return the set-point of the next tick."""

    def brake(self) -> None:
        """Come to a stand on the path; then it is done."""


class ArmServo:
    """Feed-forward by inverse dynamics of the arm alone, feedback by a joint controller.

    The feed-forward is computed from differences of the set-points, the way the engine will
    integrate them; with analytic derivatives the tracking error is fifty times larger. Damping
    is part of the torque given, not of the engine's joints and actuators: those it would
    integrate implicitly, after it has solved the contacts for accelerations that then do not
    come about, and parts in the gripper would be pushed about (decision 0002).
    """

    def __init__(
        self, model: Any, data: Any, arm: ArmModel, fingers: Fingers, physics: Physics
    ) -> None:
        self.arm = arm
        self._tick_s = physics.tick_s
        joint = model.joint("joint1").id
        first = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        # Views into the engine's arrays: six joints in a row, three controls for each.
        self._qpos: Joints = data.qpos[first[0] : first[0] + 6]
        self._qvel: Joints = data.qvel[first[1] : first[1] + 6]
        ctrl = int(model.actuator_ctrladr[model.actuator("joint1").id])
        self.controls: Joints = data.ctrl[ctrl : ctrl + 18].reshape(6, 3)
        self._model = mujoco.MjModel.from_xml_string(inverse_mjcf(arm, fingers, physics))
        self._inverse = mujoco.MjData(self._model)
        inverse = self._inverse
        self._given: tuple[Joints, Joints, Joints] = (inverse.qpos, inverse.qvel, inverse.qacc)
        self._torque: Joints = inverse.qfrc_inverse
        self._load_body = self._model.body("load").id
        self.velocity_gains = np.array([axis.velocity_gain for axis in arm.axes])
        self.target_rad: Joints = np.array(arm.home_rad)
        self.velocity_radps = np.zeros(6)
        self._player: Player | None = None
        self._settling_ticks = 0

    @property
    def measured_rad(self) -> Joints:
        """What the resolvers say, shape (6,)."""
        return self._qpos.copy()

    @property
    def is_standing(self) -> bool:
        """Whether no path is being followed and the joints have come to rest."""
        if self._player is not None:
            return False
        if self._settling_ticks * self._tick_s > LONGEST_SETTLING_S:
            return True
        error = np.abs(self._qpos - self.target_rad).max()
        speed = np.abs(self._qvel).max()
        return bool(error < STANDING_ERROR_RAD and speed < STANDING_SPEED_RADPS)

    @property
    def is_following(self) -> bool:
        """Whether a path is being followed; an arm that sways a little at its end is not."""
        return self._player is not None

    def follow(self, player: Player) -> None:
        """Follow a path that begins at ``target_rad``."""
        self._player = player

    def brake(self) -> None:
        """Come to a stand on the path; harmless when standing."""
        if self._player is not None:
            self._player.brake()

    def jump_to(self, joints_rad: NDArray[np.floating]) -> None:
        """Put the arm somewhere at once; for setting a scene, not for a device."""
        self._player = None
        self.target_rad = np.array(joints_rad, float)
        self.velocity_radps = np.zeros(6)
        self._qpos[:] = self.target_rad
        self._qvel[:] = 0.0

    def set_load(self, load: Load) -> None:
        """Tell the feed-forward what the flange carries, as a point mass."""
        mass_kg = max(load.mass_kg, 1e-9)
        self._model.body_mass[self._load_body] = mass_kg
        self._model.body_ipos[self._load_body] = load.centre_m
        mujoco.mj_setConst(self._model, self._inverse)

    def apply(self) -> None:
        """Write the controls of the tick that begins now."""
        now = self.target_rad
        if self._player is None:
            following = now
            self._settling_ticks += 1
        else:
            following = self._player.next_joints_rad()
            self._settling_ticks = 0
            if self._player.is_done:
                self._player = None
        velocity = (following - now) / self._tick_s
        joints, speeds, accelerations = self._given
        joints[:] = now
        speeds[:] = self.velocity_radps
        accelerations[:] = (velocity - self.velocity_radps) / self._tick_s
        mujoco.mj_inverse(self._model, self._inverse)
        self.controls[:, 0] = now
        lag = self.velocity_radps - self._qvel
        self.controls[:, 2] = self._torque + self.velocity_gains * lag
        self.target_rad = following
        self.velocity_radps = velocity

    def save(self) -> dict[str, Any]:
        """Everything the next tick depends on."""
        return {
            "target": self.target_rad.copy(),
            "velocity": self.velocity_radps.copy(),
            "player": copy.copy(self._player),
            "settling": self._settling_ticks,
            "load": (
                float(self._model.body_mass[self._load_body]),
                np.array(self._model.body_ipos[self._load_body]),
            ),
        }

    def restore(self, saved: dict[str, Any]) -> None:
        """Go on from ``save``."""
        self.target_rad = saved["target"].copy()
        self.velocity_radps = saved["velocity"].copy()
        self._player = copy.copy(saved["player"])
        self._settling_ticks = saved["settling"]
        mass_kg, centre_m = saved["load"]
        x, y, z = (float(c) for c in centre_m)
        self.set_load(Load(mass_kg, (x, y, z)))
