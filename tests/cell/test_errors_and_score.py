import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cell.demo.errors import pose_error, summary
from hal import Transform, rotation_from_rotvec
from perception.parts import load_part

SHAFT, PLAIN = load_part("shaft"), load_part("shaft:20x100")
POSE = Transform.from_parts(
    "base", "object", rotation_from_rotvec((0.3, -0.8, 0.2)), (0.5, 0.1, 0.07)
)


def moved(rotvec=(0, 0, 0), shift=(0, 0, 0)):
    """Moved in the part's own frame."""
    return POSE @ Transform.from_parts("object", "object", rotation_from_rotvec(rotvec), shift)


@given(st.floats(-3, 3))
def test_a_turn_about_its_axis_is_no_error(roll):
    error = pose_error(moved((0, 0, roll)), POSE, SHAFT)
    assert error.axis_rad < 1e-7
    assert error.position_m < 1e-9


def test_across_and_along_are_told_apart():
    error = pose_error(moved(shift=(3e-4, 4e-4, 2e-3)), POSE, SHAFT)
    assert error.transverse_m == pytest.approx(5e-4)
    assert error.axial_m == pytest.approx(2e-3)
    assert error.position_m == pytest.approx(np.hypot(5e-4, 2e-3))


def test_end_for_end_is_a_flip_only_where_the_ends_differ():
    turned = moved((np.pi, 0, 0))
    assert pose_error(turned, POSE, SHAFT).is_flipped
    assert not pose_error(turned, POSE, PLAIN).is_flipped
    assert pose_error(turned, POSE, SHAFT).axis_rad < 1e-7


def test_the_summary_is_of_successes_with_misses_beside():
    errors = [pose_error(moved((np.radians(a), 0, 0)), POSE, SHAFT) for a in (0.3, 0.4)]
    rows = summary(errors, misses=3)
    assert rows["n"] == 2
    assert rows["misses"] == 3
    assert rows["axis_deg"]["rms"] == pytest.approx(np.sqrt((0.3**2 + 0.4**2) / 2))
    assert summary([], misses=1) == {"n": 0, "misses": 1}
