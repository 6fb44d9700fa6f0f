"""A circle's arc through three points."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

__all__ = ["Arc"]

Point = NDArray[np.float64]

NEAREST_M = 1e-4
FLATTEST = 1e-4


@dataclass(frozen=True, eq=False)
class Arc:
    """From a start over a via point to a goal, in metres.

    ``across`` is the radius vector to the start, ``up`` the one a quarter turn on.
    """

    centre_m: Point
    across_m: Point
    up_m: Point
    angle_rad: float

    @classmethod
    def through(cls, start_m: Point, via_m: Point, goal_m: Point) -> Self:
        """Find the circle.

        Raises
        ------
        ValueError
            Two points are nearer than 0.1 mm, or all lie on a line.
        """
        a, b = via_m - start_m, goal_m - start_m
        normal = np.cross(a, b)
        area = float(np.linalg.norm(normal))
        sides_m = [float(np.linalg.norm(side)) for side in (a, b, goal_m - via_m)]
        if min(sides_m) < NEAREST_M:
            raise ValueError(f"two points of the circle are only {min(sides_m):.6f} m apart")
        if area < FLATTEST * max(sides_m) ** 2:
            raise ValueError("the three points of the circle lie on a line")
        towards = np.cross(normal, a) * (b @ b) + np.cross(b, normal) * (a @ a)
        centre_m = start_m + towards / (2 * area**2)
        across_m = start_m - centre_m
        up_m = np.cross(normal / area, across_m)
        last = goal_m - centre_m
        angle_rad = float(np.arctan2(last @ up_m, last @ across_m)) % (2 * np.pi)
        return cls(centre_m, across_m, up_m, angle_rad)

    @property
    def length_m(self) -> float:
        """Along the arc."""
        return self.angle_rad * float(np.linalg.norm(self.across_m))

    def at(self, share: NDArray[np.float64]) -> Point:
        """Points at shares of the way, shape (n,) to (n, 3)."""
        angle = (self.angle_rad * share)[:, None]
        return self.centre_m + np.cos(angle) * self.across_m + np.sin(angle) * self.up_m
