"""``binpick demo``: the main job, in simulation."""

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from cell.cli.common import (
    JsonOption,
    Unit,
    check_writable,
    console,
    json_files,
    parse_parts,
    replacing,
    write_json,
)
from cell.demo.controls import HELP as CONTROLS_HELP

__all__ = ["NAME", "command"]

NAME = "demo"


def command(
    parts: Annotated[
        str,
        typer.Option(
            "--parts",
            help="How many of what: 12, shaft-slim, 20xshaft, 8xmy_part.stl, or sizes such as "
            "shaft:20x35,28x25,20x40 (diameter x length in mm, section by section).",
        ),
    ] = "shaft",
    count: Annotated[
        int | None, typer.Option("--count", "-n", help="How many parts; 12 unless --parts says.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Pile, rig, noise: one seed, one run.")] = 0,
    shots: Annotated[
        int | None, typer.Option(help="Pattern pairs a capture (1: a static slide).")
    ] = None,
    cell: Annotated[
        Path | None, typer.Option(help="A cell file; see docs/reference/cell-file.md.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for report.html and journal.jsonl.")] = Path(
        "out/demo"
    ),
    control: Annotated[list[str] | None, typer.Option(help=CONTROLS_HELP)] = None,
    unit: Annotated[Unit, typer.Option(help="Unit of a mesh file.")] = Unit.MILLIMETRE,
    report: Annotated[bool, typer.Option(help="Write report.html.")] = True,
    json: JsonOption = None,
) -> None:
    """Drop parts into a simulated bin, empty it from stereo images, and report.

    Nothing is read from the simulator but images, joints and gripper state; the world's truth
    is used for the score only. The same seed gives the same run.

    Misses and parts left are counted and named; they do not make the exit status 1.
    """
    from cell.config import load_cell, with_shots
    from cell.demo.controls import Controls
    from cell.demo.run import DemoOptions, run_demo
    from cell.report.html import render_report
    from cell.report.terminal import print_report
    from hal.errors import CellError, ConfigError
    from perception.parts import load_part

    name, number = parse_parts(parts)
    number = count if count is not None else (12 if number is None else number)
    if not 0 <= number <= 60:
        raise ConfigError(f"{number} parts: 0 to 60 make sense in this bin", key="--count")
    config = load_cell(cell)
    if shots is not None:
        config = with_shots(config, shots)
    controls = Controls.parse(control or [])
    part = load_part(name, unit=unit.value)
    journal, page, calibration = (
        out / file for file in ("journal.jsonl", "report.html", "calibration.json")
    )
    for path in (journal, page, calibration, *json_files(json)):
        check_writable(path)
    terminal = console(json)
    with (
        replacing(journal) as growing,
        replacing(calibration) as file,
        _Bar(terminal, number) as bar,
    ):
        page.unlink(missing_ok=True)  # an older run's would look like this one's
        options = DemoOptions(
            config, part, number, seed, controls, growing, file, keeps_pictures=report
        )
        run = run_demo(options, bar)
    if report:
        text = render_report(run.result, run.looks, run.chosen, run.phases)
        with replacing(page) as partial:
            partial.write_text(text, encoding="utf-8")
    write_json(run.result, json)
    for path in json_files(json)[1:]:
        write_json(run.wall, str(path))
    print_report(run.result, terminal, report=str(page) if report else "")
    terminal.print(
        f"[dim]wall time {run.wall['total_s']:.1f} s, "
        f"{run.wall['picks_per_minute']:.1f} picks a minute[/dim]"
    )
    if run.result["failure"]:
        raise CellError(run.result["failure"])


class _Bar:
    """A progress bar that listens to the line."""

    def __init__(self, terminal: Console, count: int) -> None:
        screen = terminal if terminal.stderr else Console(stderr=True)
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(bar_width=32),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            console=screen,
            transient=True,
            disable=not screen.is_terminal,
        )
        self._task = self._progress.add_task("dropping parts", total=count)

    def __enter__(self) -> "_Bar":
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def __call__(self, event: str, fields: dict[str, Any]) -> None:
        if event == "seen":
            found = len(fields["parts"])
            self._progress.update(self._task, description=f"look {fields['look']}: {found} found")
        elif event == "attempt" and fields["is_laid_down"]:
            self._progress.advance(self._task)
