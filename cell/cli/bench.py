"""``binpick bench``: figures, with the machine they came from."""

from collections.abc import Sequence
from typing import Annotated

import typer
from rich.table import Table

from cell.cli.common import JsonOption, console, parse_parts, parse_seeds, write_json
from hal import Figure

__all__ = ["NAME", "command"]

NAME = "bench"


def command(
    what: Annotated[str, typer.Argument(help="world, depth, pose, cell, abb, or all.")],
    seeds: Annotated[str, typer.Option(help="Seeds: 0-9, or 0,2,5-7.")] = "0-2",
    parts: Annotated[
        str, typer.Option("--parts", help="As for `binpick demo`: 20, 20xshaft-slim.")
    ] = "20xshaft",
    json: JsonOption = None,
) -> None:
    """Measure, and say what was measured on what.

    world: physics and arm; depth: stereo matching against OpenCV's SGBM on the same images;
    pose: shafts found in rendered piles against FPFH + RANSAC + ICP on the same depth; cell:
    whole bins emptied; abb: the driver's round trip against a bare socket, the same through RAPID,
    the interpreter's speed, how exactly the simulated arm keeps to its path, and how it stops. Each
    runs on every seed; failures are counted, never left out.
    """
    from rich.progress import Progress

    from cell.bench import BENCHES, report_of
    from hal.errors import ConfigError
    from perception.parts import load_part

    if what != "all" and what not in BENCHES:
        raise ConfigError(f"unknown bench {what!r}; known: {', '.join([*BENCHES, 'all'])}")
    name, count = parse_parts(parts)
    part, number = load_part(name), 20 if count is None else count
    chosen = list(BENCHES) if what == "all" else [what]
    numbers = parse_seeds(seeds)
    terminal = console(json)
    figures: list[Figure] = []
    screen = console("-")
    with Progress(console=screen, transient=True, disable=not screen.is_terminal) as progress:
        task = progress.add_task("bench", total=len(chosen))
        for bench in chosen:
            progress.update(task, description=f"bench {bench}")
            figures += BENCHES[bench](numbers, part, number)
            progress.advance(task)
    report = report_of(figures, numbers, part.name, number)
    write_json(report, json)
    terminal.print(_table(figures))
    for peer in sorted({figure.peer for figure in figures if figure.peer}):
        terminal.print(f"[dim]peer: {peer}[/dim]")
    terminal.print(f"[dim]{report['machine']}, commit {report['commit']}[/dim]")


def _table(figures: Sequence[Figure]) -> Table:
    table = Table(box=None, header_style="bold")
    for name in ("figure", "value", "unit", "n", "range", "peer", "ratio"):
        right = name in {"value", "n", "peer", "ratio"}
        table.add_column(name, justify="right" if right else "left", no_wrap=True)
    for figure in figures:
        spread = "" if figure.min is None else f"{figure.min:.3g}..{figure.max:.3g}"
        peer = "" if figure.peer_value is None else f"{figure.peer_value:.3g}"
        ratio = "" if figure.ratio is None else f"{figure.ratio:.2g}"
        value = f"{figure.value:.3g}"
        table.add_row(figure.name, value, figure.unit, str(figure.n), spread, peer, ratio)
    return table
