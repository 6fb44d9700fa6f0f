import pytest

from sims.world import Faults, World, cylinders
from sims.world.fingers import Phase, Window


def run(world, limit_s=8.0):
    began = world.ticks
    while world.fingers.is_busy and (world.ticks - began) * 0.002 < limit_s:
        world.step()
    return (world.ticks - began) * 0.002


@pytest.fixture
def world():
    world = World(shape=cylinders([-0.03, 0.03], [0.01]), parts=1)
    world.fingers.home()
    run(world)
    world.fingers.move(0.035, speed_mps=0.05, force_n=80.0)
    run(world)
    return world


def test_homing_finds_the_zero_it_did_not_know():
    world = World()
    off_m = world.fingers.width_m - world.fingers.true_width_m
    assert abs(off_m) > 1e-4
    world.fingers.home()
    run(world)
    assert world.fingers.is_homed
    assert world.fingers.width_m == pytest.approx(world.fingers.true_width_m, abs=5e-5)


@pytest.mark.parametrize("speed_mps", [0.001, 0.010, 0.050])
def test_the_ramp_keeps_its_speed(world, speed_mps):
    way_m = 0.2 * speed_mps + 0.002
    world.fingers.move(0.035 - way_m, speed_mps=speed_mps, force_n=80.0)
    took_s = run(world)
    assert took_s == pytest.approx(way_m / speed_mps, abs=0.1)
    assert world.fingers.width_m == pytest.approx(0.035 - way_m, abs=2e-5)


def test_the_encoder_is_quantised(world):
    world.fingers.move(0.0123456, speed_mps=0.05, force_n=80.0)
    run(world)
    counts = world.fingers.width_m / 1e-5
    assert counts == pytest.approx(round(counts), abs=1e-6)


def test_a_block_stops_a_move_without_force_left(world):
    Faults(world).block_fingers(0.02)
    world.fingers.move(0.01, speed_mps=0.05, force_n=80.0)
    run(world)
    assert world.fingers.is_blocked
    assert world.fingers.width_m == pytest.approx(0.02, abs=3e-4)
    assert abs(world.fingers.force_n) < 5


def test_closing_on_nothing_is_no_part(world):
    world.fingers.close(window=None, speed_mps=0.05, force_n=80.0)
    run(world)
    assert world.fingers.phase is Phase.EMPTY


def test_a_window_tells_the_wrong_part(world):
    Faults(world).block_fingers(0.02)
    world.fingers.close(window=Window(0.024, 0.026), speed_mps=0.05, force_n=80.0)
    run(world)
    assert world.fingers.phase is Phase.WRONG


def test_a_block_that_goes_is_a_lost_part(world):
    faults = Faults(world)
    faults.block_fingers(0.02)
    world.fingers.close(window=None, speed_mps=0.05, force_n=80.0)
    run(world)
    assert world.fingers.phase is Phase.HOLDING
    faults.unblock_fingers()
    world.step_for(0.1)
    assert world.fingers.phase is Phase.LOST


def test_a_block_in_homing_is_a_fault_with_the_stroke_it_found():
    world = World()
    Faults(world).block_fingers(0.010)
    world.fingers.home()
    run(world)
    assert world.fingers.phase is Phase.FAULT
    assert "stroke" in world.fingers.fault
    world.fingers.clear_fault()
    assert not world.fingers.fault
    assert not world.fingers.is_homed
