"""Where parts are laid down: a grid of slots on the tray."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cell.grasp import GraspKind
from hal import Fingers, Transform, Tray, rotation_from_rotvec
from perception.parts import Part

__all__ = ["NextSlot", "Slots"]

GAP_ALONG_M = 0.015
NEIGHBOUR_GAP_M = 0.004
DROP_M = 0.0005
EDGE_M = 0.005


@dataclass(frozen=True)
class Slots:
    """Slot centres in the tray frame, filled away from the robot's approach side first."""

    positions_m: tuple[tuple[float, float], ...]

    @classmethod
    def grid(cls, tray: Tray, part: Part, fingers: Fingers, *, release_margin_m: float) -> "Slots":
        """As many as fit: parts lie along tray x, room for one finger between neighbours."""
        pitch_along_m = part.length_m + GAP_ALONG_M
        half_m = part.max_radius_m
        pitch_across_m = (
            2 * half_m + release_margin_m / 2 + fingers.thickness_m + 2 * NEIGHBOUR_GAP_M
        )
        counts = (
            int((tray.size_m[0] - 2 * EDGE_M + GAP_ALONG_M) // pitch_along_m),
            int((tray.size_m[1] - 2 * EDGE_M + pitch_across_m - 2 * half_m) // pitch_across_m),
        )
        x = (np.arange(counts[0]) - (counts[0] - 1) / 2) * pitch_along_m
        y = (np.arange(counts[1]) - (counts[1] - 1) / 2) * pitch_across_m
        return cls(tuple((float(a), float(b)) for b in y for a in x))

    def __len__(self) -> int:
        return len(self.positions_m)


@dataclass(frozen=True, eq=False)
class NextSlot:
    """The slot that the next part goes to."""

    index: int
    position_m: tuple[float, float]
    part: Part
    tray: Tray

    def poses(self, T_tcp_object: Transform, kind: str) -> Iterator[tuple[Transform, Transform]]:
        """Ways to lay the held part down: pairs ``T_base_tcp``, ``T_base_object``.

        The tool pose lets go half a millimetre above the pose in which the part comes to rest.

        A part held across lies along tray x, rolled so that the tool comes from above; a part
        held by its end is stood up. Both senses of the axis are offered.
        """
        approach = T_tcp_object.inverse().rotation[:, 2]  # tool z in the object frame
        for rotation, height_m in _orientations(approach, self.part, kind):
            resting, over = (
                self.tray.T_base_tray
                @ Transform.from_parts("tray", "object", rotation, (*self.position_m, z_m))
                for z_m in (height_m, height_m + DROP_M)
            )
            yield over @ T_tcp_object.inverse(), resting


def _orientations(
    approach: NDArray[np.float64], part: Part, kind: str
) -> Iterator[tuple[NDArray[np.float64], float]]:
    if kind == GraspKind.END:
        upright = np.diag([1.0, 1.0, 1.0]) if approach[2] < 0 else np.diag([1.0, -1.0, -1.0])
        for turn_rad in np.arange(8) * np.pi / 4:
            yield rotation_from_rotvec((0, 0, turn_rad)) @ upright, part.length_m / 2
        return
    down = np.array([approach[0], approach[1], 0.0])
    down /= np.linalg.norm(down)
    for axis in (np.array([1.0, 0, 0]), np.array([-1.0, 0, 0])):
        # Columns of the target are object axes; the source's are (down, z x down, z) of the object.
        source = np.column_stack([down, np.cross((0, 0, 1.0), down), (0, 0, 1.0)])
        target = np.column_stack([(0, 0, -1.0), np.cross(axis, (0, 0, -1.0)), axis])
        yield target @ source.T, part.max_radius_m
