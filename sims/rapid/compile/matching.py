"""Which argument goes to which parameter; the same rules when linking and for late calls."""

from collections.abc import Sequence
from typing import Protocol, TypeVar

from sims.rapid.ast import Place
from sims.rapid.symbols import LinkError, ParamInfo

__all__ = ["Given", "match"]


class Given(Protocol):
    """An argument: its parameter's name if it has one."""

    @property
    def name(self) -> str | None:
        """As written, or None."""

    @property
    def is_optional(self) -> bool:
        """Whether it was given with a backslash."""


G = TypeVar("G", bound=Given)


def match(
    params: Sequence[ParamInfo], arguments: Sequence[G], callee: str, at: Place
) -> list[tuple[ParamInfo, G | None]]:
    """Return each parameter with its argument, in the order of the parameters.

    Raises
    ------
    LinkError
        An argument too many, an unknown name, a required one missing.
    """
    found: dict[str, G] = {}
    required = iter([param for param in params if not param.is_optional])
    by_name = {param.name: param for param in params}
    for argument in arguments:
        if argument.name is not None:
            param = by_name.get(argument.name.lower())
            if param is None:
                raise LinkError(at, f"{callee} has no parameter \\{argument.name}")
        else:
            param = next((one for one in required if one.name not in found), None)
            if param is None:
                raise LinkError(at, f"too many arguments for {callee}")
        if param.name in found:
            raise LinkError(at, f"{param.name} is given twice to {callee}")
        found[param.name] = argument
    for param in params:
        if not param.is_optional and param.name not in found:
            raise LinkError(at, f"{callee} needs the argument {param.name}")
    return [(param, found.get(param.name)) for param in params]
