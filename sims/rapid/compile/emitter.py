"""A routine's operations while they are written: text with labels, and how it becomes code.

Each operation is a Python function of the frame's slots that returns the number of the next
operation, or a negative number when the machine must look up first. In its text ``@own`` and
``@next`` stand for its own number and that of what follows, ``@7@`` for label 7.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from sims.rapid.ast import Place
from sims.rapid.data import Cell

__all__ = ["Code", "Emitter", "Label", "Operation", "StatementMark"]

_TOKEN = re.compile(r"@(own|next|size|\d+@)")
Step = Callable[[list[Any]], int]


@dataclass(frozen=True, slots=True)
class Label:
    """A place to jump to."""

    number: int


@dataclass(frozen=True, slots=True)
class _Jump:
    target: Label


@dataclass(frozen=True, slots=True)
class StatementMark:
    """Where a statement starts (for RETRY) and what is behind it (for TRYNEXT)."""

    at: Place
    start: Label
    after: Label


@dataclass(frozen=True, slots=True)
class Operation:
    """Lines of a function's body."""

    lines: tuple[str, ...]
    mark: StatementMark


@dataclass(frozen=True, slots=True)
class Code:
    """What the machine runs; the tables are by operation number.

    ``handlers``: (error numbers, is a long jump, first operation); no numbers: all errors. A
    number that the program books while it runs is a cell.
    """

    steps: tuple[Step, ...]
    places: tuple[Place, ...]
    starts: tuple[int, ...]
    afters: tuple[int, ...]
    handlers: tuple[tuple[tuple[int | Cell, ...], bool, int], ...] = ()
    undo: int | None = None
    weight: int = 0


class Emitter:
    """Collects operations and lays them out."""

    def __init__(self, slots: int) -> None:
        self._stream: list[Operation | Label | _Jump] = []
        self._labels = 0
        self._slots = slots
        self._temporaries = 0
        self._most_temporaries = 0
        self.mark: StatementMark | None = None

    # Slots.

    def local(self) -> int:
        """Return a new slot for the routine's life."""
        self._slots += 1
        return self._slots - 1

    def temporary(self) -> str:
        """Return a slot (as text) for the statement's life."""
        self._temporaries += 1
        self._most_temporaries = max(self._most_temporaries, self._temporaries)
        return f"f[-{self._temporaries}]"

    @property
    def size(self) -> int:
        """How many slots a frame needs."""
        return self._slots + self._most_temporaries

    # The stream.

    def position(self) -> int:
        """Where the stream ends now."""
        return len(self._stream)

    def label(self) -> Label:
        """Return a new label, not yet placed."""
        self._labels += 1
        return Label(self._labels)

    def place(self, label: Label) -> None:
        """Put a label here."""
        self._stream.append(label)

    def jump(self, target: Label) -> None:
        """Go on at a label; costs nothing at run time."""
        self._stream.append(_Jump(target))

    def statement(self, at: Place) -> StatementMark:
        """Begin a statement here; its ``after`` label must be placed."""
        mark = StatementMark(at, self.label(), self.label())
        self.place(mark.start)
        self.mark = mark
        self._temporaries = 0
        return mark

    def operation(self, *lines: str, before: int | None = None) -> None:
        """Add an operation, at the end or before a position of the stream."""
        assert self.mark is not None
        operation = Operation(lines, self.mark)
        if before is None:
            self._stream.append(operation)
        else:
            self._stream.insert(before, operation)

    def cut(self, position: int) -> None:
        """Forget what was written since a position."""
        del self._stream[position:]

    # Layout.

    def layout(self) -> "Layout":
        """Number the operations."""
        return Layout(self._stream, self.size)


class Layout:
    """Operations with their numbers."""

    def __init__(self, stream: list[Operation | Label | _Jump], size: int) -> None:
        self._size = size
        self.operations: list[Operation] = []
        self._at: dict[Label, int] = {}
        self._aliases: dict[Label, Label] = {}
        self._falls: dict[int, Label] = {}
        pending: list[Label] = []
        after_jump: Label | None = None
        for item in stream:
            if isinstance(item, Operation):
                number = len(self.operations)
                for label in pending:
                    self._at.setdefault(label, number)
                pending, after_jump = [], None
                self.operations.append(item)
            elif isinstance(item, Label):
                pending.append(item)
                after_jump = None
            elif after_jump is None:
                self._leap(item.target, pending)
                pending, after_jump = [], item.target
        self._end(pending)

    def _leap(self, target: Label, pending: list[Label]) -> None:
        """Labels before a jump are the jump's target; so is what the operation before goes to."""
        for label in pending:
            self._aliases[label] = target
        if self.operations:
            self._falls.setdefault(len(self.operations) - 1, target)

    def _end(self, pending: list[Label]) -> None:
        for label in pending:
            self._at.setdefault(label, len(self.operations))

    def number(self, label: Label) -> int:
        """The operation that a label leads to."""
        seen = set()
        while label in self._aliases and label not in seen:
            seen.add(label)
            label = self._aliases[label]
        return self._at[label]

    def texts(self) -> Iterator[str]:
        """Return the source of each operation's function."""
        by_number = {label.number: label for label in (*self._at, *self._aliases)}
        for own, operation in enumerate(self.operations):
            following = self._falls.get(own)
            succeeding = own + 1 if following is None else self.number(following)

            def replace(match: re.Match[str], own: int = own, after: int = succeeding) -> str:
                token = match[1]
                if token == "own":
                    return str(own)
                if token == "next":
                    return str(after)
                if token == "size":
                    return str(self._size)
                return str(self.number(by_number[int(token[:-1])]))

            body = "\n    ".join(operation.lines)
            yield f"def s{own}(f):\n    {_TOKEN.sub(replace, body)}"

    def build(self, namespace: dict[str, Any], name: str) -> tuple[Step, ...]:
        """Compile the operations; ``namespace`` has what they name."""
        texts = list(self.texts())
        names = ", ".join(f"s{number}" for number in range(len(texts)))
        texts.append(f"steps = ({names},)")
        local: dict[str, Any] = {}
        exec(compile("\n".join(texts), f"<{name}>", "exec"), namespace, local)
        steps: tuple[Step, ...] = local["steps"]
        return steps

    def tables(self) -> Mapping[str, tuple[Any, ...]]:
        """Return places, starts and afters by operation number."""
        marks = [operation.mark for operation in self.operations]
        return {
            "places": tuple(mark.at for mark in marks),
            "starts": tuple(self.number(mark.start) for mark in marks),
            "afters": tuple(self.number(mark.after) for mark in marks),
        }
