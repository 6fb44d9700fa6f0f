"""When the arm is where on its way: the fastest run that keeps every limit.

On a grid of places the square of the speed is bounded from above; between two places the
acceleration is constant. One pass from the end backwards bounds the speed by what can still be
braked, one forwards by what can be reached. Both are running minima, so that planning a way of
thousands of places takes microseconds.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Grid", "Timing", "braked", "timed"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Grid:
    """Places on the way, shape (n,), ascending, and what holds there.

    ``fastest`` bounds the square of the speed; ``speeding`` and ``slowing`` the acceleration.
    """

    places: Array
    fastest: Array
    speeding: Array
    slowing: Array


@dataclass(frozen=True, eq=False)
class Timing:
    """Places, speeds and the times at which they are reached; times begin at 0."""

    places: Array
    speeds: Array
    times_s: Array

    @property
    def duration_s(self) -> float:
        """Until the last place."""
        return float(self.times_s[-1])

    def sample(self, times_s: Array) -> tuple[Array, Array]:
        """Places and speeds at times; after the end the last ones."""
        last = len(self.places) - 2
        cell = np.clip(np.searchsorted(self.times_s, times_s, side="right") - 1, 0, last)
        span = self.times_s[cell + 1] - self.times_s[cell]
        inside = np.clip(times_s - self.times_s[cell], 0.0, span)
        change = self.speeds[cell + 1] - self.speeds[cell]
        share = inside / np.where(span > 0, span, 1.0)
        speeds = self.speeds[cell] + change * share
        places = self.places[cell] + inside * (self.speeds[cell] + speeds) / 2
        return places, speeds


def timed(grid: Grid, speed: float) -> Timing:
    """Run as fast as the grid allows, from ``speed`` at its first place to a stand at its last.

    Where the speed is above the bounds already, it comes down as fast as the grid allows.
    """
    step = np.diff(grid.places)
    least_gain = 2 * step * np.minimum(grid.speeding[:-1], grid.speeding[1:])
    least_loss = 2 * step * np.minimum(grid.slowing[:-1], grid.slowing[1:])
    gain = np.concatenate([[0.0], np.cumsum(least_gain)])
    loss = np.concatenate([[0.0], np.cumsum(least_loss)])
    bound = grid.fastest.copy()
    bound[-1] = 0.0
    bound = np.minimum.accumulate((bound + loss)[::-1])[::-1] - loss
    start = speed**2
    bound[0] = min(bound[0], start)
    square = np.minimum.accumulate(bound - gain) + gain
    if start > square[0]:
        way = grid.places[-1] - grid.places
        descent = np.minimum(start - loss, start * way / max(way[0], 1e-15))
        square = np.maximum(square, descent)
    return _run(grid.places, np.maximum(square, 0.0))


def braked(grid: Grid, speed: float) -> Timing:
    """Come to a stand as soon as ``slowing`` allows."""
    step = np.diff(grid.places)
    loss = np.concatenate(
        [[0.0], np.cumsum(2 * step * np.minimum(grid.slowing[:-1], grid.slowing[1:]))]
    )
    square = speed**2 - loss
    if square[-1] > 0:  # the way ends before: stand at its end
        way = grid.places[-1] - grid.places
        return _run(grid.places, speed**2 * way / max(way[0], 1e-15))
    last = int(np.argmax(square <= 0))
    if last == 0:
        return Timing(grid.places[[0, 0]], np.zeros(2), np.zeros(2))
    share = square[last - 1] / (square[last - 1] - square[last])
    stand = grid.places[last - 1] + share * step[last - 1]
    return _run(np.append(grid.places[:last], stand), np.append(square[:last], 0.0))


def _run(places: Array, square: Array) -> Timing:
    speeds = np.sqrt(square)
    mean = (speeds[1:] + speeds[:-1]) / 2
    step = np.diff(places)
    spans = np.where(step > 0, step / np.maximum(mean, 1e-9), 0.0)
    return Timing(places, speeds, np.concatenate([[0.0], np.cumsum(spans)]))
