"""The truth, for tests, benches and the score; no device and no perception may ask."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hal import Transform
from sims.world.lock import Grip, LockEvent
from sims.world.world import World

__all__ = ["Place", "PlacingError", "Referee"]

ABOVE_TRAY_M = 0.10
BESIDE_M = 0.01


class Place(StrEnum):
    """Where a part is."""

    BIN = "bin"
    GRIPPER = "gripper"
    TRAY = "tray"
    PARKED = "parked"
    LOST = "lost"


@dataclass(frozen=True)
class PlacingError:
    """How far a part lies from where it should: between origins, and between axes."""

    distance_m: float
    axis_rad: float


class Referee:
    """Looks at the world and changes nothing."""

    def __init__(self, world: World) -> None:
        self._world = world

    def pose(self, part: int) -> Transform:
        """Return ``T_base_object``."""
        return self._world.part_pose(part)

    def between_fingers(self) -> Grip | None:
        """What both fingers press, if it is one and the same part."""
        return self._world.lock.grip()

    @property
    def held(self) -> int | None:
        """The part that friction, and so the lock, holds."""
        return self._world.lock.part

    @property
    def lock_events(self) -> tuple[LockEvent, ...]:
        """Every closing and opening of the lock so far."""
        return tuple(self._world.lock.events)

    def place(self, part: int) -> Place:
        """Say where a part is; the gripper goes first."""
        world = self._world
        if world.is_parked(part):
            return Place.PARKED
        if self.held == part:
            return Place.GRIPPER
        pose = world.part_pose(part)
        box, tray = world.layout.bin, world.layout.tray
        at = box.T_base_bin.inverse().apply(pose.translation_m)
        half = np.array(box.size_m[:2]) / 2 + BESIDE_M
        if (np.abs(at[:2]) <= half).all() and -BESIDE_M < at[2] < box.size_m[2] + ABOVE_TRAY_M:
            return Place.BIN
        at = tray.T_base_tray.inverse().apply(pose.translation_m)
        half = np.array(tray.size_m) / 2
        if (np.abs(at[:2]) <= half).all() and 0 < at[2] < ABOVE_TRAY_M:
            return Place.TRAY
        return Place.LOST

    def parts_in(self, place: Place) -> tuple[int, ...]:
        """All parts that are there."""
        return tuple(k for k in range(self._world.parts) if self.place(k) is place)

    def placing_error(self, part: int, T_base_object: Transform) -> PlacingError:
        """Compare a part with where it should lie; roll about its axis does not count."""
        pose = self._world.part_pose(part)
        distance = np.linalg.norm(pose.translation_m - T_base_object.translation_m)
        cosine = abs(float(pose.rotation[:, 2] @ T_base_object.rotation[:, 2]))
        return PlacingError(float(distance), float(np.arccos(min(1.0, cosine))))
