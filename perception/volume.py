"""The space that is looked at: a box in the base frame, such as the inside of a bin."""

from dataclasses import dataclass
from itertools import product
from typing import Self

import numpy as np
from numpy.typing import NDArray

from hal import Bin, Transform

__all__ = ["Volume"]


@dataclass(frozen=True)
class Volume:
    """A box with sides along its own frame ``bin``, from ``low_m`` to ``high_m``."""

    T_base_bin: Transform
    low_m: tuple[float, float, float]
    high_m: tuple[float, float, float]

    def __post_init__(self) -> None:
        if not all(low < high for low, high in zip(self.low_m, self.high_m, strict=True)):
            raise ValueError(f"not a box: {self.low_m} to {self.high_m}")

    @classmethod
    def of_bin(
        cls,
        bin_: Bin,
        *,
        margin_m: float = 0.01,
        below_m: float = 0.012,
        above_m: float = 0.0,
    ) -> Self:
        """Return a bin's inside with a margin: sideways, under the floor, over the rim."""
        x, y, z = bin_.size_m
        return cls(
            bin_.T_base_bin,
            (-x / 2 - margin_m, -y / 2 - margin_m, -below_m),
            (x / 2 + margin_m, y / 2 + margin_m, z + above_m),
        )

    def corners_base(self) -> NDArray[np.float64]:
        """The eight corners, (8, 3), metres, base frame."""
        corners = np.array(list(product(*zip(self.low_m, self.high_m, strict=True))))
        return self.T_base_bin.apply(corners)
