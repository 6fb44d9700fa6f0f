"""Seeded piles: parts drop into the bin between guides and come to rest."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal import Bin, Transform
from hal.errors import ConfigError
from sims.world.errors import PileError
from sims.world.shapes import PartShape
from sims.world.world import World

__all__ = ["PileReport", "check_fit", "fill"]

ATTEMPTS = 5
SETTLE_CAP_S = 6.0
FALL_SPEED_MPS = 1.5
AFTER_GUIDES_S = 0.4
MOST_FILLED = 0.45
CLEARANCE_M = 0.010
REST_SPEED_MPS = 0.02


@dataclass(frozen=True)
class PileReport:
    """How the filling went: ``attempt`` counts from 0; ``awake`` parts never quite slept."""

    seed: int
    attempt: int
    settle_s: float
    awake: int
    highest_m: float


def check_fit(shape: PartShape, parts: int, box: Bin) -> None:
    """Refuse parts that cannot lie in the bin.

    Raises
    ------
    ConfigError
        One part is larger than the bin, or all together are.
    """
    across_m = max(shape.length_m, 2 * shape.radius_m)
    longest, shorter = max(box.size_m[:2]), min(box.size_m[:2])
    if across_m > longest - CLEARANCE_M or 2 * shape.radius_m > shorter - CLEARANCE_M:
        raise ConfigError(
            f"a part of {shape.length_m:.3f} x {2 * shape.radius_m:.3f} m does not fit the bin of "
            f"{box.size_m[0]:.3f} x {box.size_m[1]:.3f} m",
            source="bin",
        )
    room = float(np.prod(box.size_m)) * MOST_FILLED
    if parts * shape.hull_volume_m3 > room:
        most = int(room / shape.hull_volume_m3)
        raise ConfigError(
            f"{parts} parts of {shape.hull_volume_m3:.2e} m3 overfill the bin; at most {most}",
            source="bin",
        )


def fill(world: World, *, seed: int, count: int | None = None) -> PileReport:
    """Drop ``count`` parts (default: all of them) and wait until they rest.

    A part that ends outside the bin, above its rim or below its floor makes the whole drop
    start again with the next sub-seed.

    Raises
    ------
    ConfigError
        The parts cannot fit.
    PileError
        They did not come to rest in the bin in five attempts.
    """
    count = world.parts if count is None else count
    if not 0 <= count <= world.parts:
        raise ValueError(f"{count} parts asked for, the world has {world.parts}")
    if count == 0 or world.shape is None:
        return PileReport(seed, 0, 0.0, 0, 0.0)
    check_fit(world.shape, count, world.layout.bin)
    joints_rad = world.arm.target_rad.copy()
    world.arm.jump_to(_aside(world, joints_rad))
    try:
        return _drop_until_good(world, world.shape, count, seed)
    finally:
        world.arm.jump_to(joints_rad)
        world.refresh()


def _aside(world: World, joints_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same posture turned away from the bin, over which parts are about to fall."""
    x, y, _ = world.layout.bin.T_base_bin.translation_m
    away = float(np.arctan2(y, x)) + np.pi
    aside = joints_rad.copy()
    limits = world.arm_model.limits
    aside[0] = np.clip(
        (away + np.pi) % (2 * np.pi) - np.pi, limits.lower_rad[0], limits.upper_rad[0]
    )
    return aside


def _drop_until_good(world: World, shape: PartShape, count: int, seed: int) -> PileReport:
    problem = ""
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, attempt])
        began = world.ticks
        _drop(world, shape, count, rng)
        settle_s = (world.ticks - began) * world.physics.tick_s
        problem = _stray(world, count)
        if not problem:
            awake, highest = _awake(world, count), _highest_m(world, count)
            return PileReport(seed, attempt, settle_s, awake, highest)
    raise PileError(f"{count} parts, seed {seed}: {problem} in each of {ATTEMPTS} drops")


