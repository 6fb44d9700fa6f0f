"""A part as physics sees it: a few convex primitives, a mass and an inertia."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["PartShape", "Primitive", "cylinders"]

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Primitive:
    """One convex body in the object frame.

    ``size_m`` is (radius, half length) of a cylinder or capsule along its own z, the three
    half sides of a box, and empty for ``mesh``, whose convex hull of ``vertices_m`` counts.
    """

    kind: str
    size_m: tuple[float, ...]
    centre_m: Vector = (0.0, 0.0, 0.0)
    quaternion_wxyz: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    vertices_m: tuple[Vector, ...] = ()

    def __post_init__(self) -> None:
        sides = {"cylinder": 2, "capsule": 2, "box": 3, "mesh": 0}
        if self.kind not in sides:
            raise ValueError(f"a primitive is one of {', '.join(sides)}, not {self.kind!r}")
        if len(self.size_m) != sides[self.kind] or not all(s > 0 for s in self.size_m):
            raise ValueError(f"{self.kind}: sizes {self.size_m}")

    @property
    def reach_m(self) -> float:
        """Largest distance from the object's origin."""
        if self.kind == "mesh":
            return float(np.linalg.norm(np.array(self.vertices_m), axis=1).max())
        own = sum(self.size_m) if self.kind == "capsule" else float(np.linalg.norm(self.size_m))
        return float(np.linalg.norm(self.centre_m)) + own


@dataclass(frozen=True)
class PartShape:
    """What the world drops into the bin: frame ``object``, +z along the axis.

    ``inertia`` is the diagonal about ``centre_m``, the centre of mass, in kg m2.
    ``length_m`` is the extent along the axis, ``radius_m`` the largest across it.
    """

    primitives: tuple[Primitive, ...]
    mass_kg: float
    inertia: Vector
    length_m: float
    radius_m: float
    centre_m: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not self.primitives:
            raise ValueError("a part needs at least one primitive")
        if not (self.mass_kg > 0 and min(self.inertia) > 0):
            raise ValueError(f"mass {self.mass_kg:g} kg, inertia {self.inertia} kg m2")

    @property
    def reach_m(self) -> float:
        """Radius of the ball about the origin that holds the part."""
        return max(primitive.reach_m for primitive in self.primitives)

    @property
    def hull_volume_m3(self) -> float:
        """Volume of the cylinder around the part."""
        return float(np.pi * self.radius_m**2 * self.length_m)


def cylinders(z_edges_m: ArrayLike, radii_m: ArrayLike, density_kgpm3: float = 7850.0) -> PartShape:
    """Build a turned part from its sections; mass and inertia are exact.

    Parameters
    ----------
    z_edges_m
        Shape (n + 1,), increasing: where the sections begin and end along the axis.
    radii_m
        Shape (n,): outer radius of each.
    density_kgpm3
        Steel unless said.

    Raises
    ------
    ValueError
        Edges that do not increase, radii that are not positive, or numbers that do not match.
    """
    z = np.asarray(z_edges_m, float)
    r = np.asarray(radii_m, float)
    if z.ndim != 1 or len(z) != len(r) + 1 or len(r) == 0:
        raise ValueError(f"{len(z)} edges do not bound {len(r)} sections")
    if not (np.diff(z) > 0).all() or not (r > 0).all() or not density_kgpm3 > 0:
        raise ValueError("sections need increasing edges, positive radii and a positive density")
    lengths, middles = np.diff(z), (z[1:] + z[:-1]) / 2
    masses = density_kgpm3 * np.pi * r**2 * lengths
    mass = float(masses.sum())
    centre = float((masses * middles).sum() / mass)
    along = float((masses * r**2).sum() / 2)
    across = float((masses * ((3 * r**2 + lengths**2) / 12 + (middles - centre) ** 2)).sum())
    return PartShape(
        primitives=tuple(_covering(z.tolist(), r.tolist(), 0, len(r))),
        mass_kg=mass,
        inertia=(across, across, along),
        length_m=float(z[-1] - z[0]),
        radius_m=float(r.max()),
        centre_m=(0.0, 0.0, centre),
    )


def _covering(z_m: Sequence[float], r_m: Sequence[float], first: int, end: int) -> list[Primitive]:
    """Cover sections first..end by cylinders that overlap: the thinnest runs all the way.

    Fewer and longer cylinders settle faster than a stack that meets end to end.
    """
    thinnest = min(r_m[first:end])
    half = (z_m[end] - z_m[first]) / 2
    middle = (z_m[end] + z_m[first]) / 2
    found = [Primitive("cylinder", (thinnest, half), (0.0, 0.0, middle))]
    k = first
    while k < end:
        start = k
        while k < end and r_m[k] > thinnest:
            k += 1
        if k > start:
            found += _covering(z_m, r_m, start, k)
        else:
            k += 1
    return found
