"""The teach pendant's operator window, for whoever stands in for the operator."""

import asyncio
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

__all__ = ["Question", "TeachPendant"]

MOST_LINES = 500


@dataclass(eq=False)
class Question:
    """What a program asks; ``keys`` is empty where a number is wanted."""

    text: str
    keys: tuple[str, ...]
    answer: "asyncio.Future[float]" = field(repr=False)


class TeachPendant:
    """Lines written, the question that is open, and the operator's answers.

    ``shown`` is told of every line.
    """

    def __init__(self) -> None:
        self.lines: deque[str] = deque(maxlen=MOST_LINES)
        self.question: Question | None = None
        self.shown: Callable[[str], None] = lambda _: None

    def write(self, text: str) -> None:
        """Show a line."""
        self.lines.append(text)
        self.shown(text)

    def erase(self) -> None:
        """Clear the window."""
        self.lines.clear()

    async def ask(self, question: str, keys: Sequence[str]) -> int:
        """Wait for a key; the first is 1."""
        return int(await self._ask(question, tuple(keys)))

    async def ask_number(self, question: str) -> float:
        """Wait for a number."""
        return await self._ask(question, ())

    async def _ask(self, text: str, keys: tuple[str, ...]) -> float:
        question = Question(text, keys, asyncio.get_running_loop().create_future())
        self.question = question
        self.write(text)
        try:
            return await question.answer
        finally:
            if self.question is question:
                self.question = None

    def answer(self, value: float) -> None:
        """The operator's answer to the open question.

        Raises
        ------
        ValueError
            Nothing was asked, or there is no such key.
        """
        question = self.question
        if question is None or question.answer.done():
            raise ValueError("the program asks nothing")
        if question.keys and not (
            1 <= value <= len(question.keys) and question.keys[int(value) - 1]
        ):
            raise ValueError(f"there is no key {value:g}")
        question.answer.set_result(value)
