"""Arguments against parameters."""

from collections.abc import Sequence

from sims.rapid.ast import (
    Argument,
    Call,
    DataKind,
    Expr,
    Field,
    Index,
    Mode,
    Name,
    Param,
    Place,
    RoutineKind,
)
from sims.rapid.builtin import Legal, TaskKind
from sims.rapid.check.expressions import BOOL, NUM, Expressions, fits
from sims.rapid.check.scope import Data, Known, Routine
from sims.rapid.names import why_unsupported

__all__ = ["Calls"]

# Functions about the parameters of their caller: the language's own, not a library's.
_INTRINSIC = {"dim": NUM, "ispers": BOOL, "isvar": BOOL}


class Calls:
    """Checks calls of one module, in a task of a kind."""

    def __init__(self, expressions: Expressions, kind: TaskKind, has_motion: bool) -> None:
        self.expressions = expressions
        self.kind = kind
        self.has_motion = has_motion
        expressions.check_call = self.function

    def function(self, call: Call) -> Known | None:
        """Check a call in an expression and return the type of its result."""
        if call.name.lower() == "present":
            self._present(call)
            return BOOL
        routine = self._routine(call.at, call.name, "function", call.arguments)
        if routine is None:
            return _INTRINSIC.get(call.name.lower())
        decl = routine.decl
        if decl.kind is not RoutineKind.FUNC:
            self.expressions.error(call.at, f"{call.name} is a {decl.kind} and has no value")
            return None
        self._match(routine, call.arguments, call.at)
        types = self.expressions.types
        resolved = None if decl.type is None else types.resolve(decl.type)
        return None if resolved in (None, "anytype") else Known(resolved or "")

    def procedure(self, at: Place, name: str, arguments: Sequence[Argument]) -> None:
        """Check a call as a statement."""
        routine = self._routine(at, name, "procedure", arguments)
        if routine is None:
            return
        if routine.decl.kind is not RoutineKind.PROC:
            hint = "use its value" if routine.decl.kind is RoutineKind.FUNC else "CONNECT it"
            self.expressions.error(at, f"{name} is a {routine.decl.kind}, not a PROC: {hint}")
            return
        self._legal(at, name, routine)
        self._match(routine, arguments, at)

    def any_arguments(self, arguments: Sequence[Argument]) -> None:
        """Check the expressions alone, where what is called is not known."""
        for argument in arguments:
            if argument.value is not None:
                self.expressions.type_of(argument.value)

    def _routine(
        self, at: Place, name: str, what: str, arguments: Sequence[Argument]
    ) -> Routine | None:
        expressions = self.expressions
        routine = expressions.names.find_routine(expressions.module, name)
        if routine is not None:
            return routine
        self.any_arguments(arguments)
        if what == "function" and name.lower() in _INTRINSIC:
            return None
        if expressions.find(name) is not None:
            expressions.error(at, f"{name} is data, not a {what}")
        elif (why := why_unsupported(name)) is not None:
            expressions.error(at, why)
        else:
            expressions.warn(
                at, f"the {what} {name} is not known: ERR_REFUNKPRC when the call is reached"
            )
        return None

    def _legal(self, at: Place, name: str, routine: Routine) -> None:
        legal = routine.legal
        is_wrong = (
            (legal is Legal.MOTION and not self.has_motion)
            or (legal is Legal.NORMAL and self.kind is not TaskKind.NORMAL)
            or (legal is Legal.BACKGROUND and self.has_motion)
        )
        if is_wrong:
            motion = "with" if self.has_motion else "without"
            self.expressions.warn(
                at, f"{name} is legal {legal}; this one is {self.kind} {motion} motion"
            )

    def _present(self, call: Call) -> None:
        expressions = self.expressions
        value = call.arguments[0].value if len(call.arguments) == 1 else None
        data = expressions.find(value.name) if isinstance(value, Name) else None
        if data is None or data.param is None:
            expressions.error(
                call.at, "Present() asks about one optional parameter of its own routine"
            )

    def _match(self, routine: Routine, arguments: Sequence[Argument], at: Place) -> None:
        decl = routine.decl
        required = [param for param in decl.params if not param.is_optional]
        by_name = {param.name.lower(): param for param in decl.params}
        given: dict[str, Argument] = {}
        for argument in arguments:
            param = self._parameter(argument, by_name, required, given)
            if param is None:
                self._stranger(argument, decl.name, decl.params)
                continue
            given[param.name.lower()] = argument
            self._argument(decl.name, param, argument)
        missing = [param.name for param in required if param.name.lower() not in given]
        if missing:
            self.expressions.error(at, f"{decl.name} needs {', '.join(missing)} as well")
        self._groups(decl.name, decl.params, given)

    def _parameter(
        self,
        argument: Argument,
        by_name: dict[str, Param],
        required: list[Param],
        given: dict[str, Argument],
    ) -> Param | None:
        if argument.name is None:
            return next((p for p in required if p.name.lower() not in given), None)
        param = by_name.get(argument.name.lower())
        if param is not None and param.name.lower() in given:
            self.expressions.error(argument.at, f"{param.name} is given twice")
        return param

    def _stranger(self, argument: Argument, callee: str, params: Sequence[Param]) -> None:
        if argument.value is not None:
            self.expressions.type_of(argument.value)
        if argument.name is None:
            count = sum(not param.is_optional for param in params)
            self.expressions.error(
                argument.at, f"{callee} takes {count} required arguments, no more"
            )
            return
        known = " ".join(f"\\{param.name}" for param in params if param.is_optional)
        hint = f"it has {known}" if known else "it has none"
        self.expressions.error(
            argument.at, f"{callee} has no optional argument \\{argument.name}; {hint}"
        )

    def _groups(self, callee: str, params: Sequence[Param], given: dict[str, Argument]) -> None:
        seen: dict[int, str] = {}
        for param in params:
            argument = given.get(param.name.lower())
            if not param.group or argument is None or argument.condition is not None:
                continue
            if param.group in seen:
                self.expressions.error(
                    argument.at,
                    f"{callee}: \\{param.name} and \\{seen[param.group]} exclude each other",
                )
            seen[param.group] = param.name

    def _argument(self, callee: str, param: Param, argument: Argument) -> None:
        expressions = self.expressions
        if argument.condition is not None:
            data = expressions.find(argument.condition.name)
            if data is None or data.param is None:
                expressions.error(
                    argument.at,
                    f"{argument.condition.name} behind ? has to be an optional parameter of this "
                    "routine",
                )
            return
        if param.type.lower() == "switch":
            if argument.value is not None:
                expressions.type_of(argument.value)
            return
        if argument.value is None:
            expressions.error(
                argument.at, f"\\{param.name} of {callee} needs a value: \\{param.name}:="
            )
            return
        resolved = expressions.types.resolve(param.type)
        wanted = None if resolved in (None, "anytype") else Known(resolved or "", param.rank)
        given = expressions.type_of(argument.value, wanted)
        if not fits(wanted, given):
            shown = f"a {param.type}" + (
                "{" + ",".join("*" * param.rank) + "}" if param.rank else ""
            )
            expressions.error(
                argument.value.at, f"{param.name} of {callee} is {shown}, this is a {given}"
            )
        elif param.mode in (Mode.VAR, Mode.PERS, Mode.INOUT):
            self._reference(callee, param, argument.value)

    def _reference(self, callee: str, param: Param, value: Expr) -> None:
        root = value
        while isinstance(root, Field | Index):
            root = root.base
        if not isinstance(root, Name):
            self.expressions.error(
                value.at,
                f"{param.name} of {callee} is {param.mode}: it needs data, not a value",
            )
            return
        data = self.expressions.find(root.name)
        if data is not None and (why := _refusal(param.mode, data)):
            self.expressions.error(value.at, f"{param.name} of {callee} {why}")


def _refusal(mode: Mode, data: Data) -> str:
    if data.kind is DataKind.CONST:
        return f"is {mode}: {data.name} is a CONST; declare it as {_kinds(mode)}"
    if mode is Mode.PERS and data.kind is DataKind.VAR:
        return f"has to be a PERS: declare {data.name} as one"
    return ""


def _kinds(mode: Mode) -> str:
    return "VAR or PERS" if mode is Mode.INOUT else str(mode)
