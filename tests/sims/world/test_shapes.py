import numpy as np
import pytest

from sims.world import PartShape, Primitive, cylinders


def test_mass_and_inertia_of_a_plain_cylinder_are_the_textbooks():
    shape = cylinders([-0.05, 0.05], [0.01], 1000.0)
    mass = 1000 * np.pi * 0.01**2 * 0.1
    assert shape.mass_kg == pytest.approx(mass)
    across = mass * (3 * 0.01**2 + 0.1**2) / 12
    assert shape.inertia == pytest.approx((across, across, mass * 0.01**2 / 2))
    assert shape.centre_m == (0, 0, 0)


def test_cutting_a_cylinder_into_sections_changes_nothing():
    whole = cylinders([-0.05, 0.05], [0.01])
    cut = cylinders([-0.05, -0.02, 0.03, 0.05], [0.01, 0.01, 0.01])
    assert cut.mass_kg == pytest.approx(whole.mass_kg)
    assert cut.inertia == pytest.approx(whole.inertia)
    assert len(cut.primitives) == 1


def test_the_centre_of_mass_lies_in_the_thicker_half():
    shape = cylinders([-0.05, 0.0, 0.05], [0.005, 0.015])
    assert shape.centre_m[2] > 0.015


def test_few_overlapping_cylinders_cover_exactly_the_outline():
    z, r = np.array([-0.05, -0.03, 0.0, 0.02, 0.05]), np.array([0.01, 0.014, 0.012, 0.02])
    shape = cylinders(z, r)
    assert len(shape.primitives) == 4
    for height in np.linspace(-0.0499, 0.0499, 57):
        covering = [
            p.size_m[0]
            for p in shape.primitives
            if abs(height - p.centre_m[2]) <= p.size_m[1] + 1e-12
        ]
        assert max(covering) == r[np.searchsorted(z, height) - 1]


def test_the_stepped_shaft_is_two_cylinders():
    assert len(cylinders([-0.05, -0.015, 0.01, 0.05], [0.01, 0.014, 0.01]).primitives) == 2


@pytest.mark.parametrize(
    ("edges", "radii"),
    [([0, 1], [0.1, 0.1]), ([0, 0], [0.1]), ([0, 1], [0.0]), ([0], []), ([1, 0], [0.1])],
)
def test_an_outline_that_is_none_is_refused(edges, radii):
    with pytest.raises(ValueError, match=r"edges|sections"):
        cylinders(edges, radii)


def test_primitives_are_checked():
    with pytest.raises(ValueError, match="sphere"):
        Primitive("sphere", (1.0,))
    with pytest.raises(ValueError, match="sizes"):
        Primitive("box", (1.0, 1.0))
    with pytest.raises(ValueError, match="mass"):
        PartShape((Primitive("box", (0.1, 0.1, 0.1)),), 0.0, (1, 1, 1), 0.1, 0.1)
