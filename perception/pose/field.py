"""A part's signed distance and its gradient, tabulated once and read by interpolation.

A solid of revolution needs only the half-plane (radius, z): a table of some 40 000 values that
fits the processor's cache. Other parts get a grid in space.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from perception.parts import Part
from perception.pose.meridian import ANGLES_RAD, meridian_distance, meridian_segments

__all__ = ["Field", "GridField", "RevolutionField", "revolution_field"]

PADDING_M = 0.008
MERIDIAN_STEP_M = 0.00025


class Field(Protocol):
    """Signed distance to a part's surface in frame ``object``; negative inside."""

    @property
    def radius_m(self) -> float:
        """The farthest that the part reaches from the z axis."""
        ...

    @property
    def half_length_m(self) -> float:
        """Half the part's extent along z, about the origin."""
        ...

    def distance(self, points_m: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the distance at points (..., 3); beyond the table never more than the truth."""
        ...

    def sample(
        self, points_m: NDArray[np.floating]
    ) -> tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.bool_]]:
        """Return distance (...), gradient (..., 3) and whether the point lies in the table."""
        ...


@dataclass(frozen=True, eq=False)
class RevolutionField:
    """The table of a solid of revolution.

    ``table`` has shape (R, Z, 3), float32: distance, its derivative along the radius and along
    z. Sample (i, j) stands at radius ``i * step_m`` and ``z_start_m + j * step_m``.
    """

    table: NDArray[np.float32]
    z_start_m: float
    step_m: float
    radius_m: float
    half_length_m: float

    def _locate(
        self, points_m: NDArray[np.floating]
    ) -> tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.floating]]:
        radius_m = np.sqrt(points_m[..., 0] ** 2 + points_m[..., 1] ** 2)
        scale = points_m.dtype.type(1 / self.step_m)
        row = radius_m * scale
        column = (points_m[..., 2] - points_m.dtype.type(self.z_start_m)) * scale
        return radius_m, row, column

    def meridian(
        self, row: NDArray[np.floating], column: NDArray[np.floating]
    ) -> NDArray[np.floating]:
        """Interpolate the table at fractional (row, column), clamped to it: shape (..., 3)."""
        rows, columns = self.table.shape[:2]
        row = np.clip(row, 0, rows - 1.001)
        column = np.clip(column, 0, columns - 1.001)
        i, j = row.astype(np.int32), column.astype(np.int32)
        a, b = (row - i)[..., None], (column - j)[..., None]
        flat = self.table.reshape(-1, 3)
        at = i * columns + j
        low = flat[at] + b * (flat[at + 1] - flat[at])
        high = flat[at + columns] + b * (flat[at + columns + 1] - flat[at + columns])
        return np.asarray(low + a * (high - low))

    def distance(self, points_m: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the signed distance at points (..., 3)."""
        _, row, column = self._locate(points_m)
        rows, columns = self.table.shape[:2]
        row = np.clip(row, 0, rows - 1.001)
        column = np.clip(column, 0, columns - 1.001)
        i, j = row.astype(np.int32), column.astype(np.int32)
        a, b = row - i, column - j
        flat = self.distances
        at = i * columns + j
        low = flat[at] + b * (flat[at + 1] - flat[at])
        high = flat[at + columns] + b * (flat[at + columns + 1] - flat[at + columns])
        return np.asarray(low + a * (high - low))

    @cached_property
    def distances(self) -> NDArray[np.float32]:
        """The distances alone, flat, in the table's order."""
        return self.table[..., 0].reshape(-1).copy()

    def sample(
        self, points_m: NDArray[np.floating]
    ) -> tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.bool_]]:
        """Return distance, gradient and whether the point lies in the table."""
        radius_m, row, column = self._locate(points_m)
        values = self.meridian(row, column)
        rows, columns = self.table.shape[:2]
        is_inside = (row < rows - 1) & (column > 0) & (column < columns - 1)
        gradient = np.empty(points_m.shape, points_m.dtype)
        outward = values[..., 1] / np.maximum(radius_m, 1e-9)
        gradient[..., 0] = outward * points_m[..., 0]
        gradient[..., 1] = outward * points_m[..., 1]
        gradient[..., 2] = values[..., 2]
        return values[..., 0], gradient, is_inside


def revolution_field(part: Part) -> RevolutionField:
    """Tabulate a solid of revolution: the mean over several half-planes, facets averaged out."""
    reach_m = part.max_radius_m + PADDING_M
    step_m = MERIDIAN_STEP_M * max(1.0, reach_m * (part.length_m + 2 * PADDING_M) / 0.004)
    radius_m = step_m * np.arange(np.ceil(reach_m / step_m) + 1, dtype=np.float64)
    half_m = part.length_m / 2 + PADDING_M
    z_m = -half_m + step_m * np.arange(np.ceil(2 * half_m / step_m) + 1, dtype=np.float64)
    outlines = [meridian_segments(part, angle) for angle in ANGLES_RAD.tolist()]
    if len(outlines[0]) > 300:
        outlines = outlines[:3]
    distance_m = np.mean([meridian_distance(o, radius_m, z_m) for o in outlines], axis=0)
    along_radius, along_z = np.gradient(distance_m, step_m)
    table = np.stack([distance_m, along_radius, along_z], axis=-1).astype(np.float32)
    return RevolutionField(table, -half_m, step_m, part.max_radius_m, part.length_m / 2)


@dataclass(frozen=True, eq=False)
class GridField:
    """The table of any other part: ``table`` (X, Y, Z, 4), float32: distance and gradient.

    Sample (i, j, k) stands at ``start_m + step_m * (i, j, k)``.
    """

    table: NDArray[np.float32]
    start_m: NDArray[np.float64]
    step_m: float
    radius_m: float
    half_length_m: float

    def _interpolate(
        self, points_m: NDArray[np.floating], channels: int
    ) -> tuple[NDArray[np.floating], NDArray[np.bool_]]:
        shape = np.array(self.table.shape[:3])
        at = (points_m - self.start_m.astype(points_m.dtype)) * points_m.dtype.type(1 / self.step_m)
        is_inside = ((at > 0) & (at < shape - 1)).all(axis=-1)
        at = np.clip(at, 0, (shape - 1.001).astype(at.dtype))
        cell = at.astype(np.int64)
        f = at - cell
        strides = np.array([shape[1] * shape[2], shape[2], 1])
        corner = cell[..., 0] * strides[0] + cell[..., 1] * strides[1] + cell[..., 2]
        flat = self.table.reshape(-1, 4)[:, :channels]
        along_z = [
            flat[corner + offset] + f[..., 2:] * (flat[corner + offset + 1] - flat[corner + offset])
            for offset in (0, strides[1], strides[0], strides[0] + strides[1])
        ]
        low = along_z[0] + f[..., 1:2] * (along_z[1] - along_z[0])
        high = along_z[2] + f[..., 1:2] * (along_z[3] - along_z[2])
        return low + f[..., :1] * (high - low), np.asarray(is_inside)

    def distance(self, points_m: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the signed distance at points (..., 3)."""
        return np.asarray(self._interpolate(points_m, 1)[0][..., 0])

    def sample(
        self, points_m: NDArray[np.floating]
    ) -> tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.bool_]]:
        """Return distance, gradient and whether the point lies in the table."""
        values, is_inside = self._interpolate(points_m, 4)
        return values[..., 0], values[..., 1:], is_inside
