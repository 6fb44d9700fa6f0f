"""``binpick``: commands by name. A command parses, calls one function, prints."""

import os
import signal
import sys
from importlib.metadata import version
from typing import Annotated

import typer

from cell.cli.common import discard_growing, with_json_value
from hal.errors import CellError

__all__ = ["main"]

INTERRUPTED = 130

app = typer.Typer(
    name="binpick",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    help="Empty a bin of stacked shafts: camera, perception, robot, gripper, and the twin to "
    "prove them.\n\nStart with [bold]binpick demo[/bold]: it needs no hardware.",
    epilog="Exit status: 0 done, 1 an error said in one line, 2 misuse.",
)


def _say_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(f"binpick {version('binpick')}")
        raise typer.Exit


@app.callback()
def _options(
    _: Annotated[
        bool,
        typer.Option("--version", callback=_say_version, is_eager=True, help="Say it and leave."),
    ] = False,
) -> None:
    """Options of binpick itself."""


def _register() -> None:
    from cell.cli import bench, capture, conformance, demo, devices, fuzz, rapid, see, sim

    for module in (demo, see, capture, devices, conformance, bench, fuzz):
        app.command(module.NAME)(module.command)
    app.add_typer(rapid.app)
    app.add_typer(sim.app)


def main() -> None:
    """Run a command and exit with its status."""
    _register()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _leave)
    try:
        app(args=with_json_value(sys.argv[1:]), prog_name="binpick", standalone_mode=True)
    except CellError as error:
        sys.stderr.write(f"binpick: {error}\n")
        sys.exit(1)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)


def _leave(*_: object) -> None:
    """Leave at once: worker threads in native code cannot be asked to stop."""
    discard_growing()
    sys.stderr.write("\nbinpick: interrupted; nothing half-written\n")
    sys.stderr.flush()
    os._exit(INTERRUPTED)
