"""What the names of one task stand for, as far as it can be told without running."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from sims.rapid.ast import (
    AliasDecl,
    DataDecl,
    DataKind,
    Module,
    Param,
    RecordDecl,
    RoutineDecl,
    Scope,
)
from sims.rapid.builtin import BUILTINS, OPAQUE, Legal
from sims.rapid.parser import parse_routine_head
from sims.rapid.prelude import prelude_modules

__all__ = [
    "ATOMIC",
    "SIGNALS",
    "Data",
    "Known",
    "Names",
    "Routine",
    "Types",
    "data_of",
    "predefined_types",
]

ATOMIC = frozenset({"num", "dnum", "bool", "string"})

SIGNALS = frozenset(
    {"signaldi", "signaldo", "signalai", "signalao", "signalgi", "signalgo", "signalxx"}
)

_SPECIAL = frozenset({"switch", "anytype"})


@dataclass(frozen=True, slots=True)
class Known:
    """A static type: the lower-case name behind all aliases, and the number of dimensions.

    Where a type is not certain there is None instead, and nobody complains.
    """

    name: str
    rank: int = 0

    def __str__(self) -> str:
        return self.name + ("{" + ",".join("*" * self.rank) + "}" if self.rank else "")


@dataclass(frozen=True, slots=True)
class Data:
    """Data by name. ``kind`` is None for a parameter by value and for a FOR variable."""

    name: str
    type: Known | None
    kind: DataKind | None = None
    is_loop: bool = False
    param: Param | None = None


@dataclass(frozen=True, slots=True)
class Routine:
    """``decl`` may be a head only, of a built-in."""

    decl: RoutineDecl
    legal: Legal = Legal.ANYWHERE
    is_builtin: bool = False


class Types:
    """Types by lower-case name, as one module sees them."""

    def __init__(self, outer: "Types | None" = None) -> None:
        self._outer = outer
        self._records: dict[str, RecordDecl] = {}
        self._aliases: dict[str, AliasDecl] = {}

    def add(self, decl: RecordDecl | AliasDecl) -> None:
        """Declare a type."""
        if isinstance(decl, RecordDecl):
            self._records[decl.name.lower()] = decl
        else:
            self._aliases[decl.name.lower()] = decl

    def resolve(self, name: str) -> str | None:
        """Return the lower-case name behind all aliases; None: unknown, or a circle of aliases."""
        low = name.lower()
        for _ in range(64):
            alias = self._alias(low)
            if alias is None:
                return low if self._exists(low) else None
            low = alias.type.lower()
        return None

    def record(self, name: str) -> RecordDecl | None:
        """Return a record by its resolved name."""
        found = self._records.get(name)
        return self._outer.record(name) if found is None and self._outer is not None else found

    def field_type(self, record: RecordDecl, name: str) -> str | None:
        """Return the type of a component as declared; None: there is none."""
        low = name.lower()
        return next((kind for kind, field_name in record.fields if field_name.lower() == low), None)

    def _alias(self, name: str) -> AliasDecl | None:
        if name in self._records:
            return None
        found = self._aliases.get(name)
        return self._outer._alias(name) if found is None and self._outer is not None else found

    def _exists(self, name: str) -> bool:
        return (
            name in ATOMIC | SIGNALS | _SPECIAL or name in OPAQUE or self.record(name) is not None
        )


@dataclass(slots=True)
class Names:
    """The names of a task: of its modules together, and of each module alone.

    ``signals`` None: the signals are not known. ``extra`` are names of data that the controller
    adds (mechanical units, task identities).
    """

    types: Types
    data: dict[str, Data]
    routines: dict[str, Routine]
    signals: frozenset[str] | None
    extra: frozenset[str]
    module_types: dict[str, Types] = field(default_factory=dict)
    module_data: dict[str, dict[str, Data]] = field(default_factory=dict)
    module_routines: dict[str, dict[str, Routine]] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        modules: Sequence[Module],
        signals: Collection[str] | None,
        extra: Iterable[str],
    ) -> "Names":
        """Collect all declarations; what is declared twice is the first."""
        base = _base(len(BUILTINS), len(OPAQUE))
        known = None if signals is None else frozenset(name.lower() for name in signals)
        names = cls(
            Types(base.types),
            dict(base.data),
            dict(base.routines),
            known,
            frozenset(name.lower() for name in extra),
        )
        names._add(modules)
        return names

    def _add(self, modules: Sequence[Module]) -> None:
        for module in modules:
            types = self.module_types[module.name.lower()] = Types(self.types)
            for decl in module.declarations:
                if isinstance(decl, RecordDecl | AliasDecl):
                    (types if decl.scope is Scope.LOCAL else self.types).add(decl)
        own: set[str] = set()
        for module in modules:
            key = module.name.lower()
            data = self.module_data.setdefault(key, {})
            routines = self.module_routines.setdefault(key, {})
            for decl in module.declarations:
                low = decl.name.lower()
                if isinstance(decl, DataDecl):
                    data.setdefault(low, data_of(decl, self.module_types[key]))
                elif isinstance(decl, RoutineDecl):
                    routines.setdefault(low, Routine(decl))
                if decl.scope is not Scope.LOCAL and low not in own:
                    own.add(low)
                    self._publish(low, data.get(low), routines.get(low))

    def _publish(self, low: str, data: Data | None, routine: Routine | None) -> None:
        if data is not None:
            self.data[low] = data
        if routine is not None:
            self.routines[low] = routine

    def find_data(self, module: str, name: str) -> Data | None:
        """Return data by name as a module sees it."""
        low = name.lower()
        return self.module_data.get(module.lower(), {}).get(low) or self.data.get(low)

    def find_routine(self, module: str, name: str) -> Routine | None:
        """Return a routine by name as a module sees it."""
        low = name.lower()
        return self.module_routines.get(module.lower(), {}).get(low) or self.routines.get(low)

    def types_of(self, module: str) -> Types:
        """Return the types that a module sees."""
        return self.module_types.get(module.lower(), self.types)


def data_of(decl: DataDecl, types: Types) -> Data:
    """Return what a declaration declares."""
    resolved = types.resolve(decl.type)
    known = None if resolved is None else Known(resolved, len(decl.dims))
    return Data(decl.name, known, decl.kind)


def predefined_types() -> Types:
    """Return the types that every task knows."""
    return _base(len(BUILTINS), len(OPAQUE)).types


@lru_cache(maxsize=4)
def _base(builtins: int, opaques: int) -> Names:
    """The predefined names; anew when more built-ins have been registered."""
    del builtins, opaques
    routines: Mapping[str, Routine] = {
        (head := parse_routine_head(entry.declaration)).name.lower(): Routine(
            head, entry.legal, is_builtin=True
        )
        for entry in BUILTINS
    }
    names = Names(Types(), {}, {}, None, frozenset())
    names._add(prelude_modules())
    names.routines = {**routines, **names.routines}
    for name, kind in (("errno", "num"), ("intno", "num")):
        names.data[name] = Data(name, Known(kind), DataKind.VAR)
    return names
