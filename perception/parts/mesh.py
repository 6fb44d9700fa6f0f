"""Mesh files: read, checked, and brought to frame ``object``.

A mesh has to be what a part is: a closed surface about an axis of symmetry, of a size that can be
picked. What is wrong is said in one line. One fault is mended: a surface that is inside out as a
whole is turned, and the part's ``notes`` say so.
"""

from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hal import Transform
from hal.errors import ConfigError
from perception.parts.formats import MAX_BYTES, read_obj, read_ply, read_stl
from perception.parts.outline import outer_profile
from perception.parts.part import Part
from perception.parts.solid import solid_properties
from perception.parts.symmetry import find_symmetry

__all__ = ["MESH_SUFFIXES", "load_mesh"]

READERS = {".stl": read_stl, ".ply": read_ply, ".obj": read_obj}
MESH_SUFFIXES = frozenset(READERS)
MIN_SIDE_M = 0.005
MAX_SIDE_M = 0.300
# Corners closer than a hundredth of a micrometre are one corner: STL repeats each six times.
SAME_CORNER_M = 1e-8


def load_mesh(path: Path, *, unit: Literal["mm", "m"] = "mm", density_kgpm3: float) -> Part:
    """Read ``path`` and find its axis.

    Raises
    ------
    ConfigError
        With ``source`` the path and a reason: no such file, not a mesh, cut off, not finite, not
        closed, badly oriented, too large or small in ``unit``, or without an axis of symmetry.
    """
    source = str(path)
    try:
        vertices, corners = _read(path)
        if not np.isfinite(vertices).all():
            raise ValueError("some vertices are not finite numbers")
        vertices_m = vertices * (0.001 if unit == "mm" else 1.0)
        _check_size(vertices_m[corners.ravel()], unit)
        vertices_m, triangles = merge_corners(vertices_m, corners)
        check_closed(triangles)
        notes: tuple[str, ...] = ()
        if solid_properties(vertices_m, triangles).volume_m3 < 0:
            triangles = triangles[:, ::-1].copy()
            notes = ("the surface was inside out and has been turned",)
        symmetry = find_symmetry(vertices_m, triangles)
    except ValueError as error:
        raise ConfigError(str(error), source=source) from error
    rotation, origin_m = symmetry.rotation, symmetry.origin_m
    local_m = np.einsum("ni,ij->nj", vertices_m - origin_m, rotation)
    middle_m = (local_m[:, 2].min() + local_m[:, 2].max()) / 2
    local_m[:, 2] -= middle_m
    T_mesh_object = Transform.from_parts(
        "mesh", "object", rotation, origin_m + rotation[:, 2] * middle_m
    )
    return Part(
        name=path.stem,
        vertices_m=local_m,
        triangles=triangles,
        fold=symmetry.fold,
        is_reversible=symmetry.is_reversible,
        profile=outer_profile(local_m, triangles),
        density_kgpm3=density_kgpm3,
        T_object_mesh=T_mesh_object.inverse(),
        notes=notes,
    )


def _read(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise ValueError(f"{path.suffix or 'no suffix'}: meshes are .stl, .ply or .obj files")
    try:
        size = path.stat().st_size
        if not path.is_file():
            raise ValueError("not a file")
        if size > MAX_BYTES:
            raise ValueError(f"{size} bytes; at most {MAX_BYTES} are read")
        data = path.read_bytes()
    except FileNotFoundError:
        raise ValueError("no such file") from None
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror}") from None
    if not data:
        raise ValueError("the file is empty")
    return reader(data)


def _check_size(used_m: NDArray[np.float64], unit: str) -> None:
    largest_m = float(np.ptp(used_m, axis=0).max())
    if not MIN_SIDE_M <= largest_m <= MAX_SIDE_M:
        other = {"mm": "m", "m": "mm"}[unit]
        factor = 1000.0 if unit == "mm" else 0.001
        fits = MIN_SIDE_M <= largest_m * factor <= MAX_SIDE_M
        hint = f"; in {other} it would fit, so say unit={other} if that is meant" if fits else ""
        raise ValueError(
            f"largest side {largest_m * 1000:.4g} mm, read in {unit}, is not in 5..300 mm{hint}"
        )


def merge_corners(
    vertices_m: NDArray[np.float64], triangles: NDArray[np.integer]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Make equal corners one, and drop triangles that collapse and vertices that none uses."""
    keys = np.round((vertices_m - vertices_m.min(axis=0)) / SAME_CORNER_M).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    triangles = inverse.reshape(-1)[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    used, inverse = np.unique(triangles, return_inverse=True)
    return vertices_m[first[used]], inverse.reshape(-1, 3).astype(np.int32)


def check_closed(triangles: NDArray[np.integer]) -> None:
    """Refuse a surface that has a rim, or whose triangles do not agree on the outside.

    Raises
    ------
    ValueError
        Some edge is not shared by two triangles that run along it in opposite directions.
    """
    if not len(triangles):
        raise ValueError("nothing is left of it without collapsed triangles")
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = edges.astype(np.int64)
    size = int(edges.max()) + 1
    forward = edges[:, 0] * size + edges[:, 1]
    plain = edges.min(axis=1) * size + edges.max(axis=1)
    _, counts = np.unique(plain, return_counts=True)
    if (counts == 1).any():
        raise ValueError(f"not watertight: {int((counts == 1).sum())} edges have one side only")
    _, along = np.unique(forward, return_counts=True)
    if (counts % 2).any() or (counts > 2).any():
        raise ValueError(f"not a surface: {int((counts > 2).sum())} edges join over two triangles")
    if (along > 1).any():
        raise ValueError(
            f"badly oriented: {int((along > 1).sum())} edges have triangles facing opposite sides"
        )
