"""``binpick sim``: one simulated device alone, for foreign software."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from cell.cli.common import JsonOption, console, write_json
from hal.errors import ConfigError

__all__ = ["NAME", "app"]

NAME = "sim"
LAST_PORT = 65535

app = typer.Typer(
    name=NAME,
    no_args_is_help=True,
    help="One simulated device alone, speaking its real protocol, for foreign software.",
)


@app.callback()
def _group() -> None:
    """One simulated device alone, speaking its real protocol, for foreign software."""


@app.command("abb")
def abb(
    backup: Annotated[Path | None, typer.Option(help="A controller's backup folder.")] = None,
    module: Annotated[
        list[Path] | None, typer.Option(help="A RAPID module for the motion task; repeatable.")
    ] = None,
    override: Annotated[
        list[str] | None,
        typer.Option(help="NAME=VALUE: another value for a constant or PERS; repeatable."),
    ] = None,
    arm: Annotated[str | None, typer.Option(help="irb1200-5-0.9 or irb1200-7-0.7.")] = None,
    bind: Annotated[
        str, typer.Option(help="Where sockets listen; 0.0.0.0 lets others in.")
    ] = "127.0.0.1",
    port_map: Annotated[
        list[str] | None,
        typer.Option(help="1025=0: the program's port, and this machine's (0: any free one)."),
    ] = None,
    home: Annotated[Path | None, typer.Option(help="The folder behind HOME: in RAPID.")] = None,
    start: Annotated[bool, typer.Option(help="Start the programs at once.")] = True,
    pendant: Annotated[
        bool | None, typer.Option(help="The pendant in the terminal; default where there is one.")
    ] = None,
    command: Annotated[
        list[str] | None,
        typer.Option(help="What to type, in order; also 'wait SECONDS' and quit; repeatable."),
    ] = None,
    duration: Annotated[
        float | None, typer.Option("--for", metavar="SECONDS", min=0.0, help="End by itself.")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Run RAPID on a simulated ABB controller, with its sockets open on this machine.

    Without --backup and --module it runs the package that our own driver talks to. Commands:
    start, stop, pptomain, restart, auto, manr, manf, motors on, estop, release, reset,
    guard open, set di1 1, speed 50, quit. Ctrl-C ends it.

    Examples: binpick sim abb --module Server.mod --port-map 1025=0, binpick sim abb --backup DIR
    """
    from cell.standalone import AbbOptions, run_abb
    from cell.standalone.views import PendantView, PlainView, is_in_front

    if backup is not None and module:
        raise ConfigError("give a backup or modules, not both", key="--module")
    options = AbbOptions(
        backup=backup,
        modules=module or (),
        overrides=_overrides(override or []),
        arm=arm,
        bind=bind,
        ports=_ports(port_map or []),
        home=_folder(home),
        starts=start,
        commands=command or (),
        duration_s=duration,
    )
    screen = console(json)
    is_drawn = pendant if pendant is not None else screen.is_terminal and is_in_front()
    if is_drawn and not sys.stdin.isatty():
        raise ConfigError("there is no terminal to draw it on; use --no-pendant", key="--pendant")
    state = run_abb(options, PendantView(screen) if is_drawn else PlainView(screen))
    write_json(state, json)


def _overrides(given: list[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for text in given:
        name, equals, value = text.partition("=")
        if not (name.strip() and equals and value.strip()):
            raise ConfigError(f"{text!r} is not NAME=VALUE", key="--override")
        found[name.strip()] = value.strip()
    return found


def _ports(given: list[str]) -> dict[int, int]:
    found: dict[int, int] = {}
    for text in given:
        program, equals, real = text.partition("=")
        digits = program + real
        if not (equals and program and real and digits.isascii() and digits.isdigit()):
            raise ConfigError(f"{text!r} is not PORT=PORT, such as 1025=0", key="--port-map")
        if not (0 < int(program) <= LAST_PORT and int(real) <= LAST_PORT):
            raise ConfigError(f"{text!r}: ports go up to {LAST_PORT}", key="--port-map")
        found[int(program)] = int(real)
    return found


def _folder(home: Path | None) -> Path | None:
    if home is not None and not home.is_dir():
        raise ConfigError("is no folder", source=str(home), key="--home")
    return home
