import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cell.grasp import GraspKind, shaft_candidates
from cell.slots import NextSlot, Slots
from hal import Fingers, GripperLimits, Transform, Tray, rotation_from_rotvec
from perception.parts import load_part

SHAFT = load_part("shaft")
FINGERS, TRAY = Fingers(), Tray()


def lying(yaw=0.3, tilt=0.0, flip=False):
    rotation = rotation_from_rotvec((0, 0, yaw)) @ rotation_from_rotvec((0, np.pi / 2 + tilt, 0))
    if flip:
        rotation = rotation @ np.diag([1.0, -1.0, -1.0])
    return Transform.from_parts("base", "object", rotation, (0.55, 0.02, 0.08))


def candidates(pose, part=SHAFT, **changes):
    options = {
        "index": 3,
        "fingers": FINGERS,
        "limits": GripperLimits(),
        "opening_margin_m": 0.006,
        "max_tilt_rad": 0.87,
    }
    return shaft_candidates(part, pose, **(options | changes))


@given(st.floats(-3, 3), st.floats(-1.2, 1.2), st.booleans())
def test_every_candidate_is_a_tool_pose_that_can_close_on_the_shaft(yaw, tilt, flip):
    pose = lying(yaw, tilt, flip)
    found = candidates(pose)
    R = found.T_base_tcp[:, :3, :3]
    np.testing.assert_allclose(
        R @ R.transpose(0, 2, 1), np.broadcast_to(np.eye(3), R.shape), atol=1e-9
    )
    assert (np.linalg.det(R) > 0).all()
    assert (found.opening_m > found.expected_m).all()
    assert (found.opening_m <= 0.035).all()
    assert (found.detection == 3).all()
    # Fingers close across the axis, the tool comes from above within the tilt.
    closing = np.abs(R[:, :, 1] @ pose.rotation[:, 2])
    assert closing.max() < 1e-9
    across = found.kind == GraspKind.ACROSS
    assert (np.arccos(np.clip(-R[across, 2, 2], -1, 1)) <= 0.87 + 1e-9).all()


def test_the_expected_width_is_the_diameter_where_the_fingers_are():
    found = candidates(lying())
    T_object_base = lying().inverse()
    for k in range(len(found)):
        # Where the finger's middle line crosses the axis: there its pads touch.
        tip, along = (
            T_object_base.apply(found.T_base_tcp[k, :3, 3]),
            (T_object_base.rotation @ found.T_base_tcp[k, :3, 2]),
        )
        z = tip[2] - along[2] * (tip[:2] @ along[:2]) / (along[:2] @ along[:2])
        at = SHAFT.profile.radius_at(np.array([z - 0.006, z, z + 0.006]))
        assert found.expected_m[k] == pytest.approx(2 * at.max())
        assert at.min() == at.max(), "a finger straddles a shoulder"


def test_a_standing_shaft_is_taken_by_its_upper_end():
    standing = Transform.from_translation("base", "object", (0.55, 0, 0.10))
    found = candidates(standing)
    assert set(found.kind) == {"end"}
    assert (found.T_base_tcp[:, 2, 2] < -0.999).all()
    assert found.expected_m == pytest.approx(0.020)
    upside_down = Transform.from_parts("base", "object", np.diag([1.0, -1, -1]), (0.55, 0, 0.1))
    assert set(candidates(upside_down).kind) == {"end"}


def test_a_shaft_wider_than_the_stroke_is_not_tried_there():
    stout = load_part("shaft:20x30,40x40,20x30")
    found = candidates(lying(), stout)
    assert len(found) > 0
    assert found.expected_m == pytest.approx(0.020)
    assert len(candidates(lying(), load_part("shaft:40x100"))) == 0


def test_the_best_first_is_the_highest_and_steepest():
    found = candidates(lying()).best_first()
    assert (np.diff(found.score) <= 0).all()
    assert found.T_base_tcp[0, 2, 2] < -0.999


@pytest.mark.parametrize("name", ["shaft", "shaft:12x60", "shaft:30x40,10x30"])
def test_slots_do_not_touch_and_leave_room_for_a_finger(name):
    part = load_part(name)
    slots = np.array(Slots.grid(TRAY, part, FINGERS, release_margin_m=0.006).positions_m)
    assert len(slots) >= 12
    half = np.array(TRAY.size_m) / 2
    assert (np.abs(slots[:, 0]) + part.length_m / 2 <= half[0]).all()
    assert (np.abs(slots[:, 1]) + part.max_radius_m <= half[1]).all()
    away = np.abs(slots[:, None] - slots[None])
    along, across = away[..., 0], away[..., 1]
    others = ~np.eye(len(slots), dtype=bool)
    apart = (along >= part.length_m) | (
        across >= 2 * part.max_radius_m + FINGERS.thickness_m + 0.003
    )
    assert apart[others].all()


@given(st.integers(0, 400), st.booleans())
def test_laying_down_puts_the_part_on_the_tray_and_the_tool_above_it(k, flip):
    pose = lying(0.7, 0.1, flip)
    found = candidates(pose)
    k %= len(found)
    T_base_tcp = Transform("base", "tcp", found.T_base_tcp[k])
    T_tcp_object = T_base_tcp.inverse() @ pose
    slot = NextSlot(0, (0.05, -0.1), SHAFT, TRAY)
    offered = list(slot.poses(T_tcp_object, str(found.kind[k])))
    assert len(offered) >= 2
    for T_place, T_target in offered:
        let_go = T_place @ T_tcp_object
        np.testing.assert_allclose(let_go.rotation, T_target.rotation, atol=1e-9)
        drop_m = let_go.translation_m - T_target.translation_m
        np.testing.assert_allclose(drop_m, (0, 0, 0.0005), atol=1e-9)
        lowest_m = T_target.apply(SHAFT.vertices_m)[:, 2].min()
        assert lowest_m == pytest.approx(TRAY.T_base_tray.translation_m[2], abs=1e-5)
        tilt = np.arccos(np.clip(-T_place.rotation[2, 2], -1, 1))
        assert tilt <= np.radians(30) + 1e-6  # only the pitch along the axis is left
