"""What type an expression has, and what is wrong in it for certain."""

from collections.abc import Callable, Sequence

from sims.rapid.ast import (
    Aggregate,
    Binary,
    BoolLiteral,
    Call,
    Expr,
    Field,
    Index,
    Name,
    Number,
    Place,
    RoutineKind,
    StringLiteral,
    Unary,
)
from sims.rapid.check.scope import ATOMIC, SIGNALS, Data, Known, Names
from sims.rapid.errors import Diagnostic, Severity
from sims.rapid.names import why_unsupported

__all__ = ["BOOL", "NUM", "Expressions", "fits"]

NUM = Known("num")
BOOL = Known("bool")
STRING = Known("string")

_NUMBERS = {"num", "dnum"}
_COMPARED = {"=", "<>", "<", "<=", ">", ">="}
_LOGICAL = {"AND", "OR", "XOR"}


def fits(wanted: Known | None, given: Known | None) -> bool:
    """Whether a value may be stored; True when that is not certain."""
    if wanted is None or given is None:
        return True
    names = {wanted.name, given.name}
    if "anytype" in names or "switch" in names:
        return True
    if names & SIGNALS:
        return names <= SIGNALS | _NUMBERS
    if names <= _NUMBERS:
        return wanted.rank == given.rank
    return wanted == given


