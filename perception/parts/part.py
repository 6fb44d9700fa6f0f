"""What a part is: a closed surface with an axis, its symmetry, and its outline as cylinders."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hal import Transform
from perception.parts.solid import SolidProperties, solid_properties

__all__ = ["STEEL_KGPM3", "Part", "Profile"]

STEEL_KGPM3 = 7800.0


@dataclass(frozen=True, eq=False)
class Profile:
    """The outer surface as cylinders stacked along the axis.

    ``z_edges_m`` has shape (K+1,), rising; section k reaches from ``z_edges_m[k]`` to
    ``z_edges_m[k + 1]`` and has radius ``radii_m[k]``; ``radii_m`` has shape (K,).
    """

    z_edges_m: NDArray[np.float64]
    radii_m: NDArray[np.float64]

    def __post_init__(self) -> None:
        z_edges_m = np.array(self.z_edges_m, dtype=np.float64)
        radii_m = np.array(self.radii_m, dtype=np.float64)
        if radii_m.ndim != 1 or z_edges_m.shape != (len(radii_m) + 1,) or not len(radii_m):
            raise ValueError(f"{z_edges_m.shape} edges do not bound {radii_m.shape} sections")
        if not (np.diff(z_edges_m) > 0).all() or not (radii_m > 0).all():
            raise ValueError("a profile needs rising edges and positive radii")
        for name, array in (("z_edges_m", z_edges_m), ("radii_m", radii_m)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def centres_m(self) -> NDArray[np.float64]:
        """The middle of each section along the axis, shape (K,)."""
        return np.asarray((self.z_edges_m[1:] + self.z_edges_m[:-1]) / 2)

    @property
    def lengths_m(self) -> NDArray[np.float64]:
        """The length of each section, shape (K,)."""
        return np.diff(self.z_edges_m)

    def radius_at(self, z_m: NDArray[np.floating]) -> NDArray[np.float64]:
        """Return the radius at ``z_m`` (any shape), metres; zero beyond the ends."""
        section = np.searchsorted(self.z_edges_m, z_m, side="right") - 1
        inside = (section >= 0) & (section < len(self.radii_m))
        return np.where(inside, self.radii_m[np.clip(section, 0, len(self.radii_m) - 1)], 0.0)


@dataclass(frozen=True, eq=False)
class Part:
    """A rigid part in its own frame ``object``.

    The frame's origin lies on the symmetry axis at the middle of the extent along it; +z is the
    axis. Poses inside binpick are of this frame; ``T_object_mesh`` leads to the frame of the
    file that the part came from, in which poses are reported.

    Parameters
    ----------
    vertices_m
        Shape (V, 3), float64, metres, frame ``object``.
    triangles
        Shape (F, 3), int32; counter-clockwise seen from outside; closed.
    fold
        0 for a solid of revolution, n >= 2 when a turn by 360/n degrees changes nothing.
    is_reversible
        Half a turn about the object's x axis (any axis across, for fold 0) changes nothing.
    """

    name: str
    vertices_m: NDArray[np.float64]
    triangles: NDArray[np.int32]
    fold: int
    is_reversible: bool
    profile: Profile
    density_kgpm3: float = STEEL_KGPM3
    T_object_mesh: Transform = field(default_factory=lambda: Transform.identity("object", "mesh"))
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        vertices_m = np.array(self.vertices_m, dtype=np.float64)
        triangles = np.array(self.triangles, dtype=np.int32)
        if vertices_m.ndim != 2 or vertices_m.shape[1] != 3:
            raise ValueError(f"{self.name}: vertices of shape {vertices_m.shape}")
        if triangles.ndim != 2 or triangles.shape[1] != 3:
            raise ValueError(f"{self.name}: triangles of shape {triangles.shape}")
        if self.fold < 0 or self.fold == 1:
            raise ValueError(f"{self.name}: fold {self.fold}")
        for name, array in (("vertices_m", vertices_m), ("triangles", triangles)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @cached_property
    def solid(self) -> SolidProperties:
        """Volume, centroid and second moments of the enclosed solid, frame ``object``."""
        return solid_properties(self.vertices_m, self.triangles)

    @property
    def mass_kg(self) -> float:
        """Volume times density."""
        return self.solid.volume_m3 * self.density_kgpm3

    @property
    def centre_of_mass_m(self) -> NDArray[np.float64]:
        """Shape (3,), frame ``object``: on the axis, not always at the origin."""
        return self.solid.centroid_m

    @property
    def inertia_kgm2(self) -> NDArray[np.float64]:
        """Shape (3, 3), about the centre of mass, axes of frame ``object``."""
        return self.solid.inertia_m5 * self.density_kgpm3

    @property
    def length_m(self) -> float:
        """Extent along the axis."""
        return float(np.ptp(self.vertices_m[:, 2]))

    @property
    def max_radius_m(self) -> float:
        """The farthest that the surface reaches from the axis."""
        return float(np.hypot(self.vertices_m[:, 0], self.vertices_m[:, 1]).max())
