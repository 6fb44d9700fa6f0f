"""Parts drawn by parameters: stepped shafts and spur gears. All of it is our own geometry."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal.errors import ConfigError
from perception.parts.part import STEEL_KGPM3, Part, Profile

__all__ = ["CATALOGUE", "GearSize", "ShaftSize", "make_gear", "make_shaft", "parse_shaft"]

FACETS = 128
MIN_SIDE_M = 0.005
MAX_SIDE_M = 0.300


@dataclass(frozen=True)
class ShaftSize:
    """A stepped shaft: ``sections_m`` holds (diameter, length) from the -z end to the +z end."""

    sections_m: tuple[tuple[float, float], ...]
    chamfer_m: float = 0.0


@dataclass(frozen=True)
class GearSize:
    """A straight spur gear with a bore and no hub."""

    module_m: float
    teeth: int
    width_m: float
    bore_m: float
    pressure_angle_rad: float = np.pi / 9


CATALOGUE: dict[str, ShaftSize | GearSize] = {
    "shaft": ShaftSize(((0.020, 0.035), (0.028, 0.025), (0.020, 0.040))),
    "shaft-slim": ShaftSize(((0.012, 0.030), (0.018, 0.020), (0.012, 0.050)), 0.0005),
    "shaft-short": ShaftSize(((0.016, 0.015), (0.024, 0.020), (0.016, 0.025)), 0.0005),
    "shaft-stout": ShaftSize(((0.022, 0.020), (0.030, 0.030), (0.018, 0.030)), 0.001),
    "shaft-plain": ShaftSize(((0.020, 0.090),), 0.001),
    "shaft-even": ShaftSize(((0.016, 0.030), (0.024, 0.030), (0.016, 0.030)), 0.0005),
    "gear": GearSize(0.002, 28, 0.020, 0.020),
    "gear-small": GearSize(0.0015, 20, 0.012, 0.010),
}


def make_shaft(size: ShaftSize, *, name: str = "shaft", density_kgpm3: float = STEEL_KGPM3) -> Part:
    """Turn a stepped shaft: frame ``object``, origin at mid-length.

    Raises
    ------
    ConfigError
        A section is thinner, shorter or longer than can be handled, or the chamfer eats it.
    """
    diameters_m, lengths_m = np.array(size.sections_m, float).T
    _check_shaft(name, diameters_m, lengths_m, size.chamfer_m)
    z_edges_m = np.concatenate([[0.0], np.cumsum(lengths_m)]) - lengths_m.sum() / 2
    radii_m = diameters_m / 2
    r, z = np.repeat(radii_m, 2), np.repeat(z_edges_m, 2)[1:-1]
    keep = np.ones(len(r), bool)
    # Equal neighbours make one cylinder; a doubled corner would be a sliver.
    for k in np.flatnonzero(np.diff(radii_m) == 0):
        keep[2 * k + 1 : 2 * k + 3] = False
    r, z = r[keep], z[keep]
    if size.chamfer_m > 0:
        c = size.chamfer_m
        r = np.concatenate([[r[0] - c], r, [r[-1] - c]])
        z = np.concatenate([[z[0]], [z[0] + c], z[1:-1], [z[-1] - c], [z[-1]]])
    outline = np.column_stack([r, z])
    vertices_m, triangles = _revolve(outline)
    sections = list(size.sections_m)
    return Part(
        name=name,
        vertices_m=vertices_m,
        triangles=triangles,
        fold=0,
        is_reversible=sections == sections[::-1],
        profile=Profile(z_edges_m, radii_m),
        density_kgpm3=density_kgpm3,
    )


def _check_shaft(
    name: str, diameters_m: NDArray[np.float64], lengths_m: NDArray[np.float64], chamfer_m: float
) -> None:
    if len(diameters_m) > 20:
        raise ConfigError(f"{len(diameters_m)} sections; at most 20", source=name)
    if diameters_m.min() < 0.002 or lengths_m.min() < 0.001:
        raise ConfigError("a section needs a diameter >= 2 mm and a length >= 1 mm", source=name)
    largest = max(float(lengths_m.sum()), float(diameters_m.max()))
    if not MIN_SIDE_M <= largest <= MAX_SIDE_M:
        raise ConfigError(f"largest side {largest * 1e3:g} mm is not in 5..300 mm", source=name)
    ends = min(diameters_m[0] / 2, diameters_m[-1] / 2, lengths_m[0], lengths_m[-1])
    if len(lengths_m) == 1:
        ends = min(ends, lengths_m[0] / 2)
    if not 0 <= chamfer_m < ends:
        raise ConfigError(f"a chamfer of {chamfer_m * 1e3:g} mm does not fit", source=name)


def parse_shaft(text: str, *, density_kgpm3: float = STEEL_KGPM3) -> Part:
    """Read ``shaft:20x35,28x25,20x40``: diameter x length of each section, millimetres.

    Raises
    ------
    ConfigError
        It does not read like that, or such a shaft cannot be handled.
    """
    sections: list[tuple[float, float]] = []
    for item in text.removeprefix("shaft:").split(","):
        try:
            diameter, length = (float(number) / 1000 for number in item.lower().split("x"))
        except ValueError:
            raise ConfigError(
                f"cannot read {item!r}; sections are diameter x length in millimetres, "
                "such as shaft:20x35,28x25,20x40",
                source=text,
            ) from None
        if not np.isfinite([diameter, length]).all():
            raise ConfigError(f"{item!r} is not finite", source=text)
        sections.append((diameter, length))
    return make_shaft(ShaftSize(tuple(sections)), name=text, density_kgpm3=density_kgpm3)


def make_gear(size: GearSize, *, name: str = "gear", density_kgpm3: float = STEEL_KGPM3) -> Part:
    """Draw a spur gear with involute flanks; a tooth is centred on the object's x axis.

    Raises
    ------
    ConfigError
        The bore cuts the teeth, or the gear is too small or too large.
    """
    outline = _tooth_ring(size)
    root_m = float(np.hypot(outline[:, 0], outline[:, 1]).min())
    if not 0.001 <= size.bore_m / 2 <= root_m - 0.0005:
        raise ConfigError(f"bore {size.bore_m * 1e3:g} mm does not fit", source=name)
    largest = max(2 * float(np.hypot(outline[:, 0], outline[:, 1]).max()), size.width_m)
    if not MIN_SIDE_M <= largest <= MAX_SIDE_M or size.width_m < 0.001:
        raise ConfigError(f"largest side {largest * 1e3:g} mm is not in 5..300 mm", source=name)
    bore = outline * (size.bore_m / 2 / np.hypot(outline[:, 0], outline[:, 1]))[:, None]
    h = size.width_m / 2
    rings = [
        np.column_stack([ring, np.full(len(ring), z)])
        for ring, z in ((outline, h), (bore, h), (bore, -h), (outline, -h))
    ]
    triangles = np.concatenate(
        [_strip(k * len(outline), ((k + 1) % 4) * len(outline), len(outline)) for k in range(4)]
    )
    return Part(
        name=name,
        vertices_m=np.concatenate(rings),
        triangles=triangles,
        fold=size.teeth,
        is_reversible=True,
        profile=Profile(
            np.array([-h, h]), np.array([np.hypot(outline[:, 0], outline[:, 1]).max()])
        ),
        density_kgpm3=density_kgpm3,
    )


def _tooth_ring(size: GearSize) -> NDArray[np.float64]:
    """Return the closed outline of all teeth, shape (N, 2), counter-clockwise, metres."""
    if not 6 <= size.teeth <= 200:
        raise ConfigError(f"{size.teeth} teeth; 6..200 can be drawn", source="gear")
    pitch = size.module_m * size.teeth / 2
    base = pitch * np.cos(size.pressure_angle_rad)
    tip, root = pitch + size.module_m, pitch - 1.25 * size.module_m
    radii = np.linspace(max(base, root), tip, 8)
    # Half the tooth's angle at radius r: half a pitch at the pitch circle, less the involutes.
    involute = np.tan(np.arccos(base / radii)) - np.arccos(base / radii)
    at_pitch = np.tan(size.pressure_angle_rad) - size.pressure_angle_rad
    half = np.maximum(np.pi / (2 * size.teeth) + at_pitch - involute, 0.05 / size.teeth)
    gap = np.pi / size.teeth
    foot = min(float(half[0]) + 0.05 * gap, 0.9 * gap)
    angles = np.concatenate([[-gap], [-foot], -half, [0.0], half[::-1], [foot]])
    r = np.concatenate([[root], [root], radii, [tip], radii[::-1], [root]])
    turns = 2 * gap * np.arange(size.teeth)
    theta = (turns[:, None] + angles).ravel()
    r = np.tile(r, size.teeth)
    return np.column_stack([r * np.cos(theta), r * np.sin(theta)])


def _revolve(
    outline_m: NDArray[np.float64], facets: int = FACETS
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Turn an open outline of (radius, z), z rising, and close it with a fan at each end."""
    theta = 2 * np.pi * np.arange(facets) / facets
    circle = np.column_stack([np.cos(theta), np.sin(theta)])
    rings = [
        np.column_stack([radius * circle, np.full(facets, z)]) for radius, z in outline_m.tolist()
    ]
    poles = [[0.0, 0.0, outline_m[0, 1]], [0.0, 0.0, outline_m[-1, 1]]]
    count = len(rings) * facets
    strips = [_strip(k * facets, (k + 1) * facets, facets) for k in range(len(rings) - 1)]
    index = np.arange(facets, dtype=np.int32)
    following = (index + 1) % facets
    bottom = np.column_stack([np.full(facets, count), following, index])
    last = count - facets
    top = np.column_stack([np.full(facets, count + 1), last + index, last + following])
    triangles: Sequence[NDArray[np.integer]] = [*strips, bottom, top]
    return np.concatenate([*rings, poles]), np.concatenate(triangles).astype(np.int32)


def _strip(first: int, second: int, count: int) -> NDArray[np.int32]:
    """Join two closed rings of ``count`` vertices; outward when the second lies above."""
    index = np.arange(count, dtype=np.int32)
    following = (index + 1) % count
    a, b, c, d = first + index, first + following, second + index, second + following
    return np.concatenate([np.column_stack([a, b, d]), np.column_stack([a, d, c])])
