"""Volume integrals of a closed triangle mesh, exact for the polyhedron."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["SolidProperties", "solid_properties", "triangle_normals"]


@dataclass(frozen=True, eq=False)
class SolidProperties:
    """Integrals over the enclosed solid at unit density.

    ``volume_m3`` is negative for an inside-out mesh. ``centroid_m`` has shape (3,);
    ``inertia_m5`` (3, 3) is taken about the centroid.
    """

    volume_m3: float
    centroid_m: NDArray[np.float64]
    inertia_m5: NDArray[np.float64]


def solid_properties(
    vertices_m: NDArray[np.float64], triangles: NDArray[np.integer]
) -> SolidProperties:
    """Integrate over the tetrahedra between the origin and each triangle.

    Over one of them, with corners 0, a, b, c: V = a.(b x c) / 6, the first moment is
    V (a + b + c) / 4 and the second V / 20 (a a' + b b' + c c' + s s') with s = a + b + c.

    Raises
    ------
    ValueError
        The enclosed volume is zero.
    """
    middle_m = vertices_m.mean(axis=0)
    a, b, c = np.moveaxis((vertices_m - middle_m)[triangles], 1, 0)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    volume_m3 = float(volumes.sum())
    if volume_m3 == 0.0:
        raise ValueError("the surface encloses no volume")
    total = a + b + c
    first = np.einsum("i,ij->j", volumes, total) / 4
    second = sum(np.einsum("i,ij,ik->jk", volumes, p, p) for p in (a, b, c, total)) / 20
    centroid = first / volume_m3
    covariance = second - volume_m3 * np.outer(centroid, centroid)
    inertia_m5 = np.trace(covariance) * np.eye(3) - covariance
    return SolidProperties(volume_m3, centroid + middle_m, inertia_m5)


def triangle_normals(
    vertices_m: NDArray[np.float64], triangles: NDArray[np.integer]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return unit normals (F, 3) and areas (F,) in square metres; a sliver's normal is zero."""
    a, b, c = np.moveaxis(vertices_m[triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    doubled = np.linalg.norm(normals, axis=1)
    return normals / np.maximum(doubled, 1e-30)[:, None], doubled / 2
