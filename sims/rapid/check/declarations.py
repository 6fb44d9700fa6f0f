"""Declarations: types, dimensions, initial values, names that stand twice."""

from collections.abc import Mapping, Sequence

from sims.rapid.ast import (
    AliasDecl,
    DataDecl,
    DataKind,
    Expr,
    Module,
    Name,
    Number,
    RecordDecl,
    Scope,
)
from sims.rapid.check.expressions import NUM, Expressions
from sims.rapid.check.scope import Known, Types, predefined_types
from sims.rapid.errors import Diagnostic, Severity
from sims.rapid.names import why_unsupported

__all__ = ["check_data", "check_record", "check_twice", "check_with_others"]

_MAX_RANK = 3


def check_data(decl: DataDecl, expressions: Expressions) -> None:
    """Check type, dimensions and initial value."""
    resolved = expressions.types.resolve(decl.type)
    if resolved is None:
        _unknown_type(decl, decl.type, expressions)
    if len(decl.dims) > _MAX_RANK:
        expressions.error(decl.at, f"{decl.name} has {len(decl.dims)} dimensions; 3 are possible")
    for dim in decl.dims:
        _check_dimension(dim, expressions)
    if decl.value is not None:
        wanted = None if resolved is None else Known(resolved, len(decl.dims))
        expressions.expect(decl.value, wanted, f"the value of {decl.name}")


def _check_dimension(dim: Expr, expressions: Expressions) -> None:
    expressions.expect(dim, NUM, "a dimension")
    if isinstance(dim, Number) and (dim.value != int(dim.value) or dim.value < 1):
        expressions.error(dim.at, f"a dimension is a whole number from 1, not {dim.text}")
    if isinstance(dim, Name):
        data = expressions.find(dim.name)
        if data is not None and data.kind is not DataKind.CONST:
            expressions.error(dim.at, f"{dim.name} is not a CONST: an array's size is fixed")


def _unknown_type(decl: DataDecl | RecordDecl | AliasDecl, name: str, into: Expressions) -> None:
    why = why_unsupported(name)
    into.error(decl.at, why or f"the type {name} is not known: declare it, or load its module")


def check_record(decl: RecordDecl | AliasDecl, expressions: Expressions) -> None:
    """Check the types of components, and that a record does not hold itself."""
    types = expressions.types
    if isinstance(decl, AliasDecl):
        if types.resolve(decl.type) is None:
            _unknown_type(decl, decl.type, expressions)
        return
    seen: set[str] = set()
    for kind, name in decl.fields:
        if types.resolve(kind) is None:
            _unknown_type(decl, kind, expressions)
        if name.lower() in seen:
            expressions.error(decl.at, f"{decl.name} has two components {name}: rename one")
        seen.add(name.lower())
    if _holds(types, decl.name.lower(), decl, set()):
        expressions.error(decl.at, f"{decl.name} holds itself: a record has to end somewhere")


def _holds(types: Types, wanted: str, record: RecordDecl, seen: set[str]) -> bool:
    """Whether a record holds a type, at any depth."""
    waiting = [record]
    while waiting:
        for kind, _ in waiting.pop().fields:
            resolved = types.resolve(kind)
            if resolved == wanted:
                return True
            inner = None if resolved is None else types.record(resolved)
            if inner is not None and resolved not in seen:
                seen.add(resolved or "")
                waiting.append(inner)
    return False


def check_twice(modules: Sequence[Module], *, same_task: bool = True) -> list[Diagnostic]:
    """Find names that stand twice in a module, or in two modules of one task."""
    between = Severity.ERROR if same_task else Severity.WARNING
    found: list[Diagnostic] = []
    everywhere: dict[str, str] = {}
    loaded: dict[str, Module] = {}
    for module in modules:
        if module.name.lower() in loaded:
            why = f"the module {module.name} is loaded twice"
            found.append(Diagnostic(module.at, why, between))
            continue
        loaded[module.name.lower()] = module
        own: dict[str, int] = {}
        for decl in module.declarations:
            low = decl.name.lower()
            if low in own:
                why = f"{decl.name} is declared already in line {own[low]}: rename one"
                found.append(Diagnostic(decl.at, why))
                continue
            own[low] = decl.at.line
            if decl.scope is Scope.LOCAL:
                continue
            if low in everywhere:
                why = f"{decl.name} is declared in {everywhere[low]} too: make one LOCAL"
                found.append(Diagnostic(decl.at, why, between))
            everywhere.setdefault(low, module.name)
    return found


def check_with_others(
    modules: Sequence[Module], others: Mapping[str, Sequence[Module]]
) -> list[Diagnostic]:
    """Find persistents that another task declares with another type."""
    known: dict[str, tuple[DataDecl, str, str]] = {}
    for task, theirs in others.items():
        types = _aliases(theirs)
        for decl in _shared(theirs):
            known.setdefault(decl.name.lower(), (decl, types.resolve(decl.type) or "", task))
    found: list[Diagnostic] = []
    types = _aliases(modules)
    for decl in _shared(modules):
        resolved = types.resolve(decl.type)
        other, their_type, task = known.get(decl.name.lower(), (decl, resolved, ""))
        is_certain = bool(resolved and their_type)
        if is_certain and (their_type, len(other.dims)) != (resolved, len(decl.dims)):
            why = f"{decl.name} is a {decl.type} here and a {other.type} in task {task}"
            found.append(Diagnostic(decl.at, f"{why}: use one type, or TASK PERS"))
    return found


def _aliases(modules: Sequence[Module]) -> Types:
    types = Types(predefined_types())
    for module in modules:
        for decl in module.declarations:
            if isinstance(decl, RecordDecl | AliasDecl):
                types.add(decl)
    return types


def _shared(modules: Sequence[Module]) -> list[DataDecl]:
    declared = [decl for module in modules for decl in module.declarations]
    return [
        decl
        for decl in declared
        if isinstance(decl, DataDecl) and decl.kind is DataKind.PERS and decl.scope is Scope.GLOBAL
    ]
