"""Parts: what can be picked, drawn by parameters or read from a mesh file."""

from perception.parts.cad import CATALOGUE, GearSize, ShaftSize, make_gear, make_shaft
from perception.parts.catalogue import load_part
from perception.parts.part import STEEL_KGPM3, Part, Profile

__all__ = [
    "CATALOGUE",
    "STEEL_KGPM3",
    "GearSize",
    "Part",
    "Profile",
    "ShaftSize",
    "load_part",
    "make_gear",
    "make_shaft",
]
