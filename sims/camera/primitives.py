"""Triangle meshes of MuJoCo's primitive shapes, in the geom's own frame.

Every function returns vertices (n, 3) float32 in metres and triangles (m, 3) uint32 with
outward normals.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["AnyMesh", "Mesh", "box", "capsule", "cylinder", "ellipsoid", "plane", "revolved"]

Mesh = tuple[NDArray[np.float32], NDArray[np.uint32]]
AnyMesh = tuple[NDArray[np.floating[Any]], NDArray[np.integer[Any]]]

SEGMENTS = 72
FAR_M = 5.0


def box(half_m: ArrayLike) -> Mesh:
    """A box of half sizes (3,)."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return signs * np.asarray(half_m, np.float32), np.array(triangles, np.uint32)


def plane(half_m: ArrayLike) -> Mesh:
    """A rectangle in the plane z = 0; a half size of zero means endless, here 5 m."""
    x, y = (float(h) if h > 0 else FAR_M for h in np.asarray(half_m, float)[:2])
    corners = np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]], np.float32)
    return corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32)


def revolved(profile_m: ArrayLike, *, segments: int = SEGMENTS) -> Mesh:
    """A solid of revolution about z from its outline (k, 2) of (radius, z), z ascending.

    Both ends are closed by a fan; an end of radius zero is fine.
    """
    profile = np.asarray(profile_m, float)
    rings = len(profile)
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    side = np.concatenate(
        [np.column_stack([radius * circle, np.full(segments, z)]) for radius, z in profile]
    )
    ends = np.array([[0, 0, profile[0, 1]], [0, 0, profile[-1, 1]]])
    this = np.arange(segments)
    following = (this + 1) % segments
    triangles = []
    for ring in range(rings - 1):
        a, b = ring * segments + this, ring * segments + following
        c, d = b + segments, a + segments
        triangles += [np.stack([a, b, c], 1), np.stack([a, c, d], 1)]
    bottom, top = np.full(segments, len(side)), np.full(segments, len(side) + 1)
    last = (rings - 1) * segments
    triangles += [np.stack([bottom, following, this], 1)]
    triangles += [np.stack([top, last + this, last + following], 1)]
    vertices = np.concatenate([side, ends]).astype(np.float32)
    return vertices, np.concatenate(triangles).astype(np.uint32)


def cylinder(radius_m: float, half_length_m: float) -> Mesh:
    """Along z."""
    return revolved([(radius_m, -half_length_m), (radius_m, half_length_m)])


def capsule(radius_m: float, half_length_m: float) -> Mesh:
    """Along z; ``half_length_m`` is that of the cylindrical part."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 25)
    z = radius_m * np.sin(angle) + np.where(angle < 0, -half_length_m, half_length_m)
    # The middle ring belongs to both halves.
    middle = len(angle) // 2
    r = radius_m * np.cos(angle)
    outline = np.column_stack([r, z])
    outline = np.insert(outline, middle, (radius_m, -half_length_m), axis=0)
    return revolved(outline)


def ellipsoid(half_m: ArrayLike) -> Mesh:
    """Half axes (3,); a sphere has three equal ones."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 37)
    vertices, triangles = revolved(np.column_stack([np.cos(angle), np.sin(angle)]))
    return vertices * np.asarray(half_m, np.float32), triangles
