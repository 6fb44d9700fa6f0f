"""A grasp must be able to fail: what friction can hold is held, what it cannot is not."""

import numpy as np
import pytest

from sims.bench.grasp import GraspTrial, hanging_pose, home_fingers, wait_fingers
from sims.world import Faults, Physics, Referee, World, cylinders
from sims.world.lock import Grip

SHAFT = cylinders([-0.05, -0.015, 0.010, 0.05], [0.010, 0.014, 0.010])
USUAL = GraspTrial(SHAFT)


def holding_world():
    world = World(shape=SHAFT, parts=1)
    home_fingers(world)
    world.put_part(0, hanging_pose(world, (0.0, 0.0, 0.0)), is_floating=True)
    world.fingers.close(window=None, speed_mps=0.05, force_n=80.0)
    wait_fingers(world)
    world.set_floating(0, False)
    world.step_for(0.05)
    return world


@pytest.fixture(scope="module")
def usual():
    return USUAL.run()


def test_a_good_grasp_holds_through_full_speed_moves(usual):
    assert usual.is_held
    assert usual.was_locked
    assert usual.slides == 0
    assert usual.slip_static_m < 5e-5
    assert usual.slip_moving_m < 1e-4
    assert usual.turn_moving_rad < 2e-3
    assert usual.use_peak < 0.3


def test_the_force_is_what_was_asked_for(usual):
    assert usual.hold_force_n == pytest.approx(80.0, abs=1.0)


@pytest.mark.parametrize("force_n", [70.0, 100.0])
@pytest.mark.parametrize(
    "shape",
    [
        cylinders([-0.05, 0.05], [0.010]),
        cylinders([-0.015, 0.015], [0.003]),
        cylinders([-0.05, 0.05], [0.016]),
    ],
    ids=["0.25 kg", "7 g", "0.63 kg"],
)
def test_one_constant_corrects_the_size_for_every_part_and_force(shape, force_n):
    world = World(shape=shape, parts=1)
    home_fingers(world)
    world.put_part(0, hanging_pose(world, (0.0, 0.0, 0.0)), is_floating=True)
    world.fingers.close(window=None, speed_mps=0.05, force_n=force_n)
    wait_fingers(world)
    assert world.fingers.size_m == pytest.approx(2 * shape.radius_m, abs=1e-4)


def test_oily_pads_come_near_their_limit_and_slippery_ones_lose_the_part_in_motion():
    oily = USUAL.with_friction(0.05).run()
    assert oily.is_held
    assert 0.5 < oily.use_peak < 1.0
    slippery = USUAL.with_friction(0.03).run()  # 2 mu F = 4.8 N: weight, but not the moves
    assert slippery.was_locked
    assert slippery.slides > 0
    assert not slippery.is_held


def test_pads_without_enough_friction_drop_the_part():
    # 2 mu F < m g
    result = USUAL.with_friction(0.015).run()
    assert not result.is_held


def test_one_finger_holds_nothing():
    result = GraspTrial(SHAFT, has_both_fingers=False).run()
    assert not result.was_locked
    assert not result.is_held


def test_a_touch_without_force_does_not_lock():
    world = World(shape=SHAFT, parts=1)
    home_fingers(world)
    world.put_part(0, hanging_pose(world, (0.0, 0.0, 0.0)), is_floating=True)
    world.fingers.close(window=None, speed_mps=0.05, force_n=15.0)
    wait_fingers(world)
    world.step_for(0.2)
    assert min(world.lock.grip().normal_n) == pytest.approx(15.0, abs=1.0)
    assert not world.lock.events


def test_beside_the_part_there_is_nothing_to_hold():
    result = GraspTrial(SHAFT, offset_m=(0.0, 0.0, 0.03)).run()
    assert result.size_m is None or not result.is_held


def test_gripped_far_off_its_middle_a_heavy_bar_turns_in_the_fingers():
    bar = cylinders([-0.06, 0.06], [0.016])
    near = GraspTrial(bar).run()
    far = GraspTrial(bar, offset_m=(0.052, 0.0, 0.0)).run()
    assert far.use_peak > 5 * near.use_peak


def test_an_opened_finger_ends_the_lock_and_the_event_says_so():
    world = holding_world()
    assert Referee(world).held == 0
    world.fingers.move(0.035, speed_mps=0.05, force_n=80.0)
    world.step_for(0.1)
    referee = Referee(world)
    assert referee.held is None
    first, last = referee.lock_events[0], referee.lock_events[-1]
    assert first.is_locked
    assert min(first.normal_n) >= 20.0
    assert not last.is_locked
    assert last.reason == "fingers opened"


def test_a_pull_stronger_than_friction_opens_the_lock_and_a_weaker_one_does_not():
    world = holding_world()
    body = world.model.body("part0").id
    grip = world.lock.grip()
    capacity = grip.friction * sum(grip.normal_n)
    for share, is_held in ((0.6, True), (1.5, False)):
        world.data.xfrc_applied[body, 0] = share * capacity
        world.step_for(0.05)
        assert (world.lock.part == 0) is is_held
    event = world.lock.events[-1]
    assert event.reason == "friction exceeded"
    assert event.use > 1
    assert event.force_n > 0.9 * capacity


def test_a_dropped_part_falls_and_is_not_caught_again():
    world = holding_world()
    height = world.part_pose(0).translation_m[2]
    Faults(world).drop_part()
    world.step_for(0.6)
    assert world.lock.part is None
    assert world.part_pose(0).translation_m[2] < height - 0.1
    assert world.fingers.phase == "part lost"
    world.fingers.move(0.035, speed_mps=0.05, force_n=80.0)
    world.step_for(0.8)
    pad = world.model.geom("finger_left").id
    assert world.model.geom_friction[pad, 0] == pytest.approx(Physics().pad_friction)


def test_friction_use_is_one_at_the_limits_of_the_contact():
    def use(force=(0, 0, 0), torque=(0, 0, 0)):
        return Grip(
            0, (80.0, 80.0), 0.5, 0.004, 0.02, np.zeros(3), np.array(force), np.array(torque)
        ).use

    assert use(force=(80.0, 0, 0)) == pytest.approx(1)  # mu (N1 + N2)
    assert use(force=(0, 0, 80.0)) == pytest.approx(1)
    assert use(force=(0, 160.0, 0)) == pytest.approx(1)  # one finger has no force left
    assert use(torque=(0, 80.0 * 0.004, 0)) == pytest.approx(1)
    assert use(torque=(80.0 * 0.018, 0, 0)) == pytest.approx(1)
    assert use(force=(40.0, 0, 0), torque=(0, 80.0 * 0.004, 0)) > 1.1
