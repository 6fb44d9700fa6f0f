r"""A controller's configuration files: ``SYS.cfg``, ``EIO.cfg``, ``MOC.cfg`` and their kin.

A file has a head (``EIO:CFG_1.0:6:1::``), sections (``EIO_SIGNAL:``) set apart by ``#`` lines, and
in each section instances: one ``-Name "di1" -SignalType "DI"`` each, carried on with ``\`` at the
end of a line. A flag without a value is TRUE.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from sims.rapid.ast import Place
from sims.rapid.errors import Diagnostic, Severity
from sims.rapid.parser import decode

__all__ = ["DOMAINS", "Cfg", "Instance", "Value", "lookup", "parse_cfg", "read_cfg"]

DOMAINS = ("SYS", "EIO", "MOC", "SIO", "MMC", "PROC")

MAX_CHARS = 8_000_000
MAX_DIAGNOSTICS = 200

_HEAD = re.compile(r"\s*(\w+):CFG_[\w.]+:")
_SECTION = re.compile(r"\s*([A-Za-z_]\w*):\s*$")
_ATTRIBUTE = re.compile(r'\s*+(?:-([A-Za-z_]\w*+)|"([^"]*+)"|([^\s"-][^\s"]*+|-[0-9.][^\s"]*+))')

_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")

_WORDS = {"TRUE": True, "FALSE": False}


@dataclass(frozen=True, slots=True)
class Instance:
    """One entry of a section. ``attributes`` are by name as written; look up with ``get``.

    Values are ``str`` where quoted, ``float`` where a number, ``bool`` for TRUE, FALSE and bare
    flags; an attribute with several values is a tuple. Numbers are in the file's own units:
    metres and radians.
    """

    at: Place
    attributes: Mapping[str, "Value"]

    @property
    def name(self) -> str:
        """``-Name``, or the empty string."""
        return self.text("Name")

    def get(self, name: str) -> "Value | None":
        """Look an attribute up, whatever its case; None when it is not there."""
        low = name.lower()
        return next((v for key, v in self.attributes.items() if key.lower() == low), None)

    def text(self, name: str, otherwise: str = "") -> str:
        """Return an attribute as text."""
        value = self.get(name)
        if isinstance(value, float):
            return f"{value:g}"
        return value if isinstance(value, str) else otherwise

    def number(self, name: str, otherwise: float = 0.0) -> float:
        """Return an attribute as a number."""
        value = self.get(name)
        if isinstance(value, str) and _NUMBER.fullmatch(value):
            return float(value)
        return value if isinstance(value, float) else otherwise

    def flag(self, name: str, otherwise: bool = False) -> bool:
        """Return an attribute as TRUE or FALSE; ``"YES"``, ``"TRUE"`` and 1 are TRUE."""
        value = self.get(name)
        if isinstance(value, str):
            return value.upper() in ("TRUE", "YES", "ON", "1")
        return otherwise if value is None or isinstance(value, tuple) else bool(value)


Value = str | float | bool | tuple[str | float | bool, ...]


@dataclass(frozen=True, slots=True)
class Cfg:
    """One file. ``domain`` is of its head, ``sections`` are by name in the file's order."""

    source: str
    domain: str
    sections: Mapping[str, tuple[Instance, ...]] = field(default_factory=dict)

    def section(self, name: str) -> tuple[Instance, ...]:
        """Return the instances of a section, none when it is not there."""
        return self.sections.get(name.upper(), ())

    def find(self, section: str, name: str) -> Instance | None:
        """Return the instance of this name, whatever its case."""
        low = name.lower()
        return next((item for item in self.section(section) if item.name.lower() == low), None)


def lookup(cfgs: Mapping[str, Cfg], path: str, attribute: str) -> Value:
    """Return what ReadCfgData reads: ``/EIO/EIO_SIGNAL/di1`` and an attribute. ``KeyError``."""
    domain, _, rest = path.strip("/").partition("/")
    section, _, name = rest.partition("/")
    instance = cfgs[domain.upper()].find(section, name)
    value = None if instance is None else instance.get(attribute)
    if value is None:
        raise KeyError(f"{path} {attribute}")
    return value


