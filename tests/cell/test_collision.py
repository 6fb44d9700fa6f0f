import itertools

import numpy as np
import pytest

from cell.build import _home
from cell.config import load_cell
from cell.grasp import GraspCandidates, shaft_candidates
from cell.planning.collision import CollisionModel, Obstacle
from cell.planning.pick import PickPlan, PickPlanner, Reject
from cell.planning.reach import Reach, line_poses
from cell.slots import NextSlot, Slots
from drivers.arms import ARMS, Kinematics
from hal import GripperLimits, Transform, rotation_from_rotvec
from perception.parts import load_part

CONFIG = load_cell()
LAYOUT = CONFIG.layout
ARM = ARMS[CONFIG.arm]
PART = load_part("shaft")
KINEMATICS = Kinematics(ARM)
T_FLANGE_TCP = np.eye(4)
T_FLANGE_TCP[2, 3] = LAYOUT.fingers.tcp_m
REACH = Reach(KINEMATICS, T_FLANGE_TCP)
HOME = _home(CONFIG, ARM, REACH, PART, ())
DOWN = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]])


def joints_at(x, y, z):
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = DOWN, (x, y, z)
    joints = REACH.nearest(pose[None], HOME)[0]
    assert not np.isnan(joints).any()
    return joints


def shaft_at(x, y, z, yaw=0.0):
    R = rotation_from_rotvec((0, 0, yaw)) @ rotation_from_rotvec((0, np.pi / 2, 0))
    return Transform.from_parts("base", "object", R, (x, y, z))


def test_joints_of_a_tool_pose_lead_back_to_it():
    joints = joints_at(0.5, 0.1, 0.2)
    T = KINEMATICS.forward(joints) @ T_FLANGE_TCP
    np.testing.assert_allclose(T[:3, 3], (0.5, 0.1, 0.2), atol=1e-9)


def test_fingers_are_where_the_tool_centre_point_says():
    """The tips are 10 mm below the tool centre point: 11 mm over the floor is free, 9 is not."""
    model = CollisionModel(ARM, LAYOUT, PART, margin_m=0.0)
    floor_z = LAYOUT.bin.T_base_bin.translation_m[2]
    assert not model.hits(joints_at(0.55, 0, floor_z + 0.0105), 0.035)
    assert model.hits(joints_at(0.55, 0, floor_z + 0.0095), 0.035)


@pytest.mark.parametrize(("gap_m", "hits"), [(0.001, True), (-0.001, False)])
def test_open_fingers_pass_beside_a_part_or_not(gap_m, hits):
    """Opening is along base y at yaw 0; the shaft lies along x."""
    model = CollisionModel(ARM, LAYOUT, PART, parts=[shaft_at(0.55, 0, 0.09)], margin_m=0.0)
    q = joints_at(0.55 + 0.03, 0.0, 0.09)
    pose = KINEMATICS.forward(q)
    assert abs(pose[1, 1]) < 1e-9
    closing_along_y = np.eye(4)
    closing_along_y[:3, :3] = np.diag([1.0, -1, -1])
    closing_along_y[:3, 3] = (0.55 + 0.03, 0, 0.09)
    q = REACH.nearest(closing_along_y[None], HOME)[0]
    assert model.hits(q, 0.020 - gap_m) is hits


def test_a_margin_keeps_the_hand_away():
    parts = [shaft_at(0.55, 0, 0.09)]
    near = np.eye(4)
    near[:3, :3], near[:3, 3] = np.diag([1.0, -1, -1]), (0.58, 0, 0.09)
    q = REACH.nearest(near[None], HOME)[0]
    assert not CollisionModel(ARM, LAYOUT, PART, parts=parts, margin_m=0.0).hits(q, 0.0215)
    assert CollisionModel(ARM, LAYOUT, PART, parts=parts, margin_m=0.002).hits(q, 0.0215)


def test_what_no_part_explains_is_an_obstacle_too():
    q = joints_at(0.55, 0, 0.12)
    clutter = np.array([[0.55, 0.0, 0.115]])
    assert not CollisionModel(ARM, LAYOUT, PART).hits(q, 0.003)
    assert CollisionModel(ARM, LAYOUT, PART, clutter_m=clutter).hits(q, 0.003)


