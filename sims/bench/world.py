"""``world.*``: how fast, how exact and how honest the simulated world is."""

import time
from collections.abc import Sequence

import mujoco
import numpy as np

from hal import Figure
from perception.parts import Part
from sims.bench.grasp import GraspTrial, GraspTrialResult, drive
from sims.world import PartShape, World, cylinders, fill

__all__ = ["run", "shape_of"]

OVER_THE_BIN = ((0.25, 0.0, 0.0, 0.3, 1.4, 0.8), (-0.25, 0.0, 0.0, -0.3, 1.4, -0.8))
MOVES = 12
FORCES_N = (70.0, 80.0, 100.0)


def run(*, seeds: Sequence[int], part: Part, count: int) -> list[Figure]:
    """Piles of ``count`` parts for each seed, full-speed moves, one grasp under the glass.

    Times on the wall are this machine's; everything else repeats to the bit. Grasp figures
    are of ``part``, or of the standard shaft if ``part`` is too thick for the fingers.
    """
    shape = shape_of(part)
    return [*_pile_figures(seeds, shape, count), _tracking(seeds), *_grasp_figures(shape)]


def shape_of(part: Part) -> PartShape:
    """Return a part's outline as cylinders."""
    return cylinders(part.profile.z_edges_m, part.profile.radii_m, part.density_kgpm3)


def _pile_figures(seeds: Sequence[int], shape: PartShape, count: int) -> list[Figure]:
    factors, settles_s, walls_s, awake, retries = [], [], [], [], []
    for seed in seeds:
        world = World(shape=shape, parts=count)
        began_s = time.perf_counter()
        report = fill(world, seed=seed)
        walls_s.append(time.perf_counter() - began_s)
        settles_s.append(report.settle_s)
        awake.append(float(report.awake))
        retries.append(float(report.attempt))
        factors.append(_realtime_factor(world))
    return [
        Figure.median("world.realtime_factor", factors, "1"),
        Figure.median("world.settle_s", settles_s, "s"),
        Figure.median("world.settle_wall_s", walls_s, "s"),
        Figure("world.awake_after_settling", sum(awake), "1", len(awake), min(awake), max(awake)),
        Figure("world.drops_repeated", sum(retries), "1", len(retries), min(retries), max(retries)),
    ]


def _realtime_factor(world: World) -> float:
    """Virtual over wall time, the arm driving at full speed over a sleeping pile."""
    began, began_s = world.ticks, time.perf_counter()
    for k in range(6):
        drive(world, OVER_THE_BIN[k % 2])
    virtual_s = (world.ticks - began) * world.physics.tick_s
    return virtual_s / (time.perf_counter() - began_s)


def _tracking(seeds: Sequence[int]) -> Figure:
    """The largest distance of the tool from its path, over moves through the joint ranges."""
    peaks = []
    for seed in seeds:
        world = World()
        # The moves go through everything there is.
        world.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        rng = np.random.default_rng([seed, 12])
        limits = world.arm_model.limits
        for _ in range(MOVES):
            joints = rng.uniform(limits.lower_rad, limits.upper_rad) * 0.7
            peaks.append(drive(world, tuple(float(q) for q in joints)))
    return Figure("world.tracking_peak", max(peaks), "m", len(peaks), min(peaks), max(peaks))


def _grasp_figures(shape: PartShape) -> list[Figure]:
    if shape.radius_m > 0.016:
        shape = cylinders([-0.05, -0.015, 0.010, 0.05], [0.010, 0.014, 0.010])
    trials = [GraspTrial(shape, force_n=force_n).run() for force_n in FORCES_N]
    usual = trials[FORCES_N.index(80.0)]
    oily = GraspTrial(shape).with_friction(0.05).run()
    slippery = GraspTrial(shape).with_friction(0.03).run()
    unlocked = GraspTrial(shape, has_lock=False).run()
    single = GraspTrial(shape, has_both_fingers=False).run()
    size_m = 2 * shape.radius_m
    errors_m = [abs((trial.size_m or 0.0) - size_m) for trial in trials]
    return [
        Figure("world.grasp_size_error", max(errors_m), "m", 3, min(errors_m), max(errors_m)),
        Figure("world.grasp_hold_force", usual.hold_force_n, "N"),
        Figure("world.grasp_slip_static", usual.slip_static_m, "m"),
        Figure("world.grasp_slip_moving", usual.slip_moving_m, "m"),
        Figure("world.grasp_slip_static_unlocked", unlocked.slip_static_m, "m"),
        Figure("world.grasp_slip_moving_unlocked", unlocked.slip_moving_m, "m"),
        Figure("world.grasp_friction_use", usual.use_peak, "1"),
        Figure("world.grasp_friction_use_oily", oily.use_peak, "1"),
        Figure("world.grasp_held_slippery", float(_counts_as_held(slippery)), "1"),
        Figure("world.grasp_held_one_finger", float(_counts_as_held(single)), "1"),
    ]


def _counts_as_held(result: GraspTrialResult) -> bool:
    return result.is_held and result.size_m is not None