def read_cfg(path: Path | str) -> tuple[Cfg, list[Diagnostic]]:
    """Parse a file; one that cannot be read, or is binary, is one diagnostic."""
    source = str(path)
    try:
        with Path(path).open("rb") as file:
            text = decode(file.read(MAX_CHARS + 1))
    except OSError as error:
        return _nothing(source, f"cannot be read: {error.strerror}")
    if text is None:
        return _nothing(source, "not text but binary: not a configuration file")
    return parse_cfg(text, source)


def parse_cfg(text: str, source: str) -> tuple[Cfg, list[Diagnostic]]:
    """Parse a text; what is not understood is located and left out. Never raises."""
    if len(text) > MAX_CHARS:
        return _nothing(source, f"more than {MAX_CHARS} characters: not a configuration file")
    found: list[Diagnostic] = []
    domain = ""
    section: list[Instance] | None = None
    sections: dict[str, list[Instance]] = {}
    for number, line in _logical_lines(text):
        at = Place(source, number, 1)
        if not domain and (head := _HEAD.match(line)):
            domain = head[1].upper()
        elif title := _SECTION.match(line):
            section = sections.setdefault(title[1].upper(), [])
        elif section is None:
            _note(found, at, "neither a head nor a section (NAME:): left out")
        elif attributes := _attributes(at, line, found):
            section.append(Instance(at, attributes))
    if not domain:
        _note(found, Place(source, 1, 1), "no head such as SYS:CFG_1.0:6:1::", Severity.ERROR)
    kept = {name: tuple(items) for name, items in sections.items()}
    return Cfg(source, domain, kept), found


def _logical_lines(text: str) -> Iterator[tuple[int, str]]:
    parts: list[str] = []
    begin = 0
    for number, raw in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
        line = raw.rstrip(" \t\x1a")
        if not parts and (not line.strip() or line.lstrip().startswith("#")):
            continue
        if not parts:
            begin = number
        if line.endswith("\\"):
            parts.append(line[:-1])
            continue
        parts.append(line)
        yield begin, "\n".join(parts)
        parts = []
    if parts:
        yield begin, "\n".join(parts)


def _attributes(at: Place, line: str, found: list[Diagnostic]) -> dict[str, Value]:
    attributes: dict[str, Value] = {}
    name = ""
    values: list[str | float | bool] = []
    position = 0
    length = len(line.rstrip())
    while position < length:
        match = _ATTRIBUTE.match(line, position)
        if match is None:
            odd = line[position:].lstrip()
            where = _where(at, line, len(line) - len(odd))
            _note(found, where, f"not understood: {odd[:24]!r}")
            break
        position = match.end()
        if match[1] is not None:
            _keep(attributes, name, values)
            name, values = match[1], []
        elif not name:
            _note(
                found, _where(at, line, match.start()), "a value without -Name before it: left out"
            )
            break
        else:
            values.append(match[2] if match[2] is not None else _bare(match[3]))
    _keep(attributes, name, values)
    return attributes


def _keep(attributes: dict[str, Value], name: str, values: list[str | float | bool]) -> None:
    if name:
        attributes[name] = True if not values else values[0] if len(values) == 1 else tuple(values)


def _bare(text: str) -> str | float | bool:
    known = _WORDS.get(text.upper())
    if known is not None:
        return known
    return float(text) if _NUMBER.fullmatch(text) else text


def _where(at: Place, line: str, position: int) -> Place:
    before = line[:position]
    return Place(at.source, at.line + before.count("\n"), position - before.rfind("\n"))


def _note(
    found: list[Diagnostic], at: Place, message: str, severity: Severity = Severity.WARNING
) -> None:
    if len(found) < MAX_DIAGNOSTICS:
        found.append(Diagnostic(at, message, severity))


def _nothing(source: str, why: str) -> tuple[Cfg, list[Diagnostic]]:
    return Cfg(source, ""), [Diagnostic(Place(source, 1, 1), why)]
