"""``binpick devices``: backends, and what each one needs."""

from dataclasses import asdict
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from cell.cli.common import JsonOption, console, write_json

__all__ = ["NAME", "command"]

NAME = "devices"


def command(
    kind: Annotated[str, typer.Argument(help="Only this kind, such as robot.")] = "",
    json: JsonOption = None,
) -> None:
    """List the devices that a cell file may name, and what each one needs."""
    from cell.devices import registry
    from hal import Kind
    from hal.errors import ConfigError

    if kind and kind not in set(Kind):
        raise ConfigError(f"{kind!r} is not a kind of device; kinds: {', '.join(Kind)}")
    known = registry()
    rows = {n: b for n, b in sorted(known.backends.items()) if not kind or b.kind == kind}
    if json is not None:
        write_json({name: asdict(backend) for name, backend in rows.items()}, json)
        return
    table = Table("backend", "kind", "address", "needs", box=None, header_style="bold")
    for name, backend in rows.items():
        scheme = known.schemes.get(backend.scheme)
        example = scheme.example if scheme else f"{backend.scheme}:"
        table.add_row(*map(escape, (name, str(backend.kind), example, backend.needs or "nothing")))
    console().print(table)
