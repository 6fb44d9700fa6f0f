import hashlib

import numpy as np
import pytest

from drivers.arms import Kinematics
from hal import JointTarget, Load, Tool, Transform
from sims.bench.grasp import drive, hanging_pose, home_fingers, wait_fingers
from sims.motion import plan_program
from sims.world import Place, Referee, SimulationError, World, cylinders, fill

SHAFT = cylinders([-0.05, -0.015, 0.010, 0.05], [0.010, 0.014, 0.010])
FAST = ((0.6, 0.2, 0.1, 0.3, 1.2, 0.9), (-0.6, -0.2, -0.1, -0.3, 1.7, -0.9))


def state_hash(world):
    return hashlib.sha256(world.data.qpos.tobytes() + world.data.qvel.tobytes()).hexdigest()


def test_the_models_flange_is_where_kinematics_says():
    world = World()
    kinematics = Kinematics(world.arm_model)
    rng = np.random.default_rng(0)
    for _ in range(20):
        joints = rng.uniform(world.arm_model.limits.lower_rad, world.arm_model.limits.upper_rad)
        world.arm.jump_to(joints)
        poses = world.body_poses()
        grip = world.model.body("grip").id
        T = kinematics.forward(joints)
        assert poses.position_m[grip] == pytest.approx(T[:3, 3], abs=1e-9)
        assert poses.rotation[grip] == pytest.approx(T[:3, :3], abs=1e-9)


def test_full_speed_moves_keep_to_their_path_within_five_hundredths_of_a_millimetre():
    world = World()
    assert max(drive(world, joints) for joints in FAST) < 5e-5


def test_an_unknown_load_shows_and_a_known_one_does_not():
    errors = []
    for is_told in (False, True):
        world = World(shape=SHAFT, parts=1)
        grip = world.model.body("grip").id
        world.model.body_mass[grip] += 2.0
        if is_told:
            world.arm.set_load(Load(2.0, tuple(world.model.body_ipos[grip])))
        errors.append(max(drive(world, joints) for joints in FAST))
    assert errors[0] > 2e-4
    assert errors[1] < 0.1 * errors[0]


def test_looking_changes_nothing():
    hashes = []
    for looks in (False, True):
        world = World(shape=SHAFT, parts=1)
        home_fingers(world)
        world.put_part(0, hanging_pose(world, (0.0, 0.002, 0.0)), is_floating=True)
        world.fingers.close(window=None, speed_mps=0.05, force_n=80.0)
        for _ in range(400):
            world.step()
            if looks:
                world.body_poses()
        hashes.append((state_hash(world), len(world.lock.events)))
    assert hashes[0] == hashes[1]
    assert hashes[0][1] > 0


def test_poses_are_copies():
    world = World(shape=SHAFT, parts=1)
    before = world.body_poses()
    place = before.position_m.copy()
    drive(world, FAST[0])
    assert np.array_equal(before.position_m, place)


def test_a_snapshot_goes_on_bit_for_bit_even_in_the_middle_of_everything():
    world = World(shape=SHAFT, parts=12)
    fill(world, seed=0)
    kinematics = Kinematics(world.arm_model)
    tool = Tool(Transform.from_translation("flange", "tcp", (0, 0, 0.16)))
    start = world.arm.target_rad
    target = JointTarget(FAST[0])
    world.arm.follow(plan_program(kinematics, start, [target], tool, world.physics.tick_s))
    world.fingers.home()
    world.step_for(0.1)
    world.put_part(3, Transform.from_translation("base", "object", (0.55, 0.0, 0.25)))
    world.step_for(0.05)
    snapshot = world.save()
    world.step_for(0.5)
    first = state_hash(world), world.fingers.width_m, world.ticks
    world.arm.set_load(Load(1.0))
    world.step_for(0.3)
    world.restore(snapshot)
    world.step_for(0.5)
    assert (state_hash(world), world.fingers.width_m, world.ticks) == first


def test_a_snapshot_of_a_held_part_goes_on_bit_for_bit():
    world = World(shape=SHAFT, parts=1)
    home_fingers(world)
    world.put_part(0, hanging_pose(world, (0.0, 0.0, 0.0)), is_floating=True)
    world.fingers.close(window=None, speed_mps=0.05, force_n=80.0)
    wait_fingers(world)
    world.set_floating(0, False)
    assert world.lock.part == 0
    snapshot = world.save()
    drive(world, FAST[0])
    first = state_hash(world)
    world.fingers.move(0.035, speed_mps=0.05, force_n=80.0)
    world.step_for(0.5)
    assert world.lock.part is None
    world.restore(snapshot)
    assert world.lock.part == 0
    drive(world, FAST[0])
    assert state_hash(world) == first


def test_physics_that_blows_up_is_an_error_and_no_figure():
    world = World(shape=SHAFT, parts=1)
    world.data.qvel[-1] = np.nan
    with pytest.raises(SimulationError, match="blew up"):
        world.step_for(0.1)


def test_a_shaft_laid_on_the_tray_does_not_roll_away():
    world = World(shape=SHAFT, parts=1)
    T_base_tray = world.layout.tray.T_base_tray
    flat = Transform.from_quaternion("tray", "object", (1, 1, 0, 0), (0.05, 0.0, 0.0145))
    world.put_part(0, T_base_tray @ flat)
    dof = world.dof_address(0)
    world.data.qvel[dof : dof + 3] = (0.05, 0.0, 0.0)  # let go with a push across its axis
    world.step_for(2.0)
    referee = Referee(world)
    assert referee.place(0) is Place.TRAY
    assert referee.placing_error(0, T_base_tray @ flat).distance_m < 0.004
    assert world.part_speed(0)[0] < 1e-3


def test_the_tray_is_solid_down_to_the_floor():
    world = World(shape=SHAFT, parts=1)
    tray = world.model.geom("tray")
    top = world.layout.tray.T_base_tray.translation_m[2]
    assert 2 * tray.size[2] == pytest.approx(top)


def test_parts_need_a_shape():
    with pytest.raises(ValueError, match="shape"):
        World(parts=3)
