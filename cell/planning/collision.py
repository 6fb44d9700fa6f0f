"""Does this joint position hit anything? MuJoCo as a collision library: 10 us an answer.

The model holds the arm, the hand and the held part as things that move, and the cell and the
parts as last seen, baked in as things that stand. No physics is run and no simulator is used.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import IntFlag

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from drivers.arms import ArmModel, LinkShape
from hal import Layout, Transform
from perception.parts import Part

__all__ = ["CollisionModel", "Obstacle"]

HELD_SHRINK_M = 0.0015
HAND_QUAT_WXYZ = (0.5**0.5, 0.0, 0.5**0.5, 0.0)


class Bit(IntFlag):
    """Who may touch whom."""

    ARM = 1
    CELL = 2
    PARTS = 4
    BASE = 16


@dataclass(frozen=True)
class Obstacle:
    """A box that stands in the cell; ``size_m`` are whole edges."""

    name: str
    size_m: tuple[float, float, float]
    T_base_box: Transform


class CollisionModel:
    """The cell as it was last seen; made anew for each look."""

    def __init__(
        self,
        arm: ArmModel,
        layout: Layout,
        part: Part,
        *,
        parts: Sequence[Transform] = (),
        clutter_m: NDArray[np.float64] | None = None,
        clutter_size_m: float = 0.006,
        obstacles: Sequence[Obstacle] = (),
        margin_m: float = 0.0008,
        transit_margin_m: float = 0.006,
    ) -> None:
        spec = mujoco.MjSpec()
        _add_cell(spec.worldbody, layout, obstacles)
        for index, T_base_object in enumerate(parts):
            _add_part(spec.worldbody, part, T_base_object, f"part{index}")
        for point in () if clutter_m is None else clutter_m:
            _add_box(spec.worldbody, "", point, (clutter_size_m / 2,) * 3, Bit.PARTS)
        hand = _add_arm(spec, arm)
        _add_hand(hand, layout)
        held = hand.add_body(name="held")
        _add_part(held, part, Transform.identity("base", "object"), "held", shrink_m=HELD_SHRINK_M)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._tcp_m = layout.fingers.tcp_m
        self._held = self._model.body("held").id
        first = int(self._model.body_geomadr[self._held])
        self._held_geoms = np.arange(first, first + int(self._model.body_geomnum[self._held]))
        self._near_m, self._far_m = margin_m, transit_margin_m
        self._margin_m = -1.0
        self._movers = np.flatnonzero(self._model.body_weldid != 0)
        self._set_held(Bit(0))

    def hits(self, joints_rad: NDArray[np.float64], opening_m: float) -> bool:
        """Whether arm or hand touch anything, fingers ``opening_m`` apart."""
        return self._touch(joints_rad, opening_m, self._near_m) > 0

    def hits_in_transit(self, joints_rad: NDArray[np.float64], opening_m: float) -> bool:
        """Check as ``hits``, further off: blending cuts corners, and transits are fast."""
        return self._touch(joints_rad, opening_m, self._far_m) > 0

    @contextmanager
    def carrying(self, T_tcp_object: Transform) -> Iterator[None]:
        """Within this, ``hits_carried`` and ``hits_in_transit`` know how the part is held."""
        self._model.body_pos[self._held] = T_tcp_object.translation_m + (0, 0, self._tcp_m)
        self._model.body_quat[self._held] = T_tcp_object.quaternion_wxyz
        self._set_held(Bit.CELL | Bit.PARTS | Bit.BASE)
        try:
            yield
        finally:
            self._set_held(Bit(0))

    def hits_carried(self, joints_rad: NDArray[np.float64], opening_m: float) -> bool:
        """Whether the held part, a little shrunk, touches the cell; other parts may give way."""
        self._set_held(Bit.CELL)
        touches = self._touch(joints_rad, opening_m, 0.0)
        found = touches and bool(np.isin(self._data.contact.geom, self._held_geoms).any())
        self._set_held(Bit.CELL | Bit.PARTS | Bit.BASE)
        return bool(found)

    def _touch(self, joints_rad: NDArray[np.float64], opening_m: float, margin_m: float) -> int:
        data = self._data
        self._set_margin(margin_m)
        data.qpos[:6] = joints_rad
        data.qpos[6:8] = opening_m / 2
        mujoco.mj_kinematics(self._model, data)
        mujoco.mj_collision(self._model, data)
        return int(data.ncon)

    def _set_margin(self, margin_m: float) -> None:
        if margin_m == self._margin_m:
            return
        self._margin_m = margin_m
        self._model.body_margin[self._movers] = margin_m  # the broad phase's copy
        for body in self._movers:
            first = int(self._model.body_geomadr[body])
            if first >= 0:
                count = int(self._model.body_geomnum[body])
                self._model.geom_margin[first : first + count] = margin_m

    def _set_held(self, touches: Bit) -> None:
        self._model.geom_conaffinity[self._held_geoms] = int(touches)
        self._model.body_conaffinity[self._held] = int(touches)  # the broad phase's copy


def _add_box(
    body: "mujoco.MjsBody",
    name: str,
    centre_m: NDArray[np.float64],
    half_m: ArrayLike,
    kind: Bit,
    quat: ArrayLike = (1, 0, 0, 0),
) -> None:
    body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=centre_m,
        size=half_m,
        quat=quat,
        contype=int(kind),
        conaffinity=0,
    )


def _add_cell(world: "mujoco.MjsBody", layout: Layout, obstacles: Sequence[Obstacle]) -> None:
    world.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=(2, 2, 0.1),
        contype=int(Bit.CELL),
        conaffinity=0,
    )
    (x, y, z), wall = layout.bin.size_m, layout.bin.wall_m
    boxes = {
        "bin floor": ((0, 0, -0.015), (x / 2 + wall, y / 2 + wall, 0.015)),
        "bin wall +x": ((x / 2 + wall / 2, 0, z / 2), (wall / 2, y / 2 + wall, z / 2)),
        "bin wall -x": ((-x / 2 - wall / 2, 0, z / 2), (wall / 2, y / 2 + wall, z / 2)),
        "bin wall +y": ((0, y / 2 + wall / 2, z / 2), (x / 2 + wall, wall / 2, z / 2)),
        "bin wall -y": ((0, -y / 2 - wall / 2, z / 2), (x / 2 + wall, wall / 2, z / 2)),
    }
    T = layout.bin.T_base_bin
    for name, (centre, half) in boxes.items():
        _add_box(world, name, T.apply(np.array(centre)), half, Bit.CELL, T.quaternion_wxyz)
    T, (x, y) = layout.tray.T_base_tray, layout.tray.size_m
    depth = max(0.01, float(T.translation_m[2]))
    _add_box(
        world,
        "tray",
        T.apply(np.array([0, 0, -depth / 2])),
        (x / 2, y / 2, depth / 2),
        Bit.CELL,
        T.quaternion_wxyz,
    )
    for box in obstacles:
        half_m = np.array(box.size_m) / 2
        T = box.T_base_box
        _add_box(world, box.name, T.translation_m, half_m, Bit.CELL, T.quaternion_wxyz)


def _add_part(
    body: "mujoco.MjsBody", part: Part, T: Transform, name: str, *, shrink_m: float = 0.0
) -> None:
    """Stacked cylinders of the part's outline."""
    profile = part.profile
    for k, (centre_m, length_m, radius_m) in enumerate(
        zip(profile.centres_m, profile.lengths_m, profile.radii_m, strict=True)
    ):
        body.add_geom(
            name=f"{name} {k}",
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            pos=T.apply(np.array([0, 0, centre_m])),
            quat=T.quaternion_wxyz,
            size=(max(radius_m - shrink_m, 5e-4), max(length_m / 2 - shrink_m, 5e-4), 0),
            contype=int(Bit.PARTS) if name != "held" else 0,
            conaffinity=0,
        )


