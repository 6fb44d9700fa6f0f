"""What the pose search needs of a part, built once: its field, and points on its surface."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from perception.parts import Part
from perception.parts.sampling import sample_surface
from perception.pose.field import Field, revolution_field
from perception.pose.grid import grid_field

__all__ = ["PartModel", "build_model"]

SAMPLES = 400


@dataclass(frozen=True, eq=False)
class PartModel:
    """A part ready to be looked for; ``samples_m`` (S, 3) lie on its surface, evenly."""

    part: Part
    field: Field
    samples_m: NDArray[np.float64]

    @cached_property
    def corners_m(self) -> NDArray[np.float64]:
        """The corners of the box about the part, shape (8, 3), frame ``object``."""
        low, high = self.part.vertices_m.min(axis=0), self.part.vertices_m.max(axis=0)
        if self.part.fold == 0:
            low[:2], high[:2] = -self.part.max_radius_m, self.part.max_radius_m
        grid = np.meshgrid(*zip(low, high, strict=True), indexing="ij")
        return np.stack(grid, axis=-1).reshape(8, 3)


def build_model(part: Part) -> PartModel:
    """Tabulate the signed distance of ``part``.

    A solid of revolution takes well under a second. Any other part takes seconds and the ``sim``
    extra's ray caster; its table is kept in the user's cache folder.

    Raises
    ------
    ConfigError
        The table needs a library that is not installed.
    """
    field: Field = revolution_field(part) if part.fold == 0 else grid_field(part)
    points_m, _ = sample_surface(part.vertices_m, part.triangles, SAMPLES)
    return PartModel(part, field, points_m)
