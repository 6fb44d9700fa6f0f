"""Backends and address schemes by name: ours, and those that other packages add.

A third party's package declares entry points in the groups ``binpick.backends`` (each a
``Backend``), ``binpick.schemes`` (each a ``Scheme``) and ``binpick.suites`` (each a conformance
suite's ``module:class``); nothing else is needed for the cell file, ``binpick devices`` and
``binpick conformance`` to know them.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any, Self

from hal.errors import ConfigError

__all__ = ["Address", "Backend", "Kind", "Registry", "Scheme"]


class Kind(StrEnum):
    """Which interface of ``hal`` a backend implements."""

    CAMERA = "camera"
    PROJECTOR = "projector"
    ROBOT = "robot"
    GRIPPER = "gripper"
    VACUUM = "vacuum"
    IO = "io"


def _load(target: str) -> Any:
    module, _, name = target.partition(":")
    return getattr(import_module(module), name)


@dataclass(frozen=True)
class Backend:
    """A device implementation: ``target`` is ``module:factory``, imported when asked for.

    The factory takes the opened address as its only positional argument and the rest of the
    cell file's section as keywords. ``needs`` says what must be installed or plugged in.
    """

    kind: Kind
    target: str
    scheme: str
    needs: str = ""

    def load(self, name: str) -> Any:
        """Import the factory.

        Raises
        ------
        ConfigError
            Its package or SDK is missing; says what it needs.
        """
        try:
            return _load(self.target)
        except ImportError as error:
            raise ConfigError(
                f"needs {self.needs or self.target} ({error})", source="backend", key=name
            ) from error


@dataclass(frozen=True)
class Scheme:
    """An address scheme: ``target`` is ``module:opener``, called with the address' rest."""

    target: str
    example: str


@dataclass(frozen=True)
class Address:
    """``scheme:rest``, such as ``tcp:192.168.125.1:5000`` or ``sim:``."""

    scheme: str
    rest: str

    @classmethod
    def parse(cls, text: str, *, known: Iterable[str]) -> Self:
        """Split an address.

        Raises
        ------
        ConfigError
            No scheme, or one that nobody registered; names the ones there are.
        """
        scheme, colon, rest = text.partition(":")
        names = sorted(known)
        if not colon or scheme not in names:
            raise ConfigError(f"address {text!r} must begin with one of {', '.join(names)}")
        return cls(scheme, rest)


class Registry:
    """Names to backends and schemes; later tables may add names, never replace them."""

    def __init__(
        self,
        *backends: Mapping[str, Backend],
        schemes: Iterable[Mapping[str, Scheme]] = (),
        suites: Iterable[Mapping[str, str]] = (),
    ) -> None:
        self.backends: dict[str, Backend] = {}
        self.schemes: dict[str, Scheme] = {}
        self.suites: dict[str, str] = {}
        self.broken: dict[str, str] = {}
        for table in backends:
            for name, backend in table.items():
                _add(self.backends, name, backend)
        for scheme_table in schemes:
            for name, scheme in scheme_table.items():
                _add(self.schemes, name, scheme)

        for suite_table in suites:
            for name, target in suite_table.items():
                _add(self.suites, name, target)

    def add_installed(self) -> Self:
        """Add what other installed packages declare as entry points."""
        for group, table in (("backends", self.backends), ("schemes", self.schemes)):
            for point in entry_points(group=f"binpick.{group}"):
                # A stranger's broken package is an error about its own device, when asked for.
                try:
                    _add(table, point.name, point.load())
                except Exception as error:
                    self.broken[point.name] = f"{point.value}: {error}"
        for point in entry_points(group="binpick.suites"):
            _add(self.suites, point.name, point.value)
        return self

    def backend(self, name: str, kind: Kind) -> Backend:
        """Look a backend up.

        Raises
        ------
        ConfigError
            Unknown, or of another kind; names the ones that would do.
        """
        backend = self.backends.get(name)
        if backend is None and name in self.broken:
            raise ConfigError(f"{name!r} cannot be loaded: {self.broken[name]}")
        if backend is None or backend.kind is not kind:
            fitting = sorted(n for n, b in self.backends.items() if b.kind is kind)
            problem = f"is a {backend.kind}" if backend else "is unknown"
            raise ConfigError(f"{name!r} {problem}; known {kind}s: {', '.join(fitting) or 'none'}")
        return backend

    def opener(self, address: Address) -> Any:
        """Import the function that opens addresses of this scheme."""
        return _load(self.schemes[address.scheme].target)


def _add(table: dict[str, Any], name: str, entry: Any) -> None:
    if name in table:
        raise ConfigError("is registered twice", source="registry", key=name)
    table[name] = entry
