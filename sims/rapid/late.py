"""Arguments of calls whose callee is known only when it is called."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sims.rapid.ast import DataKind, Mode, Place
from sims.rapid.compile.matching import match
from sims.rapid.data import ABSENT, Cell
from sims.rapid.errors import RapidError
from sims.rapid.symbols import BuiltinRoutine, LinkError, ParamInfo, Routine
from sims.rapid.types import Kind, Shape

__all__ = ["LateArgument", "late_builtin", "late_routine"]


@dataclass(frozen=True, slots=True)
class LateArgument:
    """``reference`` is None for what is no data; ``shape`` is None for a switch."""

    name: str | None
    is_optional: bool
    reference: Any
    value: Any
    shape: Shape | None


def late_routine(routine: Routine, arguments: Sequence[tuple[Any, ...]], at: Place) -> list[Any]:
    """Return a frame's first slots. Raises ``RapidError``."""
    return [
        (False if param.is_switch else ABSENT) if argument is None else _bind(param, argument)
        for param, argument in _match(routine, arguments, at)
    ]


def late_builtin(
    routine: BuiltinRoutine, arguments: Sequence[tuple[Any, ...]], at: Place
) -> dict[str, Any]:
    """Return a built-in's keywords. Raises ``RapidError``."""
    return {
        param.keyword: (False if param.is_switch else None)
        if argument is None
        else _bind(param, argument)
        for param, argument in _match(routine, arguments, at)
    }


def _match(
    routine: Routine | BuiltinRoutine, arguments: Sequence[tuple[Any, ...]], at: Place
) -> list[tuple[ParamInfo, LateArgument | None]]:
    given = [LateArgument(*argument) for argument in arguments]
    given = [one for one in given if one.value is not ABSENT]
    try:
        return match(routine.params, given, routine.name, at)
    except LinkError as error:
        raise RapidError("ERR_ARGNAME", str(error)) from error


def _bind(param: ParamInfo, argument: LateArgument) -> Any:
    if param.is_switch:
        return bool(argument.value)
    if argument.shape is None or not param.shape.accepts(argument.shape):
        raise RapidError(
            "ERR_REFUNKPRC", f"{param.name} needs {param.shape}, not {argument.shape or 'a switch'}"
        )
    if param.mode is Mode.IN:
        value = argument.value
        if argument.shape.type.kind is Kind.SIGNAL and param.shape.type.is_number:
            return value.value
        return value
    if argument.reference is None and param.mode is Mode.REF:
        return Cell("", argument.shape, argument.value)
    kind = argument.reference.root.kind if argument.reference is not None else None
    if (
        kind is None
        or kind is DataKind.CONST
        or (param.mode is Mode.PERS and kind is not DataKind.PERS)
    ):
        raise RapidError("ERR_ARGNOTVAR", f"{param.name} is {param.mode}: give data that fits")
    return argument.reference
