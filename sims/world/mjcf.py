"""The cell as MJCF text, from a layout, an arm and a part's shape.

Names, on which rendering, referee and planning rely:

* bodies ``part0``, ``part1``, ... (geoms ``part0_0``, ``part0_1``, ...), free joints of the
  same names as the bodies; ``grip`` (its frame is ``flange``), ``finger_left``,
  ``finger_right`` (geoms and slide joints of the same names), ``link1`` .. ``link6``;
* geoms ``floor``, ``bin_floor``, ``bin_left``, ``bin_right``, ``bin_front``, ``bin_back``,
  ``tray``, ``palm``, ``arm_base_0``, ``link1_0``, ...;
* geoms of group 5 are invisible guides that exist for filling only. They are compiled solid, so
  that the engine provides for them, and the world makes them hollow.

Collision bits: arm and fingers 1/2, bin, tray and floor 2/3, parts 6/3, guides 0/4.
"""

from drivers.arms import ArmModel, Axis, Inertial, LinkShape
from hal import Bin, Fingers, Layout, Tray
from sims.world.settings import Physics
from sims.world.shapes import PartShape, Primitive

__all__ = ["arm_mjcf", "cell_mjcf", "inverse_mjcf", "layout_mjcf", "part_body_mjcf"]

GUIDE_GROUP = 5
GUIDE_BIT = 4
BIN_FLOOR_M = 0.030  # thick, so that nothing falls through
GRIPPER_MASS_KG = 0.9
FINGER_MASS_KG = 0.06
STROKE_M = 0.035
# Memory for contacts: a pile needs much, and many empty worlds stand side by side in tests.
ARENA_M, EMPTY_ARENA_M = 200, 16


def _numbers(*values: float) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)


def _shape(name: str, shape: LinkShape) -> str:
    ends = _numbers(*shape.start_m, *shape.end_m)
    return (
        f'<geom name="{name}" class="arm" type="{shape.kind}" fromto="{ends}" '
        f'size="{_numbers(shape.radius_m)}"/>'
    )


def _inertial(inertial: Inertial) -> str:
    return (
        f'<inertial mass="{_numbers(inertial.mass_kg)}" pos="{_numbers(*inertial.centre_m)}" '
        f'diaginertia="{_numbers(*inertial.diagonal)}"/>'
    )


def _axis_open(number: int, axis: Axis, lower_rad: float, upper_rad: float) -> str:
    shapes = "".join(_shape(f"link{number}_{k}", s) for k, s in enumerate(axis.shapes))
    return (
        f'<body name="link{number}" pos="{_numbers(*axis.offset_m)}">{_inertial(axis.inertial)}'
        f'<joint name="joint{number}" axis="{_numbers(*axis.axis)}" '
        f'range="{_numbers(lower_rad, upper_rad)}" armature="{_numbers(axis.armature)}"/>'
        f"{shapes}"
    )


def arm_mjcf(arm: ArmModel, fingers: Fingers, physics: Physics, *, can_close: bool = True) -> str:
    """Return the body tree of arm and gripper; without ``can_close`` the fingers are fixed."""
    limits = zip(arm.axes, arm.limits.lower_rad, arm.limits.upper_rad, strict=True)
    base = "".join(_shape(f"arm_base_{k}", s) for k, s in enumerate(arm.base_shapes))
    opened = "".join(_axis_open(number, *axis) for number, axis in enumerate(limits, 1))
    # The flange's z is the last link's x.
    grip = (
        '<body name="grip" quat="0.70710678118654752 0 0.70710678118654752 0">'
        f'<inertial mass="{GRIPPER_MASS_KG}" pos="0 0 0.05" diaginertia="0.0012 0.0010 0.0006"/>'
        f'<site name="tcp" pos="{_numbers(0, 0, fingers.tcp_m)}"/>'
        f'<geom name="palm" class="arm" type="box" '
        f'size="{_numbers(*(side / 2 for side in fingers.palm_size_m))}" '
        f'pos="0 0 {fingers.palm_centre_m}"/>'
        f"{_finger('finger_left', 1, fingers, physics, can_close)}"
        f"{_finger('finger_right', -1, fingers, physics, can_close)}</body>"
    )
    return f'<body name="arm_base">{base}{opened}{grip}{"</body>" * len(arm.axes)}</body>'


def _finger(name: str, side: int, fingers: Fingers, physics: Physics, can_close: bool) -> str:
    servo = physics.fingers
    middle = fingers.tcp_m + 0.010 - fingers.length_m / 2
    joint = (
        f'<joint name="{name}" type="slide" axis="0 {side} 0" range="0 {STROKE_M / 2}" '
        f'armature="{_numbers(servo.armature_kg)}" damping="{_numbers(servo.joint_damping)}" '
        f'solreflimit="{physics.stop_contact.solref}" solimplimit="{physics.stop_contact.solimp}"/>'
    )
    sizes = _numbers(fingers.width_m / 2, fingers.thickness_m / 2, fingers.length_m / 2)
    return (
        f'<body name="{name}" pos="0 {_numbers(side * fingers.thickness_m / 2)} 0">'
        f'<inertial mass="{FINGER_MASS_KG}" pos="0 0 {_numbers(middle)}" '
        f'diaginertia="3e-5 3e-5 5e-6"/>{joint if can_close else ""}'
        f'<geom name="{name}" class="finger" type="box" size="{sizes}" '
        f'pos="0 0 {_numbers(middle)}"/></body>'
    )