def _drop(world: World, shape: PartShape, count: int, rng: np.random.Generator) -> None:
    for k in range(world.parts):
        world.park(k)
    for k, pose in enumerate(_start_poses(world.layout.bin, shape, count, rng)):
        world.put_part(k, pose)
    world.set_guides(is_solid=True)
    # Drag limits the fall, so that thin parts cannot pass through each other.
    _set_damping(world, count, shape.mass_kg * 9.81 / FALL_SPEED_MPS)
    _settle(world, count, is_falling=True)
    _set_damping(world, count, world.physics.free_damping(shape.inertia))
    _settle(world, count)
    world.set_guides(is_solid=False)
    world.step_for(AFTER_GUIDES_S)
    _settle(world, count)


def _start_poses(
    box: Bin, shape: PartShape, count: int, rng: np.random.Generator
) -> list[Transform]:
    """Layers of a jittered grid over the bin, turned at random."""
    reach = shape.reach_m
    pitch = 2 * reach + 0.010
    columns = [max(1, int((side - 0.010) // pitch)) for side in box.size_m[:2]]
    poses = []
    for k in range(count):
        layer, place = divmod(k, columns[0] * columns[1])
        row, column = divmod(place, columns[0])
        at = [
            (index / (n - 1) - 0.5) * (side - 2 * reach - CLEARANCE_M) if n > 1 else 0.0
            for index, n, side in zip((column, row), columns, box.size_m, strict=False)
        ]
        centre = np.array([*at, reach + 0.020 + layer * pitch])
        centre[:2] += rng.uniform(-0.003, 0.003, 2)
        quaternion = rng.normal(size=4)
        # A part longer than the bin is wide must start lying along it.
        if 2 * reach > min(box.size_m[:2]) - 2 * CLEARANCE_M:
            quaternion = _along_the_bin(box, rng)
        poses.append(
            box.T_base_bin @ Transform.from_quaternion("bin", "object", quaternion, centre)
        )
    return poses


def _along_the_bin(box: Bin, rng: np.random.Generator) -> NDArray[np.float64]:
    """Object z along the longer side of the bin, rolled and reversed at random."""
    roll = rng.uniform(-np.pi, np.pi)
    half = np.sqrt(0.5) * (1 if rng.random() < 0.5 else -1)
    c, s = np.cos(roll / 2), np.sin(roll / 2)
    if box.size_m[0] >= box.size_m[1]:
        return np.array([np.sqrt(0.5) * c, -half * s, half * c, np.sqrt(0.5) * s])
    return np.array([np.sqrt(0.5) * c, half * c, half * s, np.sqrt(0.5) * s])


def _set_damping(world: World, count: int, damping: float) -> None:
    for k in range(count):
        first = world.dof_address(k)
        world.model.dof_damping[first : first + 3] = damping


def _settle(world: World, count: int, *, is_falling: bool = False) -> None:
    """Step until all sleep; when falling, until all are slow and low."""
    rim = world.layout.bin.T_base_bin.translation_m[2] + world.layout.bin.size_m[2]
    for _ in range(round(SETTLE_CAP_S / 0.05)):
        world.step_for(0.05)
        if is_falling:
            if _highest_m(world, count) < rim and _fastest_mps(world, count) < 0.1:
                return
        elif _awake(world, count) == 0:
            return


def _awake(world: World, count: int) -> int:
    return sum(world.is_awake(k) for k in range(count))


def _highest_m(world: World, count: int) -> float:
    return max(float(world.part_pose(k).translation_m[2]) for k in range(count))


def _fastest_mps(world: World, count: int) -> float:
    return max(world.part_speed(k)[0] for k in range(count))


def _stray(world: World, count: int) -> str:
    """Name the first part that is not at rest inside the bin, or nothing."""
    box = world.layout.bin
    T_bin_base = box.T_base_bin.inverse()
    half = np.array(box.size_m[:2]) / 2
    for k in range(count):
        place = (T_bin_base @ world.part_pose(k)).translation_m
        if (np.abs(place[:2]) > half).any():
            return f"part {k} lies outside the bin"
        if place[2] < 0:
            return f"part {k} fell through the floor"
        if place[2] > box.size_m[2]:
            return f"part {k} stands {place[2]:.3f} m over the bin's floor, above the rim"
        if world.part_speed(k)[0] > REST_SPEED_MPS:
            return f"part {k} still moves at {world.part_speed(k)[0]:.3f} m/s"
    return ""
