"""The arm's half of the line with eyes that know the truth: cheap, and the lock is judged."""

from dataclasses import replace

import numpy as np
import pytest

from cell.attempt import Ending
from cell.config import load_cell
from cell.demo.errors import pose_error
from hal import Transform, rotation_from_rotvec
from hal.errors import SafetyError
from sims.world import Faults
from tests.cell.oracle import Run


@pytest.fixture(scope="module")
def emptied():
    return Run(count=4, seed=1).go()


def test_every_part_is_picked_and_placed(emptied):
    assert emptied.outcome.ending is Ending.EMPTY
    assert [a.miss for a in emptied.outcome.attempts] == [""] * 4
    assert [pick.is_held for pick in emptied.score.picks] == [True] * 4
    assert [pick.is_placed for pick in emptied.score.picks] == [True] * 4
    assert emptied.score.left == 0


def test_parts_are_laid_down_where_they_should_be(emptied):
    for pick in emptied.score.picks:
        assert pick.placed.position_m < 0.4e-3
        assert pick.placed.axis_rad < np.radians(0.25)


def test_the_gripper_measures_what_it_holds(emptied):
    for attempt in emptied.outcome.attempts:
        assert attempt.size_m == pytest.approx(attempt.expected_m, abs=1e-4)
        assert attempt.force_n == pytest.approx(90, abs=2)


def test_looking_overlaps_with_laying_down(emptied):
    phases = {(p["name"], p.get("attempt")): p for p in emptied.journal.of("phase")}
    second_look = [r["t_ns"] / 1e9 for r in emptied.journal.of("seen")][1]
    assert second_look - 1.0 == pytest.approx(phases["transfer", 1]["end_s"], abs=0.01)
    assert phases["lower", 1]["start_s"] < second_look


def test_the_same_seed_gives_the_same_journal(emptied):
    again = Run(count=4, seed=1).go()
    assert again.journal.sha256 == emptied.journal.sha256
    other = Run(count=4, seed=2).go()
    assert other.journal.sha256 != emptied.journal.sha256


def test_an_empty_bin_is_empty_and_nothing_is_tried():
    run = Run(count=0, seed=0).go()
    assert run.outcome.ending is Ending.EMPTY
    assert run.outcome.attempts == ()


def test_parts_nobody_can_reach_are_left_with_a_reason():
    run = Run(count=1, seed=0)
    corner = Transform.from_parts(
        "base", "object", rotation_from_rotvec((np.pi / 2, 0, 0)), (0.37 + 0.0145, 0.0, 0.064)
    )
    run.world.put_part(0, corner)
    config = run.config
    run.config = config.model_copy(
        update={"grasp": config.grasp.model_copy(update={"max_tilt_rad": 0.01})}
    )
    fingers = run.config.fingers.model_copy(update={"thickness_m": 0.009})
    run.config = run.config.model_copy(update={"fingers": fingers})
    run.go()
    assert run.outcome.ending is Ending.NONE_GRASPABLE
    assert sum(run.outcome.left_reasons.values()) == 1
    assert run.score.left == 1


def test_a_full_tray_ends_the_run():
    config = load_cell()
    small = config.tray.model_copy(update={"size_m": (0.12, 0.05)})
    run = Run(count=2, seed=1, config=config.model_copy(update={"tray": small})).go()
    assert run.outcome.ending is Ending.TRAY_FULL
    assert len(run.outcome.attempts) == 1
    assert run.outcome.left_reasons == {"tray is full": 1}


def test_with_somebody_to_exchange_trays_a_full_one_does_not_end_the_run():
    config = load_cell()
    small = config.tray.model_copy(update={"size_m": (0.12, 0.05)})
    config = config.model_copy(update={"tray": small})
    run = Run(count=2, seed=1, config=config, has_operator=True).go()
    assert run.outcome.ending is Ending.EMPTY
    assert [pick.is_placed for pick in run.score.picks] == [True, True]
    assert len(run.journal.of("pick")) == 2
    assert "exchange tray" in {p["name"] for p in run.journal.of("phase")}


def seeing_too_high(run):
    truth = run.eyes.look

    async def too_high():
        scene = await truth()
        lift = Transform.from_translation("base", "base", (0, 0, 0.045))
        return replace(scene, objects=tuple(lift @ T for T in scene.objects))

    run.eyes.look = too_high
    return run


def test_a_wrong_pose_is_a_miss_that_the_gripper_notices():
    """Eyes that see every part 45 mm too high: the fingers close on nothing."""
    run = Run(count=1, seed=1)
    seeing_too_high(run).go()
    assert {a.miss for a in run.outcome.attempts} == {"no part"}
    assert not any(pick.is_held for pick in run.score.picks)
    assert run.outcome.ending in {Ending.TOO_MANY_MISSES, Ending.NONE_GRASPABLE}


def listening(run, when, act):
    """Do something to the world at the end of the first phase of a name."""
    done = []

    def listen(event, fields):
        if event == "phase" and fields["name"] == when and not done:
            done.append(True)
            act()

    run.extra_listeners.append(listen)
    return run


def test_a_part_dropped_on_the_way_is_a_miss_and_the_line_goes_on():
    run = Run(count=2, seed=1)
    listening(run, "retreat", lambda: Faults(run.world).drop_part()).go()
    first = run.outcome.attempts[0]
    assert first.outcome == "held"
    assert first.miss == "lost on the way"
    assert not run.score.picks[0].is_held
    assert not run.score.picks[0].is_placed


def test_a_stop_in_mid_run_is_an_error_and_the_pick_counts():
    run = Run(count=2, seed=1)
    listening(run, "descend", lambda: Faults(run.world).press_emergency_stop())
    with pytest.raises(SafetyError, match="emergency stop"):
        run.go()
    assert [a.miss[:8] for a in run.line.attempts] == ["aborted:"]


def test_the_arm_is_told_what_it_carries_and_that_it_is_gone():
    run = Run(count=1, seed=1)
    told = []
    run.on_load = told.append
    run.go()
    masses = [load.mass_kg for load in told]
    assert masses == [0.0, pytest.approx(run.part.mass_kg), 0.0]
    assert told[1].centre_m[2] == pytest.approx(run.config.fingers.tcp_m, abs=0.02)


def test_what_nobody_recognised_stands_in_the_way():
    """Boxes all round the only part: nothing may reach down to it."""
    run = Run(count=1, seed=1)
    truth = run.eyes.look

    async def crowded():
        scene = await truth()
        ring = [
            T.translation_m + (x, y, 0.02)
            for T in scene.objects
            for x in np.arange(-0.06, 0.061, 0.006)
            for y in np.arange(-0.06, 0.061, 0.006)
        ]
        return replace(scene, clutter_m=np.array(ring).reshape(-1, 3))

    run.eyes.look = crowded
    run.go()
    assert run.outcome.ending is Ending.NONE_GRASPABLE
    assert run.outcome.attempts == ()


def test_a_miss_makes_the_same_grasp_the_last_choice():
    run = Run(count=1, seed=1)
    seeing_too_high(run).go()
    tools = [T[:3, 3] for _, T in run.line.memory.misses]
    assert len(tools) == run.config.grasp.retries + 1
    for k, tool in enumerate(tools):
        assert all(np.linalg.norm(tool - other) > 0.004 for other in tools[:k])


def test_parts_on_the_tray_are_kept_clear_of():
    run = Run(count=3, seed=1).go()
    assert len(run.line.laid_down) == 3
    for pick, target in zip(run.score.picks, run.line.laid_down, strict=True):
        assert pose_error(run.world.part_pose(pick.part), target, run.part).position_m < 1e-3
