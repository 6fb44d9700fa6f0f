"""Ways from one joint position to another: the straight joint line first, RRT-Connect else.

The planner is our own because a run must be the same every time: it is bounded by a number
of samples, not by a clock, and draws from the generator it is given (docs/decisions/0003).
Kuffner and LaValle, "RRT-Connect: an efficient approach to single-query path planning", 2000.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

__all__ = ["RESOLUTION_RAD", "Joints", "line_is_free", "plan_transit"]

Joints = NDArray[np.float64]
IsFree = Callable[[Joints], bool]

RESOLUTION_RAD = 0.007  # coarser steps pass through 5 mm walls
STEP_RAD = 0.35
GOAL_BIAS_SPREAD_RAD = 0.6


def line_is_free(is_free: IsFree, start: Joints, goal: Joints) -> bool:
    """Whether every position of the joint line is free, checked from the middle outwards."""
    count = max(2, int(np.ceil(np.abs(goal - start).max() / RESOLUTION_RAD)) + 1)
    fractions = np.linspace(0, 1, count)
    # A collision, if any, is most likely far from both free ends: bisect the order of checks.
    return all(is_free(start + (goal - start) * fractions[k]) for k in _bisected(count))


def _bisected(count: int) -> list[int]:
    bits = max(1, (count - 1).bit_length())
    order = (int(format(k, f"0{bits}b")[::-1], 2) for k in range(1 << bits))
    return [k for k in order if k < count]


def plan_transit(
    is_free: IsFree,
    start: Joints,
    goal: Joints,
    *,
    lower_rad: Joints,
    upper_rad: Joints,
    rng: np.random.Generator,
    max_samples: int = 400,
) -> list[Joints] | None:
    """Waypoints from ``start`` (left out) to ``goal``, or ``None`` if no way was found."""
    if not (is_free(start) and is_free(goal)):
        return None
    if line_is_free(is_free, start, goal):
        return [goal]
    path = _connect(is_free, start, goal, lower_rad, upper_rad, rng, max_samples)
    return _shortened(is_free, path, rng)[1:] if path else None


class _Tree:
    def __init__(self, root: Joints) -> None:
        self.nodes = [root]
        self.parents = [-1]

    def nearest(self, target: Joints) -> int:
        return int(np.argmin(np.abs(np.array(self.nodes) - target).max(axis=1)))

    def grow(self, is_free: IsFree, target: Joints) -> tuple[int, bool]:
        """Go towards the target until something is hit: last node, whether it arrived."""
        index = self.nearest(target)
        while True:
            here = self.nodes[index]
            away = target - here
            distance = float(np.abs(away).max())
            if distance < 1e-9:
                return index, True
            there = here + away * min(1.0, STEP_RAD / distance)
            if not line_is_free(is_free, here, there):
                return index, False
            self.nodes.append(there)
            self.parents.append(index)
            index = len(self.nodes) - 1

    def branch(self, index: int) -> list[Joints]:
        path = []
        while index >= 0:
            path.append(self.nodes[index])
            index = self.parents[index]
        return path


def _connect(
    is_free: IsFree,
    start: Joints,
    goal: Joints,
    lower_rad: Joints,
    upper_rad: Joints,
    rng: np.random.Generator,
    max_samples: int,
) -> list[Joints] | None:
    here, there, is_swapped = _Tree(start), _Tree(goal), False
    low = np.maximum(lower_rad, np.minimum(start, goal) - GOAL_BIAS_SPREAD_RAD)
    high = np.minimum(upper_rad, np.maximum(start, goal) + GOAL_BIAS_SPREAD_RAD)
    for _ in range(max_samples):
        index, _ = here.grow(is_free, rng.uniform(low, high))
        meeting, is_met = there.grow(is_free, here.nodes[index])
        if is_met:
            first, second = here.branch(index)[::-1], there.branch(meeting)[1:]
            path = first + second
            return path[::-1] if is_swapped else path
        here, there, is_swapped = there, here, not is_swapped
    return None


def _shortened(
    is_free: IsFree, path: list[Joints], rng: np.random.Generator, rounds: int = 30
) -> list[Joints]:
    """Drop detours: join points picked anywhere on the path where the line is free."""
    for _ in range(rounds):
        if len(path) < 3:
            break
        i, j = sorted(rng.integers(0, len(path), 2).tolist())
        if j - i > 1 and line_is_free(is_free, path[i], path[j]):
            path = path[: i + 1] + path[j:]
        else:
            path = _cut_corner(is_free, path, rng)
    return path


def _cut_corner(is_free: IsFree, path: list[Joints], rng: np.random.Generator) -> list[Joints]:
    corner = int(rng.integers(1, len(path) - 1))
    before = path[corner] + (path[corner - 1] - path[corner]) * rng.uniform(0.2, 1)
    after = path[corner] + (path[corner + 1] - path[corner]) * rng.uniform(0.2, 1)
    if not line_is_free(is_free, before, after):
        return path
    return [*path[:corner], before, after, *path[corner + 1 :]]
