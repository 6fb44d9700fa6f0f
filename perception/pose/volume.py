"""Where parts may be: the inside of the bin, seen from the camera."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal import Bin, Transform
from hal.errors import FrameMismatchError
from perception.view import DepthView

__all__ = ["BinVolume", "Window"]


@dataclass(frozen=True)
class Window:
    """A block of an image: rows ``top`` .. ``bottom``, columns ``left`` .. ``right``, ends out."""

    top: int
    bottom: int
    left: int
    right: int

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns, to index an image with."""
        return slice(self.top, self.bottom), slice(self.left, self.right)

    def around(self, mask: NDArray[np.bool_], margin_px: int) -> "Window | None":
        """Return the part of this window about what ``mask`` (its size) sets; None if nothing."""
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        if not len(rows):
            return None
        return Window(
            self.top + max(int(rows[0]) - margin_px, 0),
            min(self.top + int(rows[-1]) + margin_px + 1, self.bottom),
            self.left + max(int(columns[0]) - margin_px, 0),
            min(self.left + int(columns[-1]) + margin_px + 1, self.right),
        )


@dataclass(frozen=True)
class BinVolume:
    """The space that is searched: a box on the bin's floor.

    ``T_camera_bin`` is the pose of frame ``bin`` (middle of the inner floor, z up) in the
    rectified left camera; ``size_m`` is the inner length, width and height. Parts may stand out
    of the bin by ``headroom_m``. Points lower than ``floor_m`` above the floor, or closer than
    ``wall_m`` to a wall, belong to the bin.
    """

    T_camera_bin: Transform
    size_m: tuple[float, float, float]
    headroom_m: float = 0.06
    floor_m: float = 0.0025
    wall_m: float = 0.0020

    def __post_init__(self) -> None:
        if (self.T_camera_bin.parent, self.T_camera_bin.child) != ("camera", "bin"):
            raise FrameMismatchError(
                f"a bin volume needs T_camera_bin, not T_{self.T_camera_bin.parent}_"
                f"{self.T_camera_bin.child}"
            )
        if min(self.size_m) <= 0:
            raise ValueError(f"a bin of size {self.size_m}")

    @classmethod
    def of(cls, box: Bin, T_camera_bin: Transform) -> "BinVolume":
        """The inside of ``box``."""
        return cls(T_camera_bin, box.size_m)

    def window(self, view: DepthView) -> Window | None:
        """Return the block of the image that can show the volume; None when it is out of view."""
        length, width, height = self.size_m
        corners = np.array(
            [
                (x * length / 2, y * width / 2, z)
                for x in (-1, 1)
                for y in (-1, 1)
                for z in (0.0, height + self.headroom_m)
            ]
        )
        points = self.T_camera_bin.apply(corners)
        if points[:, 2].min() < 0.05:
            points = points[points[:, 2] >= 0.05]
        if not len(points):
            return None
        u = points[:, 0] / points[:, 2] * view.focal_px + view.centre_x_px
        v = points[:, 1] / points[:, 2] * view.focal_px + view.centre_y_px
        rows, columns = view.depth_m.shape
        window = Window(
            max(int(v.min()) - 2, 0),
            min(int(v.max()) + 3, rows),
            max(int(u.min()) - 2, 0),
            min(int(u.max()) + 3, columns),
        )
        is_empty = window.top >= window.bottom or window.left >= window.right
        return None if is_empty else window

    def overshoot_m(self, points_m: NDArray[np.float64]) -> float:
        """Return how far points (N, 3), frame ``camera``, reach into floor or walls; 0 for none."""
        off = points_m - self.T_camera_bin.translation_m
        x, y, z = np.einsum("ni,ij->jn", off, self.T_camera_bin.rotation)
        length, width, height = self.size_m
        beside = np.maximum(np.abs(x) - length / 2, np.abs(y) - width / 2)
        return max(float(np.where(z < height, beside, 0).max()), float(-z.min()), 0.0)

    def contains(self, points_m: NDArray[np.floating]) -> NDArray[np.bool_]:
        """Return which points (..., 3), frame ``camera``, lie inside, off the floor and walls.

        NaN points do not.
        """
        rotation = self.T_camera_bin.rotation.astype(points_m.dtype)
        offset = self.T_camera_bin.translation_m.astype(points_m.dtype)
        x, y, z = (
            (points_m[..., 0] - offset[0]) * rotation[0, k]
            + (points_m[..., 1] - offset[1]) * rotation[1, k]
            + (points_m[..., 2] - offset[2]) * rotation[2, k]
            for k in range(3)
        )
        length, width, height = self.size_m
        return np.asarray(
            (np.abs(x) < length / 2 - self.wall_m)
            & (np.abs(y) < width / 2 - self.wall_m)
            & (z > self.floor_m)
            & (z < height + self.headroom_m)
        )
