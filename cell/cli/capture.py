"""``binpick capture``: a stereo shot folder."""

from pathlib import Path
from typing import Annotated, Any

import typer

from cell.cli.common import JsonOption, Unit, console, parse_parts, write_json
from cell.demo.controls import HELP as CONTROLS_HELP

__all__ = ["NAME", "command"]

NAME = "capture"


def command(
    folder: Annotated[Path, typer.Argument(help="The folder to make; it must not be there yet.")],
    parts: Annotated[
        str, typer.Option("--parts", help="As for `binpick demo`: 12, 20xshaft-slim.")
    ] = "shaft",
    count: Annotated[
        int | None, typer.Option("--count", "-n", min=0, max=60, help="How many parts.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Pile, rig and noise.")] = 0,
    shots: Annotated[int | None, typer.Option(help="Pattern pairs.")] = None,
    cell: Annotated[Path | None, typer.Option(help="A cell file.")] = None,
    truth: Annotated[
        bool, typer.Option("--truth", help="Add truth.json: where the parts really are.")
    ] = False,
    whole: Annotated[
        bool, typer.Option("--whole", help="Whole sensors, not just the bin.")
    ] = False,
    control: Annotated[list[str] | None, typer.Option(help=CONTROLS_HELP)] = None,
    unit: Annotated[Unit, typer.Option(help="Unit of a mesh file.")] = Unit.MILLIMETRE,
    json: JsonOption = None,
) -> None:
    """Take a stereo shot folder of a simulated bin: images, calibration, and what took them.

    `binpick see` reads it, and so can anyone: docs/reference/shot-folder.md.
    """
    from cell.config import load_cell, with_shots
    from cell.demo.controls import Controls
    from cell.demo.snap import snap
    from perception.parts import load_part

    name, number = parse_parts(parts)
    number = count if count is not None else (12 if number is None else number)
    config = load_cell(cell)
    config = with_shots(config, shots) if shots is not None else config
    part = load_part(name, unit=unit.value)
    result: dict[str, Any] = snap(
        folder,
        config,
        part,
        count=number,
        seed=seed,
        controls=Controls.parse(control or []),
        has_truth=truth,
        is_whole=whole,
    )
    write_json(result, json)
    console(json).out(
        f"{folder}: {result['shots']} pairs of {result['width_px']} x {result['height_px']} px"
    )
