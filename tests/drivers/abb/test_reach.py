import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.abb.reach import Reach, confdata, even
from drivers.arms import ARMS, Kinematics
from hal import CircularTarget, JointTarget, LinearTarget, Transform
from hal.errors import UnreachableError

ARM = ARMS["irb1200-5-0.9"]
KINEMATICS = Kinematics(ARM)
T_flange_tcp = Transform.from_translation("flange", "tcp", (0.0, 0.02, 0.16))
REACH = Reach(KINEMATICS, T_flange_tcp.inverse())
HOME = np.array([0.0, 0.0, 0.0, 0.0, np.pi / 2, 0.0])


def tcp(joints_rad):
    matrix = KINEMATICS.forward(np.array(joints_rad)) @ T_flange_tcp.matrix
    return Transform("base", "tcp", matrix)


def shifted(pose, by_m):
    matrix = pose.matrix.copy()
    matrix[:3, 3] += by_m
    return Transform("base", "tcp", matrix)


shifts = st.tuples(*[st.floats(-0.15, 0.15)] * 3)


@given(shifts)
def test_following_a_line_ends_at_its_target_without_a_jump(by_m):
    goal = shifted(tcp(HOME), by_m)
    (joints,) = REACH.follow(HOME, [LinearTarget(goal)])
    assert tcp(joints).matrix == pytest.approx(goal.matrix, abs=1e-9)
    assert np.sign(joints[4]) == np.sign(HOME[4])


def test_each_target_begins_where_the_last_one_ended():
    via = (0.4, 0.1, 0.0, 0.0, 1.4, 2.5)
    goal = shifted(tcp(via), (0.0, 0.05, -0.05))
    joints = REACH.follow(HOME, [JointTarget(via), LinearTarget(goal)])
    assert joints[0] == pytest.approx(via)
    assert np.abs(joints[1] - via).max() < 0.4
    assert tcp(joints[1]).matrix == pytest.approx(goal.matrix, abs=1e-9)


def test_a_line_that_leaves_the_reach_in_its_middle_is_refused_and_named():
    """Both ends are in reach, the way between them passes through the arm's foot."""
    one = tcp((0.0, 0.3, 0.3, 0.0, 1.0, 0.0))
    other = tcp((np.pi * 0.94, 0.3, 0.3, 0.0, 1.0, 0.0))
    goal = Transform.from_parts("base", "tcp", one.rotation, other.translation_m)
    with pytest.raises(UnreachableError, match="target 2"):
        REACH.follow(HOME, [JointTarget((0.0, 0.3, 0.3, 0.0, 1.0, 0.0)), LinearTarget(goal)])


def test_out_of_reach_is_refused():
    with pytest.raises(UnreachableError, match="reach"):
        REACH.follow(HOME, [LinearTarget(shifted(tcp(HOME), (3.0, 0, 0)))])


def test_the_way_is_even():
    start, goal = tcp(HOME).matrix, tcp((0.2, 0.1, 0.0, 0.3, 1.3, 0.4)).matrix
    way_m = goal[:3, 3] - start[:3, 3]
    poses = even(
        start,
        goal,
        lambda share: start[:3, 3] + share[:, None] * way_m,
        np.linalg.norm(way_m),
    )
    assert poses[0] == pytest.approx(start)
    assert poses[-1] == pytest.approx(goal, abs=1e-12)
    steps = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1)
    assert steps == pytest.approx(steps[0])
    assert steps[0] <= 0.01


def test_following_an_arc_ends_at_its_target():
    here = tcp(HOME)
    via, goal = shifted(here, (0.0, 0.05, -0.05)), shifted(here, (0.0, 0.10, 0.0))
    (joints,) = REACH.follow(HOME, [CircularTarget(via, goal)])
    assert tcp(joints).matrix == pytest.approx(goal.matrix, abs=1e-9)


def test_three_points_on_a_line_are_no_circle():
    here = tcp(HOME)
    via, goal = shifted(here, (0.0, 0.05, 0.0)), shifted(here, (0.0, 0.10, 0.0))
    with pytest.raises(UnreachableError, match=r"target 1.*line"):
        REACH.follow(HOME, [CircularTarget(via, goal)])


@pytest.mark.parametrize(
    ("joints_deg", "conf"),
    [
        ((0, 0, 0, 0, 30, 0), (0, 0, 0, 0)),
        ((0, 0, 0, 0, -30, 0), (0, 0, 0, 1)),
        ((-10, 0, 0, 100, 30, -100), (-1, 1, -2, 0)),
        ((0, -90, 0, 0, 30, 0), (0, 0, 0, 4)),
        ((0, 60, -190, 0, 30, 0), (0, 0, 0, 2)),
    ],
)
def test_configurations_are_counted_in_quarter_turns(joints_deg, conf):
    assert confdata(ARM, np.radians(joints_deg)) == conf


def test_a_joint_a_hair_below_zero_counts_as_zero():
    joints = np.radians([0.0, 0.0, 0.0, 0.0, 30.0, 0.0])
    joints[3] = -1e-9
    assert confdata(ARM, joints) == (0, 0, 0, 0)
