"""One task's program: its modules brought together, checked and linked."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Any

from sims.rapid import ast, values
from sims.rapid.ast import Module, Place, RoutineKind, Scope
from sims.rapid.compile import compile_routine, evaluate
from sims.rapid.compile.folding import fold
from sims.rapid.data import ABSENT, Cell, Element, Pers
from sims.rapid.errors import Diagnostic, RapidError, RapidLoadError
from sims.rapid.host import Signal
from sims.rapid.names import why_unsupported
from sims.rapid.parser import parse_expression, parse_text
from sims.rapid.prelude import prelude_modules
from sims.rapid.symbols import (
    BuiltinRoutine,
    Datum,
    LinkError,
    ModuleScope,
    Routine,
    builtin_routines,
)
from sims.rapid.types import NUM, Shape, TypeTable

__all__ = ["Program", "SharedData"]

SharedData = dict[str, Pers]

_NUMBER = Shape(NUM, (), "num")


class Program:
    """The names and the code of one task.

    ``extra`` is data that the system adds, as (type, name).
    ``shared`` are the persistents of all tasks, by lower-case name. ``common`` is what all
    compiled code can name, ``namespace`` what the modules added last can; it goes with them.
    """

    def __init__(
        self,
        *,
        signals: Mapping[str, Signal],
        shared: SharedData,
        overrides: Mapping[str, str] | None = None,
        extra: Sequence[tuple[str, str]] = (),
    ) -> None:
        self.signals = signals
        self.types = TypeTable()
        self.data: dict[str, Datum] = {}
        self.routines: dict[str, Routine] = {}
        self.modules: dict[str, ModuleScope] = {}
        self.builtins: Mapping[str, BuiltinRoutine] = {}
        self.common: dict[str, Any] = dict(_HELPERS)
        self.namespace: dict[str, Any] = {}
        self._shared = shared
        self._bound: dict[int, str] = {}
        self._overrides = {name.lower(): text for name, text in (overrides or {}).items()}
        self._used_overrides: set[str] = set()
        self._error_names: dict[int, str] = {}
        for tree in (*prelude_modules(), *_state_modules(tuple(extra))):
            problems = self._declare(ModuleScope(tree, self, is_predefined=True))
            if problems:
                raise RapidLoadError(problems)
        self.builtins = builtin_routines(self.types)

    # Loading.

    def add(self, modules: Iterable[Module]) -> list[Diagnostic]:
        """Declare modules and link them; return all that is wrong."""
        self.namespace, self._bound = dict(self.common), {}
        problems: list[Diagnostic] = []
        scopes = []
        for tree in modules:
            scope = ModuleScope(tree, self)
            problems += self._declare(scope)
            scopes.append(scope)
        problems += [problem for scope in scopes for problem in self._link(scope)]
        problems += [
            Diagnostic(Place("<override>", 1, 1), f"there is no data {name} to override")
            for name in sorted(set(self._overrides) - self._used_overrides)
        ]
        return problems

    def remove(self, name: str) -> bool:
        """Forget a module; whether it was there."""
        scope = self.modules.pop(name.lower(), None)
        if scope is None:
            return False
        for table in (self.data, self.routines):
            for key in [key for key, entry in table.items() if entry.module is scope]:
                del table[key]
        return True

    def reset(self) -> None:
        """Give all variables their initial values."""
        for scope in self.modules.values():
            for datum in scope.data.values():
                datum.reset()

    def _declare(self, scope: ModuleScope) -> list[Diagnostic]:
        key = scope.name.lower()
        if key in self.modules:
            return [Diagnostic(scope.tree.at, f"the module {scope.name} is loaded twice")]
        self.modules[key] = scope
        problems: list[Diagnostic] = []
        problems += _declare_types(scope, self.types)
        for decl in scope.declarations():
            try:
                if isinstance(decl, ast.DataDecl):
                    self._add_data(scope, decl)
                elif isinstance(decl, ast.RoutineDecl):
                    self._add_routine(scope, decl)
            except LinkError as error:
                problems.append(error.diagnostic)
        return problems

    def _add_data(self, scope: ModuleScope, decl: ast.DataDecl) -> None:
        key = decl.name.lower()
        if key in scope.data or key in scope.routines:
            raise LinkError(decl.at, f"{decl.name} is declared twice in {scope.name}")
        datum = scope.data[key] = Datum(decl, scope)
        if decl.scope is not Scope.LOCAL:
            self._check_unique(key, decl)
            self.data[key] = datum

    def _add_routine(self, scope: ModuleScope, decl: ast.RoutineDecl) -> None:
        key = decl.name.lower()
        if key in scope.data or key in scope.routines:
            raise LinkError(decl.at, f"{decl.name} is declared twice in {scope.name}")
        result = None
        if decl.kind is RoutineKind.FUNC and decl.type is not None:
            kind = scope.find_type(decl.type, decl.at)
            result = Shape(kind, (), decl.type.lower())
        routine = Routine(decl, scope, scope.params(decl.params), result)
        scope.routines[key] = routine
        if decl.scope is not Scope.LOCAL:
            self._check_unique(key, decl)
            self.routines[key] = routine

    def _check_unique(self, key: str, decl: ast.DataDecl | ast.RoutineDecl) -> None:
        for entry in (self.data.get(key), self.routines.get(key)):
            if entry is not None and not entry.module.is_predefined:
                raise LinkError(
                    decl.at,
                    f"{decl.name} is declared in {entry.module.name} too: make one of them LOCAL",
                )

    def _link(self, scope: ModuleScope) -> list[Diagnostic]:
        problems: list[Diagnostic] = []
        for datum in scope.data.values():
            try:
                _ = datum.cell
            except LinkError as error:
                problems.append(error.diagnostic)
        for routine in scope.routines.values():
            routine.code, errors = compile_routine(routine)
            problems += [error.diagnostic for error in errors]
        return problems

    # What the compiler asks.

    def bind(self, prefix: str, thing: Any) -> str:
        """Return the name by which compiled code knows a thing."""
        name = self._bound.get(id(thing))
        if name is None:
            name = f"{prefix}{len(self._bound)}"
            self._bound[id(thing)] = name
            self.namespace[name] = thing
        return name

    def bind_cell(self, cell: Cell) -> str:
        """Return the name of a cell."""
        return self.bind("g", cell)

    def evaluate(self, expr: ast.Expr, module: ModuleScope, shape: Shape) -> Any:
        """Return the value of an expression at load. Raises ``LinkError``."""
        done, value = fold(expr, shape)
        if done:
            return value
        try:
            return evaluate(expr, module, shape)
        except (RapidError, ZeroDivisionError) as error:
            raise LinkError(expr.at, f"this cannot be evaluated at load: {error}") from error
        except RecursionError:
            raise LinkError(expr.at, "constants depend on each other too deeply") from None

    def evaluate_number(self, expr: ast.Expr, module: ModuleScope) -> float:
        """Return a constant number. Raises ``LinkError``."""
        value: float = self.evaluate(expr, module, _NUMBER)
        return value

    def override(self, decl: ast.DataDecl, module: str) -> ast.Expr | None:
        """Return what replaces the initial value of data, if anything does."""
        for key in (f"{module}:{decl.name}".lower(), decl.name.lower()):
            if key in self._overrides:
                self._used_overrides.add(key)
                return parse_expression(self._overrides[key], f"<override {decl.name}>")
        return None

    def share(self, pers: Pers, at: Place, *, has_value: bool) -> Pers:
        """Return the persistent of this name that all tasks share. Raises ``LinkError``."""
        key = pers.name.lower()
        known = self._shared.get(key)
        if known is None:
            pers.has_value = has_value
            self._shared[key] = pers
            return pers
        if known.shape.type.name != pers.shape.type.name or known.shape.dims != pers.shape.dims:
            raise LinkError(
                at, f"{pers.name} is a {known.shape} in another task: use one type in all tasks"
            )
        if has_value and not known.has_value:
            known.value, known.has_value = pers.value, True
        return known

    def refuses(self, name: str) -> str:
        """Return why a procedure that is not there never will be, or nothing."""
        return why_unsupported(name) or ""

    # Looking up.

    def find_cell(self, name: str) -> Cell | None:
        """Global data by name, in any spelling; ``module:name`` for local data too."""
        module, _, rest = name.lower().rpartition(":")
        if module:
            scope = self.modules.get(module)
            datum = scope.data.get(rest) if scope is not None else None
        else:
            datum = self.data.get(rest)
        return datum.cell if datum is not None else None

    def error_name(self, number: int) -> str:
        """Return the ``ERR_`` name behind a number, or nothing."""
        if not self._error_names:
            for key, datum in self.data.items():
                if key.startswith("err_") and datum.module.is_predefined:
                    self._error_names.setdefault(int(datum.cell.value), datum.decl.name)
        return self._error_names.get(number, "")

    def error_number(self, name: str) -> int:
        """Return the number behind an ``ERR_`` name; 0 if there is none."""
        cell = self.find_cell(name)
        return int(cell.value) if cell is not None and cell.base == "num" else 0


@lru_cache(maxsize=64)
def _state_modules(extra: tuple[tuple[str, str], ...]) -> tuple[Module, ...]:
    """What the machine tells the program, and data that the system adds."""
    added = "".join(f"VAR {kind} {name};\n" for kind, name in extra)
    text = f"MODULE PRELUDE_STATE\nVAR errnum ERRNO;\nVAR intnum INTNO;\n{added}ENDMODULE"
    return tuple(parse_text(text, "<state>")[0])


def _declare_types(scope: ModuleScope, shared: TypeTable) -> list[Diagnostic]:
    """Declare records and aliases, in whatever order they refer to each other."""
    problems: list[Diagnostic] = []
    waiting = [d for d in scope.declarations() if isinstance(d, ast.RecordDecl | ast.AliasDecl)]
    while waiting:
        left = []
        for decl in waiting:
            table = scope.types if decl.scope is Scope.LOCAL else shared
            if not _declare_type(decl, table, scope):
                left.append(decl)
        if len(left) == len(waiting):
            problems += [
                Diagnostic(decl.at, f"{decl.name} uses a type that is not known, or itself")
                for decl in left
            ]
            break
        waiting = left
    return problems


def _declare_type(
    decl: ast.RecordDecl | ast.AliasDecl, table: TypeTable, scope: ModuleScope
) -> bool:
    if isinstance(decl, ast.AliasDecl):
        kind = scope.types.find(decl.type)
        if kind is not None:
            table.add_alias(decl.name, kind)
        return kind is not None
    kinds = [scope.types.find(name) for name, _ in decl.fields]
    fields = [
        (name, kind) for (_, name), kind in zip(decl.fields, kinds, strict=True) if kind is not None
    ]
    if len(fields) < len(kinds):
        return False
    table.add_record(decl.name, fields)
    return True


def _signal(signal: Any) -> Signal:
    if signal is None:
        raise RapidError("ERR_NO_ALIASIO_DEF", "the signal variable is not connected: use AliasIO")
    found: Signal = signal
    return found


def _given(value: Any) -> Any:
    if value is ABSENT:
        return ABSENT.value
    return value


def _keep(value: Any) -> Any:
    return values.copy(value) if type(value) is list else value


def _fit(value: Any, shape: Shape) -> Any:
    _check_length(value, shape.dims)
    return value


def _check_length(value: Any, dims: Sequence[int]) -> None:
    if dims:
        if dims[0] and len(value) != dims[0]:
            raise RapidError("ERR_ILLDIM", f"{dims[0]} values are needed, not {len(value)}")
        for item in value:
            _check_length(item, dims[1:])


_HELPERS: dict[str, Callable[..., Any] | object] = {
    "_round": values.binary32,
    "_round64": values.binary64,
    "_join": values.concatenate,
    "_div": values.divide_whole,
    "_mod": values.modulo,
    "_element": values.element,
    "_put": values.put,
    "_copy": values.copy,
    "_keep": _keep,
    "_plus": values.plus_pos,
    "_minus": values.minus_pos,
    "_cross": values.cross,
    "_scale": values.scale,
    "_shrink": values.shrink,
    "_link": values.link,
    "_convert": values.convert,
    "_fit": _fit,
    "_signal": _signal,
    "_given": _given,
    "_ref": Element,
    "_Cell": Cell,
    "_N": ABSENT,
}
