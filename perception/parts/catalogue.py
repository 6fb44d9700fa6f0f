"""From what a user writes to a part: a name, a shaft in text form, or a mesh file."""

from pathlib import Path
from typing import Literal

from hal.errors import ConfigError
from perception.parts.cad import CATALOGUE, ShaftSize, make_gear, make_shaft, parse_shaft
from perception.parts.mesh import MESH_SUFFIXES, load_mesh
from perception.parts.part import STEEL_KGPM3, Part

__all__ = ["load_part"]


def load_part(
    spec: str, *, unit: Literal["mm", "m"] = "mm", density_kgpm3: float = STEEL_KGPM3
) -> Part:
    """Return the part named ``spec``.

    Parameters
    ----------
    spec
        A catalogue name (``shaft``), a shaft as text (``shaft:20x35,28x25,20x40``, diameter x
        length in millimetres), or the path of an STL, PLY or OBJ file.
    unit
        The unit of a mesh file; the other two forms carry their own.
    density_kgpm3
        Of the material; steel unless said.

    Raises
    ------
    ConfigError
        There is no such part, or the mesh cannot be used; the message says why.

    Examples
    --------
    >>> load_part("shaft:20x35,28x25,20x40").profile.radii_m.tolist()
    [0.01, 0.014, 0.01]
    """
    size = CATALOGUE.get(spec)
    if isinstance(size, ShaftSize):
        return make_shaft(size, name=spec, density_kgpm3=density_kgpm3)
    if size is not None:
        return make_gear(size, name=spec, density_kgpm3=density_kgpm3)
    if spec.startswith("shaft:"):
        return parse_shaft(spec, density_kgpm3=density_kgpm3)
    path = Path(spec)
    if path.suffix.lower() in MESH_SUFFIXES or path.is_file():
        return load_mesh(path, unit=unit, density_kgpm3=density_kgpm3)
    raise ConfigError(
        f"no such part; known are {', '.join(CATALOGUE)}, a text such as "
        "shaft:20x35,28x25,20x40, or a .stl, .ply or .obj file",
        source=spec or "part",
    )
