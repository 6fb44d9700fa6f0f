"""``binpick rapid``: RAPID programs, without a controller."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cell.cli.common import STANDARD_OUTPUT, JsonOption, write_json

if TYPE_CHECKING:
    from sims.controller.backup.inspection import Inspection
    from sims.rapid.errors import Diagnostic

__all__ = ["NAME", "app"]

NAME = "rapid"

_WIDEST = 120

app = typer.Typer(name=NAME, no_args_is_help=True, help="RAPID programs, without a controller.")


@app.callback()
def _group() -> None:
    """RAPID programs, without a controller."""


@app.command("check")
def check(
    paths: Annotated[
        list[Path],
        typer.Argument(help="Modules, folders with modules, or the folder of a backup."),
    ],
    task_type: Annotated[
        str,
        typer.Option(help="Task in which loose modules run: NORMAL, STATIC or SEMISTATIC."),
    ] = "NORMAL",
    json: JsonOption = None,
) -> None:
    """Say what is wrong with RAPID source, all at once, each with its line and a caret.

    Modules named together are checked together: a routine or data of one may be used in another.
    Signals of loose modules are not known, so an undeclared name is a warning there. A backup
    folder brings its tasks, its signals and the list of what is loaded; what in it was not
    understood is listed at the end. Errors would keep a controller from loading or running the
    program; warnings depend on what is reached.

    Examples: binpick rapid check Main.mod Tools.sys, binpick rapid check backup_2024-05-01.

    Exit status 1 if there was an error.
    """
    from hal.errors import ConfigError
    from sims.controller.backup.inspection import inspect
    from sims.rapid.builtin import TaskKind

    try:
        kind = TaskKind(task_type.upper())
    except ValueError:
        raise ConfigError(
            f"{task_type!r} is unknown; there are {', '.join(TaskKind)}", key="--task-type"
        ) from None
    found = inspect(paths, kind=kind, has_motion=kind is TaskKind.NORMAL)
    _show(found, is_error_stream=json == STANDARD_OUTPUT)
    write_json(_as_json(found), json)
    if found.errors:
        raise typer.Exit(1)


def _show(found: "Inspection", *, is_error_stream: bool) -> None:
    sources: dict[str, list[str]] = {}
    for item in found.diagnostics:
        typer.echo(str(item), err=is_error_stream)
        for line in _quoted(item, sources):
            typer.echo(line, err=is_error_stream)
    for what in found.rest:
        typer.echo(f"not understood or not loaded: {what}", err=is_error_stream)
    typer.echo(
        f"{found.files} files, {found.modules} modules, {found.lines} lines: "
        f"{found.errors} errors, {found.warnings} warnings",
        err=is_error_stream,
    )


def _quoted(item: "Diagnostic", sources: dict[str, list[str]]) -> list[str]:
    """The line of the source, and a caret under the column."""
    if item.at.source not in sources:
        sources[item.at.source] = _lines(item.at.source)
    lines = sources[item.at.source]
    if not 1 <= item.at.line <= len(lines):
        return []
    begin = max(0, item.at.column - _WIDEST // 2) if item.at.column > _WIDEST else 0
    line = lines[item.at.line - 1][begin : begin + _WIDEST]
    if not line.strip():
        return []
    before = line[: item.at.column - 1 - begin]
    return [line, "".join("\t" if char == "\t" else " " for char in before) + "^"]


def _lines(source: str) -> list[str]:
    from sims.rapid.parser import decode

    try:
        text = decode(Path(source).read_bytes()) or ""
    except OSError:
        return []
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _as_json(found: "Inspection") -> dict[str, Any]:
    return {
        "files": found.files,
        "modules": found.modules,
        "lines": found.lines,
        "errors": found.errors,
        "warnings": found.warnings,
        "diagnostics": [
            {
                "file": item.at.source,
                "line": item.at.line,
                "column": item.at.column,
                "severity": str(item.severity),
                "message": item.message,
            }
            for item in found.diagnostics
        ],
        "rest": found.rest,
    }
