"""Playing a way to the arm, a tick at a time, while it still grows.

The run along the way (``timing``) has steps in its acceleration. They are rounded off by a
running mean over the last ticks, taken of the place on the way: the way itself stays exact, no
acceleration grows, and the arm arrives half a window later.
"""

import numpy as np
from numpy.typing import NDArray

from sims.motion.timing import Timing, braked, timed
from sims.motion.way import Way

__all__ = ["WayPlayer"]

Array = NDArray[np.float64]

CHUNK = 128


class WayPlayer:
    """A ``sims.world`` player on a way.

    Parameters
    ----------
    joint_radps2
        How hard the joints may brake.
    window
        Ticks of the running mean; 1: none.
    """

    def __init__(
        self, way: Way, place: float, *, tick_s: float, window: int, joint_radps2: Array
    ) -> None:
        self.way = way
        self._tick_s = tick_s
        self._window = max(1, window)
        self._brakes = joint_radps2
        self._is_braking = False
        self._row = self._begun = self._last = 0
        self._raw: Array
        self._follow(Timing(np.full(2, place), np.zeros(2), np.zeros(2)), place, None)

    @property
    def place(self) -> float:
        """Where on the way the last set-point lies."""
        return float(self._places[self._row])

    @property
    def lead(self) -> float:
        """The place beyond which the run can still be changed."""
        return float(self._raw[self._row + self._window - 1])

    @property
    def speed(self) -> float:
        """Along the way, rad/s."""
        return float(self._speeds[self._row])

    @property
    def remaining_s(self) -> float:
        """Until the end of what is planned."""
        return (self._last - self._begun - self._row) * self._tick_s

    @property
    def is_done(self) -> bool:
        """Whether the last set-point has been given."""
        return self._begun + self._row >= self._last

    def next_joints_rad(self) -> Array:
        """Return the set-point of the next tick."""
        self._row += 1
        if self._row >= len(self._joints):
            self._begun += self._row - 1
            self._sample(self._raw[-self._window :])
            self._row = 1
        return np.array(self._joints[self._row])

    def plan(self, way: Way, *, ratio: float = 1.0, most_mps: float = np.inf) -> None:
        """Go on along a way that begins as the old one did, as fast as it allows."""
        self.way = way
        self._is_braking = False
        grid = way.grid(
            self.lead,
            ratio=ratio,
            most_mps=most_mps,
            smoothing_s=(self._window - 1) * self._tick_s,
        )
        self._replace(timed(grid, self.speed))

    def brake(self) -> None:
        """Come to a stand on the way; harmless when braking."""
        if self._is_braking or self.is_done:
            return
        self._is_braking = True
        self._replace(braked(self.way.stopping_grid(self.lead, self._brakes), self.speed))

    def _replace(self, timing: Timing) -> None:
        recent = self._raw[self._row : self._row + self._window]
        self._follow(timing, self.lead, recent)

    def _follow(self, timing: Timing, place: float, recent: Array | None) -> None:
        self._timing = timing
        self._begun = 0
        self._last = int(np.ceil(timing.duration_s / self._tick_s - 1e-9)) + self._window - 1
        if timing.duration_s <= 0 and (recent is None or np.ptp(recent) == 0):
            self._last = 0
        self._sample(np.full(self._window, place) if recent is None else recent)
        self._row = 0

    def _sample(self, recent: Array) -> None:
        """Set-points of the ticks from ``_begun`` on; ``recent`` are the run's last places."""
        count = max(1, min(CHUNK, self._last - self._begun))
        ticks = self._begun + np.arange(1, count + 1)
        times: Array = ticks.astype(np.float64) * self._tick_s
        places, speeds = self._timing.sample(times)
        self._raw = np.concatenate([recent, places])
        self._speeds = np.concatenate([self._timing.sample(times[:1] - self._tick_s)[1], speeds])
        sums = np.convolve(self._raw, np.ones(self._window), "valid") / self._window
        self._places = sums
        self._joints = self.way.joints_rad(sums)