def layout_mjcf(layout: Layout) -> str:
    """Return floor, bin, tray and the guides over the bin."""
    return (
        '<geom name="floor" class="still" type="plane" size="3 3 .1"/>'
        + _bin(layout.bin)
        + _tray(layout.tray)
    )


def _frame(name: str, transform_parts: tuple[str, str], inner: str) -> str:
    position, quaternion = transform_parts
    return f'<body name="{name}" pos="{position}" quat="{quaternion}">{inner}</body>'


def _bin(box: Bin) -> str:
    x, y, z = box.size_m
    wall = box.wall_m
    sides = {
        "bin_floor": ((0, 0, -BIN_FLOOR_M / 2), (x / 2 + wall, y / 2 + wall, BIN_FLOOR_M / 2)),
        "bin_back": ((-x / 2 - wall / 2, 0, z / 2), (wall / 2, y / 2 + wall, z / 2)),
        "bin_front": ((x / 2 + wall / 2, 0, z / 2), (wall / 2, y / 2 + wall, z / 2)),
        "bin_right": ((0, -y / 2 - wall / 2, z / 2), (x / 2 + wall, wall / 2, z / 2)),
        "bin_left": ((0, y / 2 + wall / 2, z / 2), (x / 2 + wall, wall / 2, z / 2)),
    }
    inner = "".join(
        f'<geom name="{name}" class="still" type="box" pos="{_numbers(*centre)}" '
        f'size="{_numbers(*half)}"/>'
        for name, (centre, half) in sides.items()
    )
    height, thick = 4.0, 0.05
    for k, (dx, dy, hx, hy) in enumerate(
        (
            (-x / 2 - thick, 0, thick, y / 2 + 2 * thick),
            (x / 2 + thick, 0, thick, y / 2 + 2 * thick),
            (0, -y / 2 - thick, x / 2 + 2 * thick, thick),
            (0, y / 2 + thick, x / 2 + 2 * thick, thick),
        )
    ):
        inner += (
            f'<geom name="guide{k}" type="box" group="{GUIDE_GROUP}" contype="0" '
            f'conaffinity="{GUIDE_BIT}" '
            f'rgba="0 0 0 0" pos="{_numbers(dx, dy, z + height)}" '
            f'size="{_numbers(hx, hy, height)}"/>'
        )
    pose = box.T_base_bin
    return _frame("bin", (_numbers(*pose.translation_m), _numbers(*pose.quaternion_wxyz)), inner)


def _tray(tray: Tray) -> str:
    pose = tray.T_base_tray
    depth = max(0.010, float(pose.translation_m[2]))  # solid down to the floor
    half = _numbers(tray.size_m[0] / 2, tray.size_m[1] / 2, depth / 2)
    inner = (
        f'<geom name="tray" class="foam" type="box" pos="0 0 {_numbers(-depth / 2)}" '
        f'size="{half}"/>'
    )
    return _frame("tray", (_numbers(*pose.translation_m), _numbers(*pose.quaternion_wxyz)), inner)


def part_body_mjcf(name: str, shape: PartShape, physics: Physics) -> str:
    """Return one free body at the origin, named ``name``.

    It is compiled weightless, so that the engine provides for it; the world gives it weight.
    """
    geoms = "".join(_primitive(f"{name}_{k}", k, p) for k, p in enumerate(shape.primitives))
    return (
        f'<body name="{name}" gravcomp="1"><joint name="{name}" type="free" '
        f'damping="{_numbers(physics.free_damping(shape.inertia))}"/>'
        f'<inertial mass="{_numbers(shape.mass_kg)}" pos="{_numbers(*shape.centre_m)}" '
        f'diaginertia="{_numbers(*shape.inertia)}"/>{geoms}</body>'
    )


def _primitive(name: str, index: int, primitive: Primitive) -> str:
    place = f'pos="{_numbers(*primitive.centre_m)}" quat="{_numbers(*primitive.quaternion_wxyz)}"'
    what = f'size="{_numbers(*primitive.size_m)}"' if primitive.size_m else f'mesh="hull{index}"'
    return f'<geom name="{name}" class="part" type="{primitive.kind}" {what} {place}/>'


