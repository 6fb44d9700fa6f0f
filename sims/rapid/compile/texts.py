"""Pieces of Python text that stand for RAPID expressions, and what is known of their values."""

from dataclasses import dataclass, replace

from sims.rapid.ast import Place
from sims.rapid.symbols import LinkError
from sims.rapid.types import BOOL, DNUM, NUM, STRING, Kind, Shape, shape_of
from sims.rapid.values import binary32

__all__ = ["BOOLEAN", "NUMBER", "TEXT", "Text", "literal", "number", "owned", "typed"]

NUMBER = shape_of(NUM)
BOOLEAN = shape_of(BOOL)
TEXT = shape_of(STRING)


@dataclass(frozen=True, slots=True)
class Text:
    """``text`` evaluates to a value of ``shape``.

    ``is_fresh``: a list that nobody else holds. ``is_fixed``: the same whenever it is evaluated
    in the statement. ``depth`` bounds the nesting of parentheses. ``number`` is the exact value
    of a numeric literal, which is num or dnum as its surroundings ask.
    """

    text: str
    shape: Shape
    is_fresh: bool = False
    is_fixed: bool = False
    depth: int = 0
    number: float | None = None

    def __str__(self) -> str:
        return self.text


def literal(value: object) -> str:
    """Return a value as Python text that holds none of the emitter's tokens."""
    return repr(value).replace("@", "\\x40")


def number(value: float, at: Place) -> Text:
    """Return a numeric literal."""
    try:
        rounded = binary32(value)
    except Exception:
        rounded = value
    if value - value != 0.0:
        raise LinkError(at, "the number is out of range")
    return Text(literal(rounded), NUMBER, is_fixed=True, number=value)


def typed(text: Text, expected: Shape | None, at: Place) -> Text:
    """Check a value against what is expected; a literal becomes a dnum where one is."""
    if expected is None:
        return text
    if expected.type is DNUM and text.number is not None and not expected.dims:
        return replace(text, text=literal(float(text.number)), shape=shape_of(DNUM))
    if text.number is not None and expected.type is NUM:
        binary_limit(text, at)
    if text.shape.type.kind is Kind.SIGNAL and expected.type.is_number and not expected.dims:
        return Text(f"_signal({text.text}).value", expected, depth=text.depth + 1)
    if not expected.accepts(text.shape):
        raise LinkError(at, f"a value of {expected} is needed, this is {text.shape}")
    return text


def binary_limit(text: Text, at: Place) -> None:
    """Refuse a literal that no num can hold."""
    assert text.number is not None
    if abs(text.number) > 3.4028235677973366e38:
        raise LinkError(at, f"{text.number:g} is out of the range of num: use dnum")


def owned(text: Text) -> str:
    """Return the text of a value that may be kept: a list that others hold is copied."""
    if text.shape.is_list and not text.is_fresh:
        return f"_copy({text.text})"
    if text.shape.type.kind is Kind.ANY and not text.is_fresh:
        return f"_keep({text.text})"
    return text.text
