"""What every command shares: JSON out, progress, one line for an error."""

import json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from hal.errors import ConfigError

__all__ = [
    "STANDARD_OUTPUT",
    "JsonOption",
    "PartsAsked",
    "Unit",
    "check_writable",
    "console",
    "discard_growing",
    "json_files",
    "parse_parts",
    "parse_seeds",
    "replacing",
    "with_json_value",
    "write_json",
]

STANDARD_OUTPUT = "-"
PIPE_COLUMNS = 130

_growing: set[Path] = set()


class Unit(StrEnum):
    """Of a mesh file, which does not say."""

    MILLIMETRE = "mm"
    METRE = "m"


JsonOption = Annotated[
    str | None,
    typer.Option(
        "--json",
        metavar="[FILE]",
        help="Write the result as JSON to FILE, or to standard output without FILE.",
    ),
]


def console(json_to: str | None = None) -> Console:
    """Where people read: standard output, or standard error when JSON goes there."""
    screen = Console(stderr=json_to == STANDARD_OUTPUT, highlight=False)
    if not screen.is_terminal and "COLUMNS" not in os.environ:
        screen.width = PIPE_COLUMNS  # nobody's window is that narrow; keep rows whole
    return screen


def with_json_value(argv: Sequence[str]) -> list[str]:
    """Give ``--json`` without a file the value ``-``, since an option must have one."""
    words: list[str] = []
    for index, word in enumerate(argv):
        words.append(word)
        if word == "--json":
            following = argv[index + 1] if index + 1 < len(argv) else ""
            if not following or (following.startswith("-") and following != STANDARD_OUTPUT):
                words.append(STANDARD_OUTPUT)
    return words


def json_files(to: str | None) -> list[Path]:
    """Return the file for the result and the one for wall times; none for standard output."""
    if to is None or to == STANDARD_OUTPUT:
        return []
    return [Path(to), Path(f"{to.removesuffix('.json')}.wall.json")]


def write_json(value: Any, to: str | None) -> None:
    """Write indented JSON; a file appears whole or not at all.

    Raises
    ------
    ConfigError
        The file cannot be written.
    """
    if to is None:
        return
    text = json.dumps(value, indent=2, allow_nan=False) + "\n"
    if to == STANDARD_OUTPUT:
        sys.stdout.write(text)
        return
    with replacing(Path(to)) as path:
        path.write_text(text, encoding="utf-8")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Write to a file beside ``path`` and move it there when all is well."""
    partial = check_writable(path)
    _growing.add(partial)
    try:
        yield partial
        try:
            partial.replace(path)
        except OSError as error:
            raise _unwritable(path, error) from error
    finally:
        _growing.discard(partial)
        with suppress(OSError):
            partial.unlink()


def discard_growing() -> None:
    """Remove what is half-written; for leaving at once."""
    for partial in list(_growing):
        with suppress(OSError):
            partial.unlink()


def check_writable(path: Path) -> Path:
    """See that a file can be made here; return the name under which it grows.

    Raises
    ------
    ConfigError
        A folder, an empty name, or a place where nothing can be written.
    """
    if not path.name or path.is_dir():
        raise ConfigError("is a folder; name a file", source=str(path) or "''")
    partial = path.with_name(f".{path.name}.partial")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        partial.touch()
        partial.unlink()
    except OSError as error:
        raise _unwritable(path, error) from error
    return partial


def _unwritable(path: Path, error: OSError) -> ConfigError:
    return ConfigError(f"cannot be written: {error.strerror}", source=str(path))


class PartsAsked(tuple[str, int | None]):
    """Part name or file, and how many if that was said."""

    __slots__ = ()


def parse_parts(text: str) -> PartsAsked:
    """``12``, ``shaft``, ``20xshaft-slim``, ``part.stl``.

    >>> parse_parts("12"), parse_parts("20xshaft-slim"), parse_parts("shaft:20x35,28x25")
    (('shaft', 12), ('shaft-slim', 20), ('shaft:20x35,28x25', None))
    """
    count, cross, name = text.partition("x")
    if text.isascii() and text.isdigit():
        return PartsAsked(("shaft", int(text)))
    if cross and count.isascii() and count.isdigit() and name:
        return PartsAsked((name, int(count)))
    return PartsAsked((text, None))


def parse_seeds(text: str) -> list[int]:
    """``3``, ``0-9`` or ``0,2,5-7``.

    Raises
    ------
    ConfigError
        Anything else.

    >>> parse_seeds("0,2,5-7")
    [0, 2, 5, 6, 7]
    """
    seeds: list[int] = []
    try:
        for piece in text.split(","):
            first, dash, last = piece.partition("-")
            seeds += range(int(first), int(last) + 1) if dash else [int(first)]
    except ValueError as error:
        raise ConfigError(
            f"seeds are numbers and ranges such as 0-9 or 0,2,5, not {text!r}", key="--seeds"
        ) from error
    if not seeds or len(seeds) > 1000:
        raise ConfigError(f"{text!r} names {len(seeds)} seeds", key="--seeds")
    return seeds
