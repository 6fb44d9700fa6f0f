"""Drawn parts are closed, weigh what they should, and their outline is their surface."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hal.errors import ConfigError
from perception.parts import CATALOGUE, ShaftSize, load_part, make_shaft
from perception.parts.mesh import check_closed
from perception.parts.sampling import sample_surface


@pytest.mark.parametrize("name", sorted(CATALOGUE))
def test_every_catalogue_part_is_closed_and_outside_out(name):
    part = load_part(name)
    check_closed(part.triangles)
    assert part.mass_kg > 0.01
    assert abs(part.vertices_m[:, 2].max() + part.vertices_m[:, 2].min()) < 1e-12


def test_a_cylinder_weighs_what_a_cylinder_weighs():
    part = load_part("shaft:20x100")
    radius, length = 0.010, 0.100
    mass = 7800 * np.pi * radius**2 * length
    across = mass * (3 * radius**2 + length**2) / 12
    assert part.mass_kg == pytest.approx(mass, rel=1e-3)
    assert np.diag(part.inertia_kgm2) == pytest.approx(
        [across, across, mass * radius**2 / 2], rel=2e-3
    )
    assert part.is_reversible


def test_the_centre_of_mass_follows_the_heavier_end():
    part = load_part("shaft:30x20,10x60")
    assert part.centre_of_mass_m[2] < -0.01
    assert np.abs(part.centre_of_mass_m[:2]).max() < 1e-9


sections = st.lists(st.tuples(st.integers(6, 40), st.integers(4, 60)), min_size=1, max_size=5)


@settings(max_examples=25, deadline=None)
@given(sections)
def test_the_surface_of_any_shaft_lies_on_its_profile(sizes):
    part = make_shaft(ShaftSize(tuple((d / 1000, n / 1000) for d, n in sizes)))
    check_closed(part.triangles)
    points, _ = sample_surface(part.vertices_m, part.triangles, 500)
    radius = np.hypot(points[:, 0], points[:, 1])
    beside = [part.profile.radius_at(points[:, 2] + step) for step in (-1e-6, 1e-6)]
    assert (radius <= np.maximum(*beside) + 1e-9).all()
    steel = np.pi * (part.profile.radii_m**2 * part.profile.lengths_m).sum() * 7800
    assert part.mass_kg == pytest.approx(steel, rel=2e-3)
    assert part.is_reversible == (sizes == sizes[::-1])


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("shaft:", "cannot read"),
        ("shaft:20x35,28", "cannot read"),
        ("shaft:20x-5", "length >= 1 mm"),
        ("shaft:1x50", "diameter >= 2 mm"),
        ("shaft:20x500", r"5\.\.300 mm"),
        ("shaft:nanx20", "not finite"),
        ("shaft:20xinf", "not finite"),
        ("shaft:" + ",".join(["20x2"] * 30), "at most 20"),
        ("spindle", "known are shaft"),
        ("", "known are shaft"),
    ],
)
def test_a_part_that_cannot_be_is_refused_with_the_reason(text, reason):
    with pytest.raises(ConfigError, match=reason):
        load_part(text)
