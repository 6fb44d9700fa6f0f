"""Both arms of the family against figures of the maker's kinematics."""

import numpy as np
import pytest

from drivers.arms import ARMS, Kinematics
from hal import Transform
from sims.world import World

VECTORS = [
    ((0, 0, 0, 0, 30, 0), (0.5, 0, 0.866025, 0), (522.014, 0, 848.100), (422.014, 0, 750.100)),
    (
        (21, -10, -20, 30, 40, 50),
        (0.357459, 0.228779, 0.705120, 0.568057),
        (335.053, 156.844, 1094.043),
        (270.090, 131.907, 947.532),
    ),
    (
        (-45, 40, 10, -60, -75, 120),
        (0.487935, 0.399092, 0.533515, 0.563921),
        (510.965, -413.958, 432.997),
        (420.970, -323.963, 434.529),
    ),
]
ZERO = {"irb1200-5-0.9": (533.0, 0, 889.1), "irb1200-7-0.7": (433.0, 0, 791.1)}


@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("vector", VECTORS)
def test_the_flange_is_where_the_maker_has_it(name, vector):
    joints, quaternion, *places = vector
    place = places[list(ARMS).index(name)]
    T = Transform("base", "flange", Kinematics(ARMS[name]).forward(np.radians(joints)))
    assert T.translation_m * 1e3 == pytest.approx(place, abs=6e-4)
    assert abs(np.dot(T.quaternion_wxyz, quaternion)) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("name", ARMS)
def test_at_zero_the_tool_points_forward(name):
    T = Kinematics(ARMS[name]).forward(np.zeros(6))
    assert T[:3, 3] * 1e3 == pytest.approx(ZERO[name], abs=1e-9)
    assert T[:3, 2] == pytest.approx((1, 0, 0), abs=1e-12)


@pytest.mark.parametrize("name", ARMS)
def test_every_pose_in_reach_is_found_again(name):
    kinematics = Kinematics(ARMS[name])
    rng = np.random.default_rng(7)
    joints = rng.uniform(kinematics.lower_rad, kinematics.upper_rad, (200, 6)) * 0.95
    poses = kinematics.forward(joints)
    for row, pose in zip(joints, poses, strict=True):
        nearest = kinematics.nearest(pose, row)
        assert nearest == pytest.approx(row, abs=1e-6)


@pytest.mark.parametrize("name", ARMS)
def test_the_simulated_arm_has_the_same_geometry(name):
    arm = ARMS[name]
    world = World(arm=arm)
    joints = np.radians((21, -10, -20, 30, 40, 50))
    world.arm.jump_to(joints)
    world.refresh()
    grip = world.model.body("grip").id
    place = Kinematics(arm).forward(joints)
    assert world.data.xpos[grip] == pytest.approx(place[:3, 3], abs=1e-9)
    assert world.data.xmat[grip].reshape(3, 3) == pytest.approx(place[:3, :3], abs=1e-9)
