"""The contact-gated lock: what stiction is to real fingers.

Regularised friction has no stick: the engine leaves the centripetal term out of a contact's
relative acceleration and makes up for it by a creeping speed, about 10 mm in a fast transfer
whatever the friction. The lock is a weld between gripper and part that holds only what friction
could hold: it closes while BOTH fingers press that part and it rests between them, and opens
when the gripper must give the part a wrench that the two contacts could not carry by friction,
or when a contact ends. Every change is an event with its numbers.

The wrench that counts is the gripper's whole action on the part, weld and pads together: the
two pull against each other by as much as the pads' friction, and only the sum is real.
"""

import copy
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from sims.world.fingers import FingerAxis

__all__ = ["Grip", "Lock", "LockEvent"]

CLOSE_FORCE_N = 20.0
CLOSE_S = 0.010
RECLOSE_S = 0.050  # after sliding the part must come to rest first
CLOSE_SPEED_MPS = 0.005
TURN_LEVER_M = 0.020  # weighs turning against sliding
CLOSE_USE = 0.9
OVERLOAD_TICKS = 2  # one tick may be the contact detection's noise
CONTACT_LOST_TICKS = 2
LEAST_PATCH_M = 3e-4


@dataclass(frozen=True)
class Grip:
    """What both fingers do to one part at an instant.

    ``normal_n`` is the normal force of the left and the right finger; ``friction`` the
    coefficient of the pads; ``patch_m`` the mean distance of pressure from the middle of the
    contact, the lever of friction against turning about the closing direction; ``width_m`` the
    distance of the two contacts; ``centre_m`` the point between them, frame ``base``.
    ``force_n`` and ``torque_nm`` are all the gripper does to the part, weld included, about
    that point in the flange frame (y closes).
    """

    part: int
    normal_n: tuple[float, float]
    friction: float
    patch_m: float
    width_m: float
    centre_m: NDArray[np.float64]
    force_n: NDArray[np.float64]
    torque_nm: NDArray[np.float64]

    @property
    def use(self) -> float:
        """The share of both contacts' friction that the wrench uses; sliding begins at 1.

        An ellipsoid in what friction bears. Sliding along x and z: mu (N1 + N2). Turning about
        y: mu (N1 + N2) times the patch's lever. Turning about x and z: friction at the two
        contacts pulling opposite ways, mu (N1 + N2) times half their distance, plus the
        pressure moving within the patch. Along y the force may shift from one finger to the
        other until one has none left.
        """
        total = max(sum(self.normal_n), 1e-9)
        sliding = max(self.friction * total, 1e-9)
        lever = self.width_m / 2 + self.patch_m / max(self.friction, 1e-9)
        along = np.hypot(self.force_n[0], self.force_n[2]) / sliding
        spin = self.torque_nm[1] / (sliding * self.patch_m)
        tilt = np.hypot(self.torque_nm[0], self.torque_nm[2]) / (sliding * lever)
        shift = self.force_n[1] / total
        return float(np.sqrt(along**2 + spin**2 + tilt**2 + shift**2))


@dataclass(frozen=True)
class LockEvent:
    """``use`` is the share of the friction capacity in use, 1 at the limit."""

    tick: int
    part: int
    is_locked: bool
    reason: str
    normal_n: tuple[float, float]
    force_n: float
    torque_nm: float
    use: float