def _add_arm(spec: "mujoco.MjSpec", arm: ArmModel) -> "mujoco.MjsBody":
    body = spec.worldbody.add_body(name="base")
    for shape in arm.base_shapes:
        _add_link(body, shape, Bit.BASE, Bit(0))
    for k, axis in enumerate(arm.axes):
        body = body.add_body(name=f"link{k + 1}", pos=axis.offset_m)
        body.add_joint(name=f"axis{k + 1}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=axis.axis)
        _give_mass(body)
        for shape in axis.shapes:
            _add_link(body, shape, Bit.ARM if k > 1 else Bit.BASE, Bit.CELL | Bit.PARTS)
    hand = body.add_body(name="hand", quat=HAND_QUAT_WXYZ)
    _give_mass(hand)
    return hand


def _give_mass(body: "mujoco.MjsBody") -> None:
    """Kinematics needs none, the compiler insists."""
    body.mass, body.inertia, body.explicitinertial = 1.0, (1.0, 1.0, 1.0), True


def _add_link(body: "mujoco.MjsBody", shape: LinkShape, kind: Bit, touches: Bit) -> None:
    geom = mujoco.mjtGeom
    body.add_geom(
        type=geom.mjGEOM_CAPSULE if shape.kind == "capsule" else geom.mjGEOM_CYLINDER,
        fromto=(*shape.start_m, *shape.end_m),
        size=(shape.radius_m, 0, 0),
        contype=int(kind),
        conaffinity=int(touches),
    )


def _add_hand(hand: "mujoco.MjsBody", layout: Layout) -> None:
    touches = int(Bit.CELL | Bit.PARTS | Bit.BASE)
    hand.add_geom(
        name="palm",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=(0, 0, layout.fingers.palm_centre_m),
        size=np.array(layout.fingers.palm_size_m) / 2,
        contype=int(Bit.ARM),
        conaffinity=touches,
    )
    fingers = layout.fingers
    middle_m = fingers.tcp_m + 0.010 - fingers.length_m / 2
    for name, side in (("left", 1.0), ("right", -1.0)):
        finger = hand.add_body(name=f"finger {name}", pos=(0, side * fingers.thickness_m / 2, 0))
        finger.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=(0, side, 0))
        _give_mass(finger)
        finger.add_geom(
            name=f"finger {name}",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=(0, 0, middle_m),
            size=(fingers.width_m / 2, fingers.thickness_m / 2, fingers.length_m / 2),
            contype=int(Bit.ARM),
            conaffinity=touches,
        )
