"""Wall times of jobs, kept apart from everything that must be the same every run."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

__all__ = ["WallTimes"]

R = TypeVar("R")


@dataclass
class WallTimes:
    """Seconds of each run of each kind of job."""

    seconds: dict[str, list[float]] = field(default_factory=dict)

    def timed(self, name: str, job: Callable[[], R]) -> Callable[[], R]:
        """Return a job that does the same and notes how long it took."""

        def run() -> R:
            began = time.perf_counter()
            try:
                return job()
            finally:
                self.add(name, time.perf_counter() - began)

        return run

    def add(self, name: str, seconds: float) -> None:
        """Note one."""
        self.seconds.setdefault(name, []).append(seconds)

    def as_json(self) -> dict[str, float]:
        """Sum and 95th percentile of each; the cell file's charges are set from the latter."""
        rows: dict[str, float] = {}
        for name, values in sorted(self.seconds.items()):
            rows[f"{name}_s"] = float(sum(values))
            rows[f"{name}_p95_s"] = float(np.percentile(values, 95))
        return rows
