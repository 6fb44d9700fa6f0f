import numpy as np
import pytest

from drivers.arms import ARMS, Kinematics

ARM = ARMS["irb1200-5-0.9"]


@pytest.fixture(scope="module")
def kinematics():
    return Kinematics(ARM)


def random_joints(count, seed=0, share=1.0):
    rng = np.random.default_rng(seed)
    lower, upper = np.array(ARM.limits.lower_rad), np.array(ARM.limits.upper_rad)
    middle, half = (lower + upper) / 2, (upper - lower) / 2
    return middle + rng.uniform(-share, share, (count, 6)) * half


def test_joints_at_zero_put_the_flange_where_the_data_sheet_has_it(kinematics):
    T = kinematics.forward(np.zeros(6))
    assert T[:3, 3] == pytest.approx((0.451 + 0.082, 0, 0.3991 + 0.448 + 0.042))
    assert T[:3, 2] == pytest.approx((1, 0, 0), abs=1e-12)


def test_home_points_the_tool_down(kinematics):
    assert kinematics.forward(ARM.home_rad)[:3, 2] == pytest.approx((0, 0, -1), abs=1e-12)


def test_every_solution_lies_inside_the_ranges_and_leads_back_to_the_pose(kinematics):
    poses = kinematics.forward(random_joints(200))
    solutions = kinematics.inverse_all(poses)
    joints = solutions.joints_rad
    there = ~np.isnan(joints[..., 0])
    assert there.any(axis=1).all()
    assert (solutions.limit_margin_rad[there] >= 0).all()
    back = kinematics.forward(joints[there])
    assert back == pytest.approx(poses[np.nonzero(there)[0]], abs=1e-9)


def test_the_joints_we_came_from_are_among_the_solutions(kinematics):
    before = random_joints(200, seed=1)
    joints = kinematics.inverse_all(kinematics.forward(before)).joints_rad
    joints = kinematics.wrapped(joints, before[:, None])
    off = np.nanmin(np.abs(joints - before[:, None]).max(axis=-1), axis=1)
    assert off.max() < 1e-7


def test_a_pose_out_of_reach_has_no_solution(kinematics):
    T = np.eye(4)
    T[0, 3] = 2.0
    solutions = kinematics.inverse_all(T)
    assert np.isnan(solutions.joints_rad).all()
    assert np.isnan(solutions.limit_margin_rad).all()
    assert np.isnan(kinematics.nearest(T, ARM.home_rad)).all()


def test_wrapping_takes_the_nearest_copy_and_stays_inside_the_range(kinematics):
    joints = np.array([0, 0, 0, 3.0, 0, 3.0])
    near = kinematics.wrapped(joints, [0, 0, 0, -3.0, 0, -3.0])
    assert near[3] == pytest.approx(3.0 - 2 * np.pi)
    assert near[5] == pytest.approx(3.0 - 2 * np.pi)
    edge = kinematics.wrapped([0, 0, 0, 1.0, 0, 0], [0, 0, 0, -4.7, 0, 0])
    assert edge[3] == pytest.approx(1.0)  # 1 - 2 pi lies below the range


def test_one_pose_and_no_poses_are_both_fine(kinematics):
    assert kinematics.inverse_all(np.eye(4)).joints_rad.shape == (1, 8, 6)
    assert kinematics.inverse_all(np.empty((0, 4, 4))).joints_rad.shape == (0, 8, 6)
    assert kinematics.forward(np.empty((0, 6))).shape == (0, 4, 4)


def test_nearest_keeps_the_branch(kinematics):
    reference = np.array(ARM.home_rad)
    T = kinematics.forward(reference)
    T[0, 3] += 0.01
    assert np.abs(kinematics.nearest(T, reference) - reference).max() < 0.1
