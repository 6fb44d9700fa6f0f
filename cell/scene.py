"""What the cell knows of the bin after one look."""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hal import Transform

__all__ = ["Eyes", "Scene"]


@dataclass(frozen=True, eq=False)
class Scene:
    """Parts found, in the base frame, and what is there besides.

    ``objects`` are ``T_base_object``, the surest first. ``clutter_m`` (K, 3), frame base,
    are centres of small boxes where something is that no found part explains.
    """

    number: int
    objects: tuple[Transform, ...]
    confidences: tuple[float, ...]
    clutter_m: NDArray[np.float64]
    is_empty: bool
    digest: str = ""
    notes: dict[str, object] = field(default_factory=dict)


class Eyes(Protocol):
    """Whoever can look into the bin and say what is there."""

    async def look(self) -> Scene:
        """Capture, find the parts, take them to the base frame.

        Raises
        ------
        PerceptionError
            The images cannot be used.
        DeviceError
            The camera failed.
        """
        ...
