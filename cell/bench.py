"""Benches by name, and the report they go into."""

import math
import os
import platform
import subprocess
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path
from typing import Any

from cell.config import CellConfig, load_cell
from hal import Figure
from perception.parts import Part

__all__ = ["BENCHES", "report_of", "run_cell_bench"]

Bench = Callable[[Sequence[int], Part, int], list[Figure]]


def _in_sims(module: str) -> Bench:
    """Import a bench of the simulators when it is asked for."""

    def run(seeds: Sequence[int], part: Part, count: int) -> list[Figure]:
        figures: list[Figure] = import_module(module).run(seeds=seeds, part=part, count=count)
        return figures

    return run


def run_cell_bench(
    seeds: Sequence[int], part: Part, count: int, config: CellConfig | None = None
) -> list[Figure]:
    """Empty a bin for each seed; ``cell.*`` figures, shares over all attempts."""
    from cell.demo.run import DemoOptions, run_demo

    results, walls = [], []
    for seed in seeds:
        options = DemoOptions(config or load_cell(), part, count, seed, keeps_pictures=False)
        run = run_demo(options)
        results.append(run.result)
        walls.append(run.wall)
    attempts = sum(r["attempts"] for r in results)

    def share(key: str, of: str) -> Figure:
        per_seed = [r[key] / max(r[of], 1) for r in results]
        total = sum(r[of] for r in results)
        value = sum(r[key] for r in results) / max(total, 1)
        return Figure(f"cell.{key}", value, "1", total, min(per_seed), max(per_seed))

    per_pick = [r["motion_s"] / max(r["attempts"], 1) for r in results]
    computing = [r["compute_s"] / max(r["attempts"], 1) for r in results]
    return [
        Figure("cell.attempts", attempts, "picks", len(results)),
        share("held", "attempts"),
        share("placed", "attempts"),
        share("left", "count"),
        Figure.median(
            "cell.picks_per_wall_minute", [w["picks_per_minute"] for w in walls], "1/min"
        ),
        Figure.median("cell.motion_s", per_pick, "s"),
        Figure.median("cell.compute_s", computing, "s"),
        *_errors([pick for r in results for pick in r["picks"]]),
    ]


def _errors(picks: Sequence[dict[str, Any]]) -> list[Figure]:
    """RMS over all picks, misses and bad placings included, with the least and the largest."""
    figures = []
    for which in ("pose", "place"):
        errors = [pick[f"{which}_error"] for pick in picks if pick[f"{which}_error"]]
        for quantity, key, scale, unit in (
            ("axis", "axis_deg", math.radians(1), "rad"),
            ("position", "position_mm", 1e-3, "m"),
        ):
            values = [error[key] * scale for error in errors]
            if values:
                rms = math.sqrt(sum(v * v for v in values) / len(values))
                name = f"cell.{which}_{quantity}_rms"
                figures.append(Figure(name, rms, unit, len(values), min(values), max(values)))
    return figures


BENCHES: dict[str, Bench] = {
    "world": _in_sims("sims.bench.world"),
    "depth": _in_sims("sims.bench.depth"),
    "pose": _in_sims("sims.bench.pose"),
    "cell": run_cell_bench,
    "abb": _in_sims("sims.bench.abb"),
}


def report_of(
    figures: Sequence[Figure], seeds: Sequence[int], part: str, count: int
) -> dict[str, Any]:
    """Return the object of ``binpick bench --json``."""
    return {
        "machine": _machine(),
        "commit": _commit(),
        "when": datetime.now(UTC).isoformat(timespec="seconds"),
        "seeds": list(seeds),
        "parts": [part],
        "count": count,
        "figures": [figure.as_json() for figure in figures],
    }


def _machine() -> str:
    model = platform.processor() or platform.machine()
    for line in _read("/proc/cpuinfo").splitlines():
        if line.startswith("model name"):
            model = line.partition(":")[2].strip()
            break
    return f"{model}, {os.cpu_count()} CPUs, Python {platform.python_version()}"


def _commit() -> str:
    here = Path(__file__).parent
    command = ["git", "-C", str(here), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        found = subprocess.run(command, capture_output=True, text=True, timeout=10, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
    return found.stdout.strip() or "unknown"


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError:
        return ""
