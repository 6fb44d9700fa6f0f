"""Types as the machine knows them: what a value looks like, and what it starts as."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Any

from sims.rapid.builtin import OPAQUE

__all__ = [
    "ANY",
    "BOOL",
    "DNUM",
    "NUM",
    "STRING",
    "SWITCH",
    "Kind",
    "Shape",
    "Type",
    "TypeTable",
    "shape_of",
]


class Kind(Enum):
    """What stands behind a type."""

    NUM = auto()
    DNUM = auto()
    BOOL = auto()
    STRING = auto()
    RECORD = auto()
    OPAQUE = auto()
    SIGNAL = auto()
    SWITCH = auto()
    ANY = auto()


@dataclass(frozen=True, eq=False, slots=True)
class Type:
    """A type without its aliases; types are compared by identity.

    ``size`` counts the scalars in a value.
    """

    name: str
    kind: Kind
    fields: "tuple[tuple[str, Type], ...]" = ()
    make: Callable[[], Any] | None = None
    size: int = 1

    def position(self, component: str) -> int | None:
        """Where a component stands."""
        wanted = component.lower()
        for k, (name, _) in enumerate(self.fields):
            if name == wanted:
                return k
        return None

    @property
    def is_number(self) -> bool:
        """Whether arithmetic is defined."""
        return self.kind in {Kind.NUM, Kind.DNUM}

    def __str__(self) -> str:
        return self.name


NUM = Type("num", Kind.NUM)
DNUM = Type("dnum", Kind.DNUM)
BOOL = Type("bool", Kind.BOOL)
STRING = Type("string", Kind.STRING)
SWITCH = Type("switch", Kind.SWITCH)
ANY = Type("anytype", Kind.ANY)

_BASIC = (NUM, DNUM, BOOL, STRING, SWITCH, ANY)
_SIGNALS = ("signalxx", "signaldi", "signaldo", "signalai", "signalao", "signalgi", "signalgo")
_OPAQUE_NAMES = (
    *("clock", "socketdev", "rawbytes", "iodev", "dir", "rmqslot", "rmqmessage", "trapdata"),
    *("datapos", "syncident", "taskid", "mecunit", "shapedata", "wztemporary", "wzstationary"),
    "egmident",
)
_SIGNAL_TYPES = {name: Type(name, Kind.SIGNAL) for name in _SIGNALS}


@dataclass(frozen=True, slots=True)
class Shape:
    """A type with dimensions. A dimension of 0 is any length (``{*}``).

    ``declared`` is the name in the declaration, lower case, aliases kept.
    """

    type: Type
    dims: tuple[int, ...] = ()
    declared: str = field(default="", compare=False)

    @property
    def is_list(self) -> bool:
        """Whether a value is a list: an array or a record."""
        return bool(self.dims) or self.type.kind is Kind.RECORD

    @property
    def size(self) -> int:
        """How many scalars a value has."""
        count = self.type.size
        for dim in self.dims:
            count *= dim
        return count

    def accepts(self, other: "Shape") -> bool:
        """Whether a value of ``other`` may be stored here."""
        if self.type is not other.type and Kind.ANY not in {self.type.kind, other.type.kind}:
            both_signals = self.type.kind is other.type.kind is Kind.SIGNAL
            widens = self.type.kind is Kind.DNUM and other.type.kind is Kind.NUM
            if not both_signals and not widens:
                return False
        if Kind.ANY in {self.type.kind, other.type.kind}:
            return True
        return len(self.dims) == len(other.dims) and all(
            mine in {0, theirs} or theirs == 0
            for mine, theirs in zip(self.dims, other.dims, strict=True)
        )

    def __str__(self) -> str:
        name = self.declared or self.type.name
        dims = ",".join(str(dim) if dim else "*" for dim in self.dims)
        return f"{name}{{{dims}}}" if dims else name


def shape_of(kind: Type) -> Shape:
    """Return the shape of a scalar."""
    return Shape(kind, (), kind.name)


class TypeTable:
    """The types that one scope can name; what is not here is looked up in ``outer``."""

    def __init__(self, outer: "TypeTable | None" = None) -> None:
        self._outer = outer
        self._types: dict[str, Type] = {}
        if outer is None:
            self._types = {kind.name: kind for kind in _BASIC} | _SIGNAL_TYPES
            for name, make in (dict.fromkeys(_OPAQUE_NAMES) | OPAQUE).items():
                self._types[name] = Type(name, Kind.OPAQUE, make=make)

    def find(self, name: str) -> Type | None:
        """Return the type of this name, aliases resolved."""
        found = self._types.get(name.lower())
        if found is None and self._outer is not None:
            return self._outer.find(name)
        return found

    def add_record(self, name: str, fields: Iterable[tuple[str, Type]]) -> Type:
        """Define a record of components (name, type)."""
        parts = tuple((part.lower(), kind) for part, kind in fields)
        record = Type(name.lower(), Kind.RECORD, parts, size=sum(kind.size for _, kind in parts))
        self._types[record.name] = record
        return record

    def add_alias(self, name: str, kind: Type) -> None:
        """Define another name for a type."""
        self._types[name.lower()] = kind

    def __contains__(self, name: str) -> bool:
        return name.lower() in self._types