def _hulls(shape: PartShape | None) -> str:
    if shape is None:
        return ""
    return "".join(
        f'<mesh name="hull{k}" vertex="{" ".join(_numbers(*v) for v in p.vertices_m)}"/>'
        for k, p in enumerate(shape.primitives)
        if p.kind == "mesh"
    )


def _head(physics: Physics, solver: str, parts: int) -> str:
    contact = physics.part_contact
    mu = physics.part_friction
    return f"""
<compiler angle="radian" autolimits="true"/>
<option timestep="{physics.tick_s:g}" integrator="implicitfast" solver="{solver}" cone="elliptic"
 impratio="{physics.impratio:g}" noslip_iterations="{physics.noslip_iterations}"
 ccd_tolerance="1e-9" ccd_iterations="100" ls_iterations="{physics.line_search_iterations}"
 iterations="{physics.iterations}"
 tolerance="{physics.tolerance:g}" sleep_tolerance="{physics.sleep_tolerance:g}">
 <flag sleep="enable" multiccd="enable"/></option>
<size memory="{ARENA_M if parts else EMPTY_ARENA_M}M"/>
<default><geom solref="{contact.solref}" solimp="{contact.solimp}"/>
 <default class="arm"><geom contype="1" conaffinity="2" friction="0.3"/></default>
 <default class="finger"><geom contype="1" conaffinity="2" condim="4" priority="1"
  friction="{physics.pad_friction:g} {physics.pad_torsion_m:g} 0.0001"
  solimp="0.99 0.99 0.001"/></default>
 <default class="still"><geom contype="2" conaffinity="3" friction="{mu:g}"/></default>
 <default class="foam"><geom contype="2" conaffinity="3" condim="6" priority="1"
  friction="{physics.foam_friction:g} 0.02 {physics.foam_rolling_m:g}"/></default>
 <default class="part"><geom contype="6" conaffinity="3" friction="{mu:g} 0.001 0.0001"
  mass="0"/></default>
</default>"""


def _actuators(arm: ArmModel, physics: Physics) -> str:
    pids = "".join(
        f'<pid name="joint{k}" joint="joint{k}" kp="{_numbers(axis.position_gain)}" '
        f'input="pos vel ff" '
        f'forcerange="{_numbers(-axis.torque_nm, axis.torque_nm)}"/>'
        for k, axis in enumerate(arm.axes, 1)
    )
    servo = physics.fingers
    # Coefficients 1, 1: the actuator's force is the force of each finger.
    return (
        '<tendon><fixed name="width"><joint joint="finger_left" coef="1"/>'
        '<joint joint="finger_right" coef="1"/></fixed></tendon>'
        f'<actuator>{pids}<position name="fingers" tendon="width" kp="{_numbers(servo.gain)}" '
        f'kv="{_numbers(servo.damping)}" forcerange="-100 100"/></actuator>'
    )


def _equalities(parts: int, physics: Physics) -> str:
    lock = physics.lock_contact
    welds = "".join(
        f'<weld name="lock{k}" body1="grip" body2="part{k}" active="false" '
        f'solref="{lock.solref}" solimp="{lock.solimp}"/>'
        for k in range(parts)
    )
    return (
        f"<equality>{welds}"
        '<joint name="fingers" joint1="finger_left" joint2="finger_right" '
        'solref="0.004 1" solimp="0.95 0.99 0.001"/></equality>'
    )


def cell_mjcf(
    layout: Layout, arm: ArmModel, shape: PartShape | None, parts: int, physics: Physics
) -> str:
    """Return the whole cell with ``parts`` parts of one shape, all at the origin."""
    # CG needs fewer operations on large piles, and does not converge on hulls.
    is_turned = shape is not None and all(p.kind == "cylinder" for p in shape.primitives)
    solver = "CG" if parts > physics.newton_up_to and is_turned else "Newton"
    bodies = "".join(
        part_body_mjcf(f"part{k}", shape, physics) for k in range(parts) if shape is not None
    )
    return f"""<mujoco model="cell">{_head(physics, solver, parts)}
<asset>{_hulls(shape)}</asset>
<worldbody>{layout_mjcf(layout)}{arm_mjcf(arm, layout.fingers, physics)}{bodies}</worldbody>
{_actuators(arm, physics)}{_equalities(parts, physics)}
</mujoco>"""


def inverse_mjcf(arm: ArmModel, fingers: Fingers, physics: Physics) -> str:
    """Return the arm alone, fingers fixed, with a body ``load`` that set_load fills."""
    tree = arm_mjcf(arm, fingers, physics, can_close=False).replace(
        '<site name="tcp"',
        '<body name="load"><inertial mass="1e-9" pos="0 0 0" diaginertia="1e-12 1e-12 1e-12"/>'
        '</body><site name="tcp"',
    )
    return f"""<mujoco model="arm">{_head(physics, "Newton", 0)}
<option><flag contact="disable" limit="disable" actuation="disable" equality="disable"
 sleep="disable"/></option>
<worldbody>{tree}</worldbody></mujoco>"""