class Expressions:
    """Walks expressions of one module; ``locals`` are the innermost names first."""

    def __init__(
        self, module: str, names: Names, found: list[Diagnostic], lines: Sequence[str] = ()
    ) -> None:
        self.module = module
        self.lines = lines
        self.names = names
        self.types = names.types_of(module)
        self.found = found
        self.locals: list[dict[str, Data]] = []
        self.check_call: Callable[[Call], Known | None] = lambda _: None

    def error(self, at: Place, message: str) -> None:
        """Note what keeps the module from being loaded."""
        self.found.append(Diagnostic(at, message))

    def warn(self, at: Place, message: str) -> None:
        """Note what may go wrong when it is reached."""
        self.found.append(Diagnostic(at, message, Severity.WARNING))

    def find(self, name: str) -> Data | None:
        """Return data by name, inner names first."""
        low = name.lower()
        for scope in reversed(self.locals):
            if low in scope:
                return scope[low]
        return self.names.find_data(self.module, low)

    def type_of(self, expr: Expr, wanted: Known | None = None) -> Known | None:
        """Return the type of an expression; ``wanted`` gives an aggregate its meaning."""
        match expr:
            case Number():
                return Known("dnum") if wanted == Known("dnum") else NUM
            case StringLiteral():
                return STRING
            case BoolLiteral():
                return BOOL
            case Name():
                return self._name(expr)
            case Aggregate():
                return self._aggregate(expr, wanted)
            case Field():
                return self._field(expr)
            case Index():
                return self._index(expr)
            case Unary():
                return self._unary(expr)
            case Binary():
                return self._binary(expr)
            case Call():
                return self.check_call(expr)

    def expect(self, expr: Expr, wanted: Known | None, what: str) -> None:
        """Check that an expression is of a type."""
        given = self.type_of(expr, wanted)
        if not fits(wanted, given):
            self.error(expr.at, f"{what} is {_a(wanted)}, this is {_a(given)}")

    def condition(self, expr: Expr) -> None:
        """Check that an expression is a bool."""
        given = self.type_of(expr)
        if given is not None and given.name not in SIGNALS and not fits(BOOL, given):
            self.error(expr.at, f"a condition is a bool, this is {_a(given)}: compare it")

    def _name(self, expr: Name) -> Known | None:
        data = self.find(expr.name)
        if data is not None:
            return data.type
        low = expr.name.lower()
        names = self.names
        if low in names.extra or (names.signals is not None and low in names.signals):
            return None
        routine = names.find_routine(self.module, low)
        if routine is not None:
            hint = "call it with ()" if routine.decl.kind is RoutineKind.FUNC else "it has no value"
            self.error(expr.at, f"{expr.name} is a {routine.decl.kind}: {hint}")
        elif (why := why_unsupported(expr.name)) is not None:
            self.error(expr.at, why)
        elif names.signals is None:
            self.warn(expr.at, f"{expr.name} is not declared: it has to be a signal")
        else:
            self.error(expr.at, f"{expr.name} is not known: declare it, or configure the signal")
        return None

    def _aggregate(self, expr: Aggregate, wanted: Known | None) -> Known | None:
        inner = self._inner_types(expr, wanted)
        for item, kind in zip(expr.items, inner, strict=True):
            self.expect(item, kind, "this component")
        return wanted

    def _inner_types(self, expr: Aggregate, wanted: Known | None) -> list[Known | None]:
        count = len(expr.items)
        if wanted is None:
            return [None] * count
        if wanted.rank:
            return [Known(wanted.name, wanted.rank - 1)] * count
        record = self.types.record(wanted.name)
        if record is None:
            if wanted.name in ATOMIC:
                self.error(expr.at, f"{_a(wanted)} is needed, this is an aggregate")
            return [None] * count
        if len(record.fields) != count:
            self.error(
                expr.at, f"{record.name} has {len(record.fields)} components, here are {count}"
            )
            return [None] * count
        return [self._known(kind) for kind, _ in record.fields]

    def _known(self, name: str) -> Known | None:
        resolved = self.types.resolve(name)
        return None if resolved is None else Known(resolved)

    def _field(self, expr: Field) -> Known | None:
        base = self.type_of(expr.base)
        if base is None or base.name in {"anytype", "switch"}:
            return None
        if base.rank:
            self.error(
                expr.at, f"an array has no component {expr.name}: choose an element with {{}}"
            )
            return None
        record = self.types.record(base.name)
        if record is None:
            if base.name in ATOMIC:
                self.error(expr.at, f"{_a(base)} has no components, so no {expr.name}")
            return None
        kind = self.types.field_type(record, expr.name)
        if kind is None:
            known = ", ".join(name for _, name in record.fields)
            self.error(expr.at, f"{record.name} has no component {expr.name}; it has {known}")
            return None
        return self._known(kind)

    def _index(self, expr: Index) -> Known | None:
        base = self.type_of(expr.base)
        for index in expr.indices:
            if index is not None:
                self.expect(index, NUM, "an index")
        if base is None or base.name in {"anytype", "switch"}:
            return None
        fixed = sum(index is not None for index in expr.indices)
        if len(expr.indices) != base.rank:
            shown = f"an array of {base.rank} dimensions" if base.rank else "no array"
            self.error(expr.at, f"{len(expr.indices)} indices, and this is {shown}")
            return None
        return Known(base.name, base.rank - fixed)

    def _unary(self, expr: Unary) -> Known | None:
        if expr.op == "NOT":
            if _is_doubtful(expr, self.lines):
                self.warn(
                    expr.at,
                    "NOT negates all that AND joins here: write NOT (... AND ...), or (NOT ...) "
                    "AND ... if only the first part is meant",
                )
            self.condition(expr.operand)
            return BOOL
        given = self.type_of(expr.operand)
        if given is not None and (given.name in {"bool", "string"} or given.rank):
            self.error(expr.at, f"{_a(given)} has no sign")
            return None
        return given if given is not None and given.name not in SIGNALS else None

    def _binary(self, expr: Binary) -> Known | None:
        if expr.op in _LOGICAL:
            self.condition(expr.left)
            self.condition(expr.right)
            return BOOL
        left = self.type_of(expr.left)
        right = self.type_of(expr.right)
        if expr.op in _COMPARED:
            if not fits(left, right):
                self.error(expr.at, f"{_a(left)} cannot be compared with {_a(right)}")
            return BOOL
        return self._arithmetic(expr, left, right)

    def _arithmetic(self, expr: Binary, left: Known | None, right: Known | None) -> Known | None:
        if left is None or right is None or (left.name in SIGNALS) or (right.name in SIGNALS):
            return None
        pair = {left.name, right.name}
        is_plain = left.rank == right.rank == 0
        if is_plain and pair <= _NUMBERS:
            return left if left == right else None
        if is_plain and left == right and _is_defined(expr.op, left.name):
            return left
        if is_plain and pair == {"num", "pos"} and expr.op in ("*", "/"):
            return Known("pos")
        if is_plain and not pair & (ATOMIC | {"pos", "orient"}):
            return None
        self.error(expr.at, f"{_a(left)} {expr.op} {_a(right)} is not defined")
        return None


def _is_doubtful(negation: Unary, lines: Sequence[str]) -> bool:
    """Whether ``NOT a AND b`` stands without parentheses around what AND joins."""
    inner = negation.operand
    if not isinstance(inner, Binary) or inner.op != "AND" or inner.at.line != negation.at.line:
        return False
    if not 1 <= negation.at.line <= len(lines):
        return False
    depth = 0
    between = lines[negation.at.line - 1][negation.at.column + 2 : inner.at.column - 1]
    for char in between:
        depth += (char == "(") - (char == ")")
    return depth <= 0


def _is_defined(op: str, name: str) -> bool:
    return (name, op) in {
        ("string", "+"),
        ("pos", "+"),
        ("pos", "-"),
        ("pos", "*"),
        ("orient", "*"),
    }


def _a(known: Known | None) -> str:
    return "unknown" if known is None else f"a {known}" if known.name[0] != "o" else f"an {known}"
