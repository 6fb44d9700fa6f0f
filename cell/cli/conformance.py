"""``binpick conformance``: the promises, tried on one driver."""

import sys
from contextlib import redirect_stdout
from importlib import import_module
from typing import Annotated, Any

import typer

from cell.cli.common import STANDARD_OUTPUT, JsonOption, write_json

__all__ = ["NAME", "command"]

NAME = "conformance"


def command(
    backend: Annotated[str, typer.Argument(help="A name that `binpick devices` lists.")],
    json: JsonOption = None,
) -> None:
    """Try every promise of an interface on one backend and print which it keeps.

    The same suite judges ours and a third party's: a package adds its suite as an entry point
    in the group `binpick.suites`. Exit status 1 if a promise is broken.
    """
    from cell.devices import registry
    from hal.errors import ConfigError

    try:
        import pytest
    except ImportError as error:
        raise ConfigError("needs pytest: pip install binpick[test]", key=NAME) from error
    suites = registry().suites
    if backend not in suites:
        raise ConfigError(f"no suite for {backend!r}; suites: {', '.join(sorted(suites))}")
    module, _, suite = suites[backend].partition(":")
    path = import_module(module).__file__
    promises = _Promises()
    arguments = ["-q", "--no-header", "-p", "no:dash", "-p", "no:cacheprovider"]
    arguments += ["-p", "hal.conformance.plugin", "--import-mode=importlib", "-c", "/dev/null"]
    with redirect_stdout(sys.stderr if json == STANDARD_OUTPUT else sys.stdout):
        status = pytest.main([*arguments, f"{path}::{suite}"], plugins=[promises])
    write_json({"backend": backend, "promises": promises.outcomes}, json)
    if status != pytest.ExitCode.OK:
        raise typer.Exit(1)


class _Promises:
    """Collects promise to outcome."""

    def __init__(self) -> None:
        self.outcomes: dict[str, str] = {}

    def pytest_runtest_logreport(self, report: Any) -> None:
        for key, (_, promise, _, outcome, why) in report.user_properties:
            if key == "conformance":
                self.outcomes[promise] = f"skipped: {why}" if why else outcome
