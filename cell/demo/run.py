"""One demo: a world, a line in front of it, and the world's score."""

import asyncio
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from cell.attempt import Ending, Outcome
from cell.build import Devices, build_line, make_devices
from cell.config import CellConfig
from cell.cycle import empty_the_bin
from cell.demo.controls import Controls
from cell.demo.score import Score
from cell.demo.twin import Twin
from cell.eyes import StereoEyes
from cell.journal import Journal, quantise
from cell.line import Line
from cell.report.pictures import LookPictures
from hal import StereoCalibration
from hal.errors import CellError
from perception.files import read_calibration, write_calibration
from perception.parts import Part
from sims.loop import LockstepLoop

__all__ = ["DemoOptions", "DemoRun", "run_demo"]

REST_S = 0.5

Progress = Callable[[str, dict[str, Any]], None]


@dataclass(frozen=True)
class DemoOptions:
    """What ``binpick demo`` was asked for."""

    config: CellConfig
    part: Part
    count: int = 12
    seed: int = 0
    controls: Controls = field(default_factory=Controls)
    journal_path: Path | None = None
    calibration_path: Path | None = None
    keeps_pictures: bool = True


@dataclass(eq=False)
class DemoRun:
    """What came out: ``result`` is the JSON object, ``wall`` the wall times beside it."""

    result: dict[str, Any]
    wall: dict[str, float]
    looks: list[LookPictures]
    chosen: list[int | None]
    phases: list[dict[str, Any]]


def run_demo(options: DemoOptions, progress: Progress | None = None) -> DemoRun:
    """Drop the parts, empty the bin, score. In lock-step: the same options, the same run.

    Raises
    ------
    CellError
        Anything a person can mend: what, where, what to do.
    """
    started = time.perf_counter()
    twin = Twin.filled(
        options.config,
        options.part,
        count=options.count,
        seed=options.seed,
        controls=options.controls,
    )
    filled = time.perf_counter()
    journal = Journal(options.journal_path)
    loop = LockstepLoop(twin.world)
    try:
        asyncio.set_event_loop(loop)
        line, score, outcome, eyes = loop.run_until_complete(
            _empty(twin, options, journal, progress)
        )
        virtual_s = loop.time() - REST_S
    finally:
        asyncio.set_event_loop(None)
        loop.close()
        journal.close()
    ended = time.perf_counter()
    wall = {"setup_s": filled - started, "run_s": ended - filled, "total_s": ended - started}
    wall["picks_per_minute"] = 60 * len(outcome.attempts) / max(ended - filled, 1e-9)
    wall.update(line.wall.as_json())
    result = _result(options, line, score, outcome, virtual_s)
    chosen = [record["part"] for record in journal.of("chosen")]
    looks = eyes.pictures
    chosen += [None] * (len(looks) - len(chosen))
    return DemoRun(result, wall, looks, chosen[: len(looks)], _timed_phases(journal))


async def _outcome(line: Line) -> Outcome:
    """An error after the first pick ends the run, and what was done is still reported."""
    try:
        return await empty_the_bin(line)
    except CellError as error:
        if not line.attempts:
            raise
        line.note("end", ending=str(Ending.FAILED), failure=str(error))
        return Outcome(Ending.FAILED, tuple(line.attempts), {}, str(error))


def _calibration(twin: Twin, options: DemoOptions) -> StereoCalibration:
    """Read the file that the cell names, or the one that comes with the simulated rig.

    The simulated rig's file is written and read back: what the cell runs on is a file.
    """
    named = options.config.camera.calibration
    if named:
        return read_calibration(Path(named))
    with TemporaryDirectory() as folder:
        path = options.calibration_path or Path(folder) / "calibration.json"
        write_calibration(path, twin.calibration)
        return read_calibration(path)


async def _empty(
    twin: Twin, options: DemoOptions, journal: Journal, progress: Progress | None
) -> tuple[Line, Score, Outcome, StereoEyes]:
    async with twin.opened() as opened:
        devices = make_devices(options.config, opened)
        eyes = _eyes(twin, options, devices)
        line = build_line(options.config, options.part, devices, eyes, journal, seed=options.seed)
        eyes.note, eyes.wall = line.note, line.wall
        score = Score(twin.world, options.part, line)
        line.listeners.append(score)
        line.exchange_tray = score.exchange_tray
        if progress:
            line.listeners.append(progress)
        async with devices.robot, devices.gripper, devices.camera, devices.projector:
            await devices.robot.set_tool(twin.tool)
            await eyes.prepare()
            outcome = await _outcome(line)
            await asyncio.sleep(REST_S)
    score.judge_tray()
    return line, score, outcome, eyes


def _eyes(twin: Twin, options: DemoOptions, devices: Devices) -> StereoEyes:
    return StereoEyes(
        devices.camera,
        devices.projector,
        _calibration(twin, options),
        options.part,
        options.config,
        seed=options.seed,
        keeps_pictures=options.keeps_pictures,
    )


def _result(
    options: DemoOptions, line: Line, score: Score, outcome: Outcome, virtual_s: float
) -> dict[str, Any]:
    phases = line.journal.of("phase")
    rejects: Counter[str] = Counter()
    for record in line.journal.of("chosen"):
        rejects.update(record["rejects"])
    picks = [
        {**attempt.as_json(), **score_.as_json()}
        for attempt, score_ in zip(outcome.attempts, score.picks, strict=True)
    ]
    name = options.part.name
    result = {
        "seed": options.seed,
        "parts": [name],
        "count": options.count,
        "attempts": len(outcome.attempts),
        "held": sum(pick.is_held for pick in score.picks),
        "placed": sum(pick.is_placed for pick in score.picks),
        "left": score.left,
        "lost": score.lost,
        "ending": str(outcome.ending),
        "failure": outcome.failure,
        "left_reasons": _left_reasons(outcome, score.left),
        "reject_reasons": dict(sorted(rejects.items())),
        "misses": dict(sorted(Counter(a.miss for a in outcome.attempts if a.miss).items())),
        "motion_s": sum(p["end_s"] - p["start_s"] for p in phases),
        "compute_s": sum(r["end_s"] - r["start_s"] for r in line.journal.of("computed")),
        "virtual_s": virtual_s,
        "picks": picks,
        "pose_error": {name: score.pose_summary()},
        "place_error": {name: score.place_summary()},
        "journal_sha256": line.journal.sha256,
    }
    rounded: dict[str, Any] = quantise(result)
    return rounded


def _left_reasons(outcome: Outcome, left: int) -> dict[str, int]:
    """Add what the cell did not see and the world knows to be there."""
    unseen = left - sum(outcome.left_reasons.values())
    if outcome.ending is Ending.EMPTY and unseen > 0:
        return {**outcome.left_reasons, "not seen by the cell": unseen}
    return outcome.left_reasons


def _timed_phases(journal: Journal) -> list[dict[str, Any]]:
    return [r for r in journal.records if r["event"] in {"phase", "computed"}]
