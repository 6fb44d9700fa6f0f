"""What each choice of the physics setting does; ``python -m sims.bench.settings``.

The evidence of decision 0002: the chosen setting, and it with one thing changed at a time.
Piles are of 20 standard shafts; grasps are of the standard shaft at 80 N, sizes of bars of
7 g, 0.25 kg and 0.63 kg. Times are CPU times of this machine.
"""

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sims.bench.grasp import GraspTrial
from sims.world import Physics, SimulationError, World, cylinders, fill
from sims.world.settings import FingerServo

__all__ = ["VARIANTS", "Variant", "measure"]

SHAFT = cylinders([-0.05, -0.015, 0.010, 0.05], [0.010, 0.014, 0.010])
BARS = tuple(
    cylinders([-half, half], [radius])
    for half, radius in ((0.015, 0.003), (0.05, 0.010), (0.05, 0.016))
)
PARTS = 20


@dataclass(frozen=True)
class Variant:
    """A name, a setting, and what else is done to a new world."""

    name: str
    physics: Physics = field(default_factory=Physics)
    prepare: Callable[[World], None] | None = None


def _stiff_pads(world: World) -> None:
    for name in ("finger_left", "finger_right"):
        world.model.geom_solimp[world.model.geom(name).id, :3] = (0.99, 0.999, 0.0005)


def _damp_in_engine(world: World) -> None:
    """Give the servo's velocity gain to the joints, which are integrated implicitly."""
    gains = np.array([axis.velocity_gain for axis in world.arm_model.axes])
    world.model.dof_damping[:6] = gains
    world.arm.velocity_gains = np.zeros(6)
    plain = world.arm.apply

    def apply() -> None:
        plain()
        world.arm.controls[:, 2] += gains * world.arm.velocity_radps

    world.arm.apply = apply  # type: ignore[method-assign]


DEFAULT = Physics()
FAST_TICKS = replace(DEFAULT, tick_ns=1_000_000)
VARIANTS = (
    Variant("chosen"),
    Variant("impratio 1", replace(DEFAULT, impratio=1.0)),
    Variant("impratio 100", replace(DEFAULT, impratio=100.0)),
    Variant("impratio 100, noslip 3", replace(DEFAULT, impratio=100.0, noslip_iterations=3)),
    Variant("tick 1 ms", FAST_TICKS),
    Variant("pads .99 .999 .0005", prepare=_stiff_pads),
    Variant("servo damping in engine", prepare=_damp_in_engine),
    Variant("finger kp 2e5 kv 150", replace(DEFAULT, fingers=FingerServo(2e5, 150.0))),
    Variant("sleep at 1e-3", replace(DEFAULT, sleep_tolerance=1e-3)),
    Variant("CG", replace(DEFAULT, newton_up_to=0)),
)


def measure(variant: Variant, seeds: Sequence[int]) -> str:
    """Return one row of the table."""
    trial = GraspTrial(SHAFT, variant.physics, prepare=variant.prepare)
    free, locked = replace(trial, has_lock=False).run(), trial.run()
    sizes = [replace(trial, shape=bar).run().size_m for bar in BARS]
    errors_um = [
        f"{((size or 0) - 2 * bar.radius_m) * 1e6:+.0f}"
        for size, bar in zip(sizes, BARS, strict=True)
    ]
    return (
        f"| {variant.name} | {free.slip_static_m * 1e6:.1f} | {free.slip_moving_m * 1e3:.2f} | "
        f"{locked.slip_moving_m * 1e3:.3f} | {locked.slides} | {' '.join(errors_um)} | "
        f"{_pile(variant, seeds)} |"
    )


def _pile(variant: Variant, seeds: Sequence[int]) -> str:
    settles_s, cpu_s, awake, step_us = [], [], 0, []
    for seed in seeds:
        world = World(shape=SHAFT, parts=PARTS, physics=variant.physics)
        began = time.process_time()
        try:
            report = fill(world, seed=seed)
        except SimulationError:
            return "blew up or stayed out | | |"
        cpu_s.append(time.process_time() - began)
        settles_s.append(report.settle_s)
        awake += report.awake
        began = time.process_time()
        world.step_for(0.4)
        steps = 0.4 / world.physics.tick_s
        step_us.append((time.process_time() - began) / steps * 1e6)
    return (
        f"{np.median(settles_s):.1f} | {np.median(cpu_s):.2f} | {awake} | {np.median(step_us):.0f}"
    )


def _main() -> None:
    write = sys.stdout.write
    write(
        "| setting | creep, 3 s (um) | slip in 4 fast moves, no lock (mm) | with lock (mm) | "
        "lock gave way | size error 7 g, 0.25, 0.63 kg (um) | settle (s) | CPU (s) | awake | "
        "us/tick asleep |\n|---|---|---|---|---|---|---|---|---|---|\n"
    )
    for variant in VARIANTS:
        write(measure(variant, range(5)) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    _main()