def test_a_held_part_sticks_out_of_the_hand():
    model = CollisionModel(ARM, LAYOUT, PART)
    wall_y = LAYOUT.bin.size_m[1] / 2
    T_tcp_object = Transform.from_parts(
        "tcp", "object", rotation_from_rotvec((0, np.pi / 2, 0)), (0, 0, 0)
    )
    q = joints_at(0.55, wall_y - 0.035, 0.10)
    assert not model.hits(q, 0.020)
    with model.carrying(T_tcp_object):
        assert model.hits_carried(q, 0.020)
        assert model.hits_in_transit(q, 0.020)
        assert not model.hits_carried(joints_at(0.55, 0, 0.10), 0.020)
    assert not model.hits(q, 0.020), "the part must be gone afterwards"


def planner():
    return PickPlanner(REACH, ARM.limits, LAYOUT, HOME)


def choose(poses, obstacles=(), **changes):
    model = CollisionModel(ARM, LAYOUT, PART, parts=poses, obstacles=obstacles)
    found = GraspCandidates.joined(
        [
            shaft_candidates(
                PART,
                pose,
                index=k,
                fingers=LAYOUT.fingers,
                limits=GripperLimits(),
                opening_margin_m=0.006,
                max_tilt_rad=0.87,
            )
            for k, pose in enumerate(poses)
        ]
    )
    slots = Slots.grid(LAYOUT.tray, PART, LAYOUT.fingers, release_margin_m=0.006)
    slot = NextSlot(0, slots.positions_m[0], PART, LAYOUT.tray)
    return planner().choose(found, poses, model, slot, seed=0)


def test_a_free_shaft_is_picked_and_every_position_of_the_plan_is_free():
    pose = shaft_at(0.55, 0.02, 0.065, 0.4)
    plan = choose([pose]).plan
    assert isinstance(plan, PickPlan)
    model = CollisionModel(ARM, LAYOUT, PART, parts=[pose])
    path = [HOME, *plan.to_approach]
    dense = [a + (b - a) * u for a, b in itertools.pairwise(path) for u in np.linspace(0, 1, 500)]
    assert not any(model.hits(q, plan.opening_m) for q in dense)
    line = line_poses(
        plan.T_base_tcp.matrix, -plan.T_base_tcp.rotation[:, 2], plan.retreat_m, 0.001
    )
    joints = REACH.follow(line[::-1], plan.to_approach[-1])
    assert joints is not None
    assert not any(model.hits(q, plan.opening_m) for q in joints)
    let_go = plan.T_base_place @ plan.T_base_tcp.inverse() @ pose
    np.testing.assert_allclose(let_go.matrix, plan.T_base_target.matrix, atol=6e-4)


def test_the_upper_of_two_crossed_shafts_goes_first():
    lower, upper = shaft_at(0.55, 0, 0.064), shaft_at(0.55, 0, 0.092, np.pi / 2)
    choice = choose([lower, upper])
    assert choice.plan is not None
    assert choice.plan.detection == 1


def test_reasons_are_told_apart():
    far = choose([shaft_at(1.30, 0, 0.065)])
    assert far.plan is None
    assert far.why(0) == Reject.UNREACHABLE
    lid = Obstacle(
        "lid", (0.5, 0.5, 0.01), Transform.from_translation("base", "lid", (0.55, 0, 0.25))
    )
    covered = choose([shaft_at(0.55, 0, 0.065)], obstacles=[lid])
    assert covered.plan is None
    assert covered.why(0) in {Reject.GRASP_COLLIDES, Reject.APPROACH_COLLIDES}


def test_equal_questions_get_equal_plans():
    poses = [shaft_at(0.50, 0.05, 0.065, 1.0), shaft_at(0.62, -0.05, 0.070, 2.0)]
    first, second = choose(poses).plan, choose(poses).plan
    assert first is not None
    assert second is not None
    assert np.array_equal(np.array(first.to_place), np.array(second.to_place))


@pytest.mark.parametrize(
    ("x", "y", "yaw"),
    [
        (0.55, -0.1155, 0.0),
        (0.43, 0.1155, np.pi),
        (0.7155, 0.05, np.pi / 2),
        (0.3845, -0.05, np.pi / 2),
        (0.422, -0.1155, 0.0),
        (0.678, 0.1155, np.pi),
    ],
)
def test_a_shaft_along_a_wall_or_in_a_corner_is_picked(x, y, yaw):
    """The thin sections leave 4 mm to the wall, as much as a finger is thick."""
    plan = choose([shaft_at(x, y, 0.064, yaw)]).plan
    assert plan is not None
    assert plan.T_base_tcp.rotation[2, 2] > -0.9, "only a steep grasp fits there"
