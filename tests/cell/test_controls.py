"""Negative controls: make one thing wrong, and success must collapse."""

import numpy as np
import pytest

from cell.config import load_cell
from cell.demo.controls import Controls, Images
from cell.demo.run import DemoOptions, run_demo
from hal.errors import ConfigError
from perception.parts import load_part


def demo(*words, count=4, seed=2):
    options = DemoOptions(
        load_cell(),
        load_part("shaft"),
        count,
        seed,
        Controls.parse(words),
        keeps_pictures=False,
    )
    return run_demo(options).result


def test_words_become_controls():
    controls = Controls.parse(["mu=0.05", "offset=0.003", "one-finger", "nominal", "swapped"])
    assert controls == Controls(0.05, 0.003, True, True, Images.SWAPPED)
    assert Controls.parse([]) == Controls()
    for bad in ("mu", "mu=x", "mu=9", "offset=-1", "gravity"):
        with pytest.raises(ConfigError, match="--control"):
            Controls.parse([bad])


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("control", ["mu=0.02", "offset=0.010", "one-finger", "nominal"])
def test_success_collapses(control):
    usual, spoilt = demo(), demo(control)
    assert usual["placed"] == usual["attempts"] == 4
    assert spoilt["placed"] <= 0.25 * spoilt["attempts"]


@pytest.mark.slow
def test_three_millimetres_beside_are_centred_by_the_fingers_and_miss_the_slot():
    result = demo("offset=0.003")
    assert result["held"] == result["attempts"]
    assert result["placed"] == 0
    for pick in result["picks"]:
        assert pick["place_error"]["transverse_mm"] == pytest.approx(3.0, abs=0.2)


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_twenty_shafts_from_images():
    """The headline case on two development seeds."""
    results = [demo(count=20, seed=seed) for seed in (0, 1)]
    attempts = sum(r["attempts"] for r in results)
    assert sum(r["placed"] for r in results) >= 0.95 * attempts
    assert sum(r["left"] for r in results) <= 0.05 * 40
    axis = [p["pose_error"]["axis_deg"] for r in results for p in r["picks"]]
    assert np.sqrt(np.mean(np.square(axis))) < 0.15
