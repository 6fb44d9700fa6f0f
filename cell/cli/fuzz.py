"""``binpick fuzz``: hostile bytes for every reader of bytes."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

from cell.cli.common import JsonOption, console, write_json

__all__ = ["NAME", "command"]

NAME = "fuzz"


def command(
    target: Annotated[
        str, typer.Argument(help="What to fuzz; without it, lists what there is.")
    ] = "",
    count: Annotated[int, typer.Option(help="At most this many inputs.", min=1)] = 100_000,
    seconds: Annotated[float, typer.Option(help="At most this long.", min=0.1)] = 60.0,
    seed: Annotated[int, typer.Option(help="Another seed, other inputs.")] = 0,
    keep: Annotated[Path, typer.Option(help="Folder for inputs that broke a promise.")] = Path(
        "out/fuzz"
    ),
    json: JsonOption = None,
) -> None:
    """Try inputs made of pieces of a protocol, changed, cut and glued; keep those that reach more.

    Prints how many inputs there were, how many lines of the reader they reached, and after which
    input no new line came (the plateau). An input that crashes, hangs or is misread is kept as a
    file. Exit status 1 if there was one.
    """
    from hal.errors import ConfigError
    from sims.fuzz import TARGETS, fuzz

    if not target:
        console().print("\n".join(TARGETS))
        return
    if target not in TARGETS:
        raise ConfigError(f"{target!r} is unknown; there are {', '.join(TARGETS)}", key=NAME)
    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(f"fuzzing {target}", total=count)
        report = fuzz(
            TARGETS[target](),
            count=count,
            seed=seed,
            seconds=seconds,
            progress=lambda done: bar.update(task, completed=done),
        )
    for number, finding in enumerate(report.findings):
        keep.mkdir(parents=True, exist_ok=True)
        path = keep / f"{target}-{seed}-{number}.bin"
        path.write_bytes(finding.data)
        console().print(f"{path}: {finding.error}", markup=False, highlight=False)
    write_json(
        {
            "target": target,
            "seed": seed,
            "inputs": report.inputs,
            "inputs_per_s": report.inputs_per_s,
            "lines": report.lines,
            "plateau_after": report.last_new,
            "longest_s": report.longest_s,
            "findings": [finding.error for finding in report.findings],
        },
        json,
    )
    if json is None:
        console().print(
            f"{report.inputs} inputs, {report.inputs_per_s:.0f} a second; {report.lines} lines "
            f"reached, no new one after input {report.last_new}; slowest "
            f"{report.longest_s * 1000:.0f} ms; {len(report.findings)} broke a promise"
        )
    if report.findings:
        raise typer.Exit(1)