class Lock:
    """At most one part is locked at a time."""

    def __init__(self, model: Any, data: Any, fingers: FingerAxis, parts: int) -> None:
        self._model, self._data, self._fingers = model, data, fingers
        self._tick_s = float(model.opt.timestep)
        self._wrench = np.zeros(6)
        self._grip_body = model.body("grip").id
        self._pads = (model.geom("finger_left").id, model.geom("finger_right").id)
        self._bodies = [model.body(f"part{k}").id for k in range(parts)]
        self._welds = [model.equality(f"lock{k}").id for k in range(parts)]
        self._part_of_body = {body: k for k, body in enumerate(self._bodies)}
        self.events: list[LockEvent] = []
        self.part: int | None = None
        self.is_inhibited = False
        self.is_disabled = False  # for benches that show what would be without
        self._pad_friction = float(model.geom_friction[self._pads[0], 0])
        self._ready_ticks = 0
        self._ready_part = -1
        self._lost_ticks = 0
        self._overload_ticks = 0
        self._has_slid = False
        self.peak_use = 0.0

    def apply(self, tick: int) -> None:
        """Judge the contacts of the last step; close or open."""
        if self.is_disabled:
            return
        if self.part is None and not self._fingers.is_gripping:
            self._ready_ticks = 0
            self._has_slid = False
            if self.is_inhibited:
                self.set_pad_friction(self._pad_friction)
            return
        grip = self.grip()
        if self.part is None:
            self._consider_closing(tick, grip)
        else:
            self._consider_opening(tick, grip)

    def set_pad_friction(self, friction: float) -> None:
        """Change what the pads grip with, from now on."""
        if not friction >= 0:
            raise ValueError(f"a friction of {friction:g}")
        self._pad_friction = friction
        self._model.geom_friction[list(self._pads), 0] = friction
        self.is_inhibited = False

    def make_slippery(self) -> None:
        """No friction and no lock until the fingers have opened."""
        self._model.geom_friction[list(self._pads), 0] = 0.0
        self.is_inhibited = True

    def grip(self) -> Grip | None:
        """What both fingers touch now; None unless both touch one and the same part."""
        contacts = self._data.contact
        pairs = np.asarray(contacts.geom).reshape(-1, 2)
        sides = []
        for pad in self._pads:
            touching = np.flatnonzero((pairs == pad).any(axis=1))
            sides.append([int(c) for c in touching if self._part_at(pairs[c]) is not None])
        if not all(sides):
            return None
        parts = {self._part_at(pairs[c]) for side in sides for c in side}
        if len(parts) != 1:
            return None
        return self._measure(parts.pop() or 0, sides)

    def _part_at(self, pair: NDArray[np.int32]) -> int | None:
        for geom in pair:
            part = self._part_of_body.get(int(self._model.geom_bodyid[geom]))
            if part is not None:
                return part
        return None

    def _measure(self, part: int, sides: list[list[int]]) -> Grip:
        data = self._data
        normal, centres, patches = [], [], []
        force, torque = np.zeros(3), np.zeros(3)  # about the base's origin
        for pad, side in zip(self._pads, sides, strict=True):
            pressures, points = [], []
            for c in side:
                pressure, point, push, turn = self._push(c, pad)
                force += push
                torque += turn + _cross(point, push)
                pressures.append(pressure)
                points.append(point)
            weight = np.array(pressures) + 1e-9
            place = np.array(points)
            centre = weight @ place / weight.sum()
            # Contacts sit at the ends of the touching line, the pressure all along it.
            spread = weight @ np.sqrt(((place - centre) ** 2).sum(axis=1)) / weight.sum()
            normal.append(float(sum(pressures)))
            centres.append(centre)
            patches.append(float(spread) / 2)
        centre = (centres[0] + centres[1]) / 2
        weld_force, weld_torque = self._weld(part, centre)
        torque += weld_torque - _cross(centre, force)
        force += weld_force
        rotation = data.xmat[self._grip_body].reshape(3, 3)
        return Grip(
            part=part,
            normal_n=(normal[0], normal[1]),
            friction=float(data.contact[sides[0][0]].friction[0]),
            patch_m=max(LEAST_PATCH_M, min(patches)),
            width_m=float(np.linalg.norm(centres[0] - centres[1])),
            centre_m=centre,
            force_n=rotation.T @ force,
            torque_nm=rotation.T @ torque,
        )

    def _push(
        self, index: int, pad: int
    ) -> tuple[float, NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """One contact of a pad: pressure, place, force on the part, torque on it there."""
        wrench = self._wrench
        mujoco.mj_contactForce(self._model, self._data, index, wrench)
        contact = self._data.contact[index]
        # The engine's force acts on the second geom.
        sign = -1.0 if contact.geom[1] == pad else 1.0
        turned = sign * (wrench.reshape(2, 3) @ contact.frame.reshape(3, 3))
        return max(0.0, float(wrench[0])), np.array(contact.pos), turned[0], turned[1]

    def _weld(
        self, part: int, centre_m: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return force and torque of the weld on the part about a point, frame ``base``."""
        model, data = self._model, self._data
        if self.part != part:
            return np.zeros(3), np.zeros(3)
        rows = np.flatnonzero(
            (data.efc_id == self._welds[part])
            & (data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        )
        if not len(rows):
            return np.zeros(3), np.zeros(3)
        only = np.zeros(data.nefc)
        only[rows] = data.efc_force[rows]
        joint_force = np.zeros(model.nv)
        mujoco.mj_mulJacTVec(model, data, joint_force, only)
        body = self._bodies[part]
        first = model.jnt_dofadr[model.body_jntadr[body]]
        force = joint_force[first : first + 3]
        # A free joint turns about the body's origin, in the body's frame.
        turn = data.xmat[body].reshape(3, 3) @ joint_force[first + 3 : first + 6]
        return force, turn + _cross(data.xpos[body] - centre_m, force)

    def _consider_closing(self, tick: int, grip: Grip | None) -> None:
        is_ready = (
            grip is not None
            and not self.is_inhibited
            and min(grip.normal_n) >= CLOSE_FORCE_N
            and grip.use < CLOSE_USE
            and self._creep_mps(grip) < CLOSE_SPEED_MPS
        )
        if grip is None or not is_ready or grip.part != self._ready_part:
            self._ready_ticks = 0
            self._ready_part = grip.part if grip is not None else -1
            return
        self._ready_ticks += 1
        wait_s = RECLOSE_S if self._has_slid else CLOSE_S
        if self._ready_ticks * self._tick_s >= wait_s:
            self._close(tick, grip)

    def _creep_mps(self, grip: Grip) -> float:
        """How fast the part slides and turns in the gripper, at the contact."""
        speeds = []
        for body in (self._grip_body, self._bodies[grip.part]):
            move = np.zeros((3, self._model.nv))
            turn = np.zeros((3, self._model.nv))
            mujoco.mj_jac(self._model, self._data, move, turn, grip.centre_m, body)
            speeds.append((move @ self._data.qvel, turn @ self._data.qvel))
        slide = np.linalg.norm(speeds[0][0] - speeds[1][0])
        turn_speed = np.linalg.norm(speeds[0][1] - speeds[1][1])
        return float(slide + TURN_LEVER_M * turn_speed)

    def _close(self, tick: int, grip: Grip) -> None:
        data, body, weld = self._data, self._bodies[grip.part], self._welds[grip.part]
        # The pose of the last step's start: positions and contacts belong together.
        rotation = data.xmat[self._grip_body].reshape(3, 3)
        turned, relative = np.zeros(4), np.zeros(4)
        mujoco.mju_negQuat(turned, data.xquat[self._grip_body])
        mujoco.mju_mulQuat(relative, turned, data.xquat[body])
        settings = self._model.eq_data[weld]
        settings[0:3] = 0.0
        settings[3:6] = rotation.T @ (data.xpos[body] - data.xpos[self._grip_body])
        settings[6:10] = relative
        settings[10] = 1.0
        data.eq_active[weld] = 1
        self.part = grip.part
        self.peak_use = 0.0
        self._lost_ticks = self._ready_ticks = 0
        self._overload_ticks = 0
        self._tell(tick, grip.part, True, "both fingers", grip)

    def _consider_opening(self, tick: int, grip: Grip | None) -> None:
        if not self._fingers.is_gripping:
            self.open(tick, "fingers opened")
            return
        if self.is_inhibited:
            self.open(tick, "made to drop")
            return
        if grip is None or grip.part != self.part:
            self._lost_ticks += 1
            if self._lost_ticks >= CONTACT_LOST_TICKS:
                self.open(tick, "contact lost")
            return
        self._lost_ticks = 0
        self.peak_use = max(self.peak_use, grip.use)
        self._overload_ticks = self._overload_ticks + 1 if grip.use > 1 else 0
        if self._overload_ticks >= OVERLOAD_TICKS:
            self._has_slid = True
            self.open(tick, "friction exceeded", grip)

    def open(self, tick: int, reason: str, grip: Grip | None = None) -> None:
        """Let go and say why; harmless when nothing is locked."""
        if self.part is None:
            return
        self._data.eq_active[self._welds[self.part]] = 0
        self._tell(tick, self.part, False, reason, grip)
        self.part = None
        self._ready_ticks = 0

    def _tell(self, tick: int, part: int, is_locked: bool, reason: str, grip: Grip | None) -> None:
        if grip is None:
            event = LockEvent(tick, part, is_locked, reason, (0.0, 0.0), 0.0, 0.0, 0.0)
        else:
            force_n = float(np.linalg.norm(grip.force_n))
            torque_nm = float(np.linalg.norm(grip.torque_nm))
            event = LockEvent(
                tick, part, is_locked, reason, grip.normal_n, force_n, torque_nm, grip.use
            )
        self.events.append(event)

    def save(self) -> dict[str, Any]:
        """Everything the next tick depends on."""
        names = (
            "part",
            "is_inhibited",
            "_pad_friction",
            "peak_use",
            "_ready_ticks",
            "_ready_part",
            "_lost_ticks",
            "_overload_ticks",
            "_has_slid",
        )
        return {"events": copy.copy(self.events), **{n: getattr(self, n) for n in names}}

    def restore(self, saved: dict[str, Any]) -> None:
        """Go on from ``save``."""
        for name, value in saved.items():
            setattr(self, name, copy.copy(value))


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vector product of two (3,) vectors, without numpy's general machinery."""
    return np.array(
        (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    )
