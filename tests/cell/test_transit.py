import itertools

import numpy as np
import pytest

from cell.planning.transit import RESOLUTION_RAD, _bisected, line_is_free, plan_transit

LOWER, UPPER = np.full(6, -3.0), np.full(6, 3.0)
START, GOAL = np.zeros(6), np.array([1.0, 0, 0, 0, 0, 0])


def wall(q):
    """A thin wall across joint 1, open only above joint 2 = 0.5."""
    return not (abs(q[0] - 0.5) < 0.004 and q[1] < 0.5)


def free_everywhere(path, is_free):
    dense = [a + (b - a) * u for a, b in itertools.pairwise(path) for u in np.linspace(0, 1, 2000)]
    return all(is_free(q) for q in dense)


@pytest.mark.parametrize("count", [1, 2, 3, 7, 8, 100])
def test_every_position_of_a_line_is_checked_once(count):
    assert sorted(_bisected(count)) == list(range(count))


def test_a_wall_thinner_than_a_finger_is_seen():
    assert RESOLUTION_RAD < 0.008
    assert not line_is_free(wall, START, GOAL)
    assert (
        plan_transit(
            lambda q: True,
            START,
            GOAL,
            lower_rad=LOWER,
            upper_rad=UPPER,
            rng=np.random.default_rng(0),
        )[0]
        is GOAL
    )


@pytest.mark.parametrize("seed", range(5))
def test_a_way_round_the_wall_is_found_and_free(seed):
    path = plan_transit(
        wall, START, GOAL, lower_rad=LOWER, upper_rad=UPPER, rng=np.random.default_rng(seed)
    )
    assert path is not None
    np.testing.assert_array_equal(path[-1], GOAL)
    assert free_everywhere([START, *path], wall)


def test_the_same_seed_gives_the_same_way():
    ways = [
        plan_transit(
            wall, START, GOAL, lower_rad=LOWER, upper_rad=UPPER, rng=np.random.default_rng(3)
        )
        for _ in range(2)
    ]
    assert np.array_equal(np.array(ways[0]), np.array(ways[1]))


def test_no_way_is_said_within_bounds():
    checks = []

    def closed(q):
        checks.append(1)
        return abs(q[0] - 0.5) > 0.1

    assert (
        plan_transit(
            closed,
            START,
            GOAL,
            lower_rad=LOWER,
            upper_rad=UPPER,
            rng=np.random.default_rng(0),
            max_samples=20,
        )
        is None
    )
    assert len(checks) < 50_000
    blocked = plan_transit(
        lambda q: q[0] < 0.9,
        START,
        GOAL,
        lower_rad=LOWER,
        upper_rad=UPPER,
        rng=np.random.default_rng(0),
    )
    assert blocked is None
