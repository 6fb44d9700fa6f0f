"""The stack of a RAPID program: one frame for each routine that is being executed."""

import asyncio
from collections.abc import Coroutine
from dataclasses import dataclass
from enum import Enum, auto
from typing import Any

from sims.rapid.ast import Place
from sims.rapid.compile import Code
from sims.rapid.errors import RapidError
from sims.rapid.symbols import Routine
from sims.rapid.types import Shape
from sims.rapid.values import convert

__all__ = ["Frame", "FrameKind", "Pointer", "UserError", "Wait"]


class FrameKind(Enum):
    """Why a routine is executed."""

    BASE = auto()
    CALL = auto()
    TRAP = auto()
    UNDO = auto()


@dataclass(frozen=True, slots=True)
class Pointer:
    """Where a program stands."""

    module: str
    routine: str
    at: Place

    @property
    def line(self) -> int:
        """From 1."""
        return self.at.line

    def __str__(self) -> str:
        return f"{self.module}/{self.routine}, line {self.line}"


class UserError(RapidError):
    """What ``RAISE number`` raises: known by its number only."""

    def __init__(self, number: int, name: str = "") -> None:
        super().__init__(name or f"error {number}")
        self.errno = number


class Wait:
    """An instruction that waits. It starts when somebody first waits for its end."""

    __slots__ = ("_call", "_shape", "future")

    def __init__(self, call: Coroutine[Any, Any, Any], shape: Shape | None) -> None:
        self._call = call
        self._shape = shape
        self.future: asyncio.Task[Any] | None = None

    def start(self) -> "asyncio.Task[Any]":
        """Run it in the loop; once."""
        if self.future is None:
            self.future = asyncio.get_running_loop().create_task(self._call)
        return self.future

    def result(self) -> Any:
        """Return its value. Raises what it raised."""
        assert self.future is not None
        value = self.future.result()
        return value if self._shape is None else convert(value, self._shape)

    def cancel(self) -> None:
        """Give it up."""
        if self.future is None:
            self._call.close()
        elif not self.future.done():
            self.future.cancel()
        else:
            self.future.cancelled() or self.future.exception()


class Frame:
    """A routine that is being executed.

    ``pc`` is the operation to do next; while a callee or a wait is under way the one that began
    it, and ``resume`` the one after. ``error`` is set while a handler runs; ``failed`` is then
    the operation that failed. ``retried`` is the statement that RETRY repeats.
    """

    __slots__ = (
        "code",
        "dest",
        "error",
        "f",
        "failed",
        "kind",
        "pc",
        "resume",
        "retried",
        "retries",
        "routine",
        "steps",
        "wait",
    )

    def __init__(self, routine: Routine, arguments: list[Any], kind: FrameKind) -> None:
        self.routine = routine
        self.code: Code = routine.code
        self.steps = self.code.steps
        self.f = arguments
        self.kind = kind
        self.pc = 0
        self.resume = 0
        self.dest: int | None = None
        self.error: RapidError | None = None
        self.failed = 0
        self.retried: int | None = None
        self.retries = 0
        self.wait: Wait | None = None

    @property
    def pointer(self) -> Pointer:
        """Where it stands."""
        return Pointer(self.routine.module.name, self.routine.name, self.code.places[self.pc])

    def drop_wait(self) -> None:
        """Give up the instruction that waits, if one does."""
        if self.wait is not None:
            self.wait.cancel()
            self.wait = None
