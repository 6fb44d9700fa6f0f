import hashlib

import numpy as np
import pytest

from hal import Bin, Layout, Transform
from hal.errors import ConfigError
from sims.world import PileError, Place, Referee, World, cylinders, fill
from sims.world.piles import check_fit

SHAFT = cylinders([-0.05, -0.015, 0.010, 0.05], [0.010, 0.014, 0.010])


def state_hash(world):
    return hashlib.sha256(world.data.qpos.tobytes() + world.data.qvel.tobytes()).hexdigest()


@pytest.mark.parametrize(
    ("shape", "count"),
    [
        (SHAFT, 1),
        (SHAFT, 20),
        (cylinders([-0.015, 0.015], [0.003]), 40),
        (cylinders([-0.015, 0.015], [0.017]), 12),
        (cylinders([-0.075, 0.0, 0.075], [0.017, 0.010]), 6),
        (cylinders([-0.15, 0.15], [0.008]), 3),
    ],
    ids=["one", "shafts", "pins", "discs", "long", "longer than the bin is wide"],
)
def test_every_part_comes_to_rest_in_the_bin(shape, count):
    world = World(shape=shape, parts=count)
    report = fill(world, seed=0)
    referee = Referee(world)
    assert referee.parts_in(Place.BIN) == tuple(range(count))
    assert report.awake == 0
    assert max(world.part_speed(k)[0] for k in range(count)) < 0.01


@pytest.mark.parametrize("is_solid", [True, False])
def test_the_guides_keep_a_part_over_the_bin(is_solid):
    world = World(shape=SHAFT, parts=1)
    world.set_guides(is_solid=is_solid)
    world.put_part(0, Transform.from_translation("base", "object", (0.5, 0.0, 0.5)))
    world.arm.jump_to(np.array([2.0, 0, 0, 0, 1.5, 0]))
    world.data.qvel[world.dof_address(0)] = 2.0
    world.step_for(1.0)
    assert (Referee(world).place(0) is Place.BIN) is is_solid


def test_filling_has_guides_and_the_arm_out_of_the_way_and_puts_both_back():
    world = World(shape=SHAFT, parts=2)
    home = world.arm.measured_rad
    guides = [world.model.geom(f"guide{k}").id for k in range(4)]
    seen, step = [], world.step

    def watched_step():
        step()
        seen.append((world.model.geom_conaffinity[guides].all(), world.arm.measured_rad[0]))

    world.step = watched_step
    fill(world, seed=0)
    assert seen[0][0]
    assert not seen[-1][0]
    assert min(abs(turn) for _, turn in seen) > 1.5
    assert world.arm.measured_rad == pytest.approx(home)


def test_the_same_seed_is_the_same_pile_to_the_bit_and_another_is_another():
    hashes = []
    for seed in (3, 3, 4):
        world = World(shape=SHAFT, parts=8)
        fill(world, seed=seed)
        hashes.append(state_hash(world))
    assert hashes[0] == hashes[1]
    assert hashes[2] != hashes[0]


def test_an_empty_bin_is_fine():
    world = World()
    assert fill(world, seed=0).settle_s == 0
    world = World(shape=SHAFT, parts=3)
    fill(world, seed=0, count=0)
    assert Referee(world).parts_in(Place.PARKED) == (0, 1, 2)


def test_parts_that_are_not_dropped_stay_parked():
    world = World(shape=SHAFT, parts=5)
    fill(world, seed=1, count=2)
    referee = Referee(world)
    assert referee.parts_in(Place.BIN) == (0, 1)
    assert referee.parts_in(Place.PARKED) == (2, 3, 4)


def test_a_bin_may_stand_elsewhere_and_turned():
    T_base_bin = Transform.from_quaternion("base", "bin", (1, 0, 0, 0.3), (0.4, 0.2, 0.08))
    world = World(shape=SHAFT, parts=4, layout=Layout(bin=Bin(T_base_bin=T_base_bin)))
    fill(world, seed=0)
    assert Referee(world).parts_in(Place.BIN) == (0, 1, 2, 3)


@pytest.mark.parametrize(
    ("shape", "count", "message"),
    [
        (cylinders([-0.2, 0.2], [0.01]), 1, "does not fit"),
        (cylinders([-0.05, 0.05], [0.15]), 1, "does not fit"),
        (cylinders([-0.05, 0.05], [0.03]), 60, "overfill"),
    ],
)
def test_parts_that_cannot_fit_are_refused_with_the_sizes(shape, count, message):
    with pytest.raises(ConfigError, match=message):
        check_fit(shape, count, Bin())


def test_a_part_that_leaves_the_bin_makes_the_drop_start_again():
    world = World(shape=SHAFT, parts=2)
    stray = [True, True, False]
    step = world.step

    def nudging_step():
        step()
        if stray and world.data.time > 0.5:
            if stray.pop(0):
                world.put_part(0, Transform.from_translation("base", "object", (1.0, 1.0, 0.02)))
            world.data.time = 0.0

    world.step = nudging_step
    report = fill(world, seed=0)
    assert report.attempt > 0
    assert Referee(world).parts_in(Place.BIN) == (0, 1)


def test_parts_that_never_stay_in_are_an_error_that_says_why():
    shallow = Bin(size_m=(0.2, 0.2, 0.009))
    world = World(shape=SHAFT, parts=1, layout=Layout(bin=shallow))
    with pytest.raises(PileError, match=r"seed 0: part 0 .* in each of 5 drops"):
        fill(world, seed=0)


def test_more_parts_than_there_are_is_a_mistake():
    with pytest.raises(ValueError, match="2 parts"):
        fill(World(shape=SHAFT, parts=1), seed=0, count=2)


def test_the_guides_are_gone_afterwards():
    world = World(shape=SHAFT, parts=1)
    fill(world, seed=0)
    guides = [world.model.geom(f"guide{k}").id for k in range(4)]
    assert (world.model.geom_conaffinity[guides] == 0).all()
    damping = world.physics.free_damping(SHAFT.inertia)
    assert world.model.dof_damping[world.dof_address(0)] == pytest.approx(damping)
