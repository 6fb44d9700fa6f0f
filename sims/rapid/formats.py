"""Values as RAPID writes them and text as RAPID reads it.

A num carries 6 significant digits, a dnum 15 (unverified).
"""

import re
from typing import Any

__all__ = ["fixed_text", "number_text", "text_to_value", "value_text"]

_NUM_DIGITS = 6
_DNUM_DIGITS = 15

_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_STRING = re.compile(r'"((?:[^"]|"")*)"')
_BLANKS = re.compile(r"[ \t]*")
_BOOLEANS = {"TRUE": True, "FALSE": False}
_WORD = re.compile(r"[A-Za-z]+")


def number_text(value: float, *, is_dnum: bool = False) -> str:
    """``100``, ``1.23457``, ``9E+09``."""
    text = format(value, f".{_DNUM_DIGITS if is_dnum else _NUM_DIGITS}G")
    return "0" if text == "-0" else text


def fixed_text(value: float, decimals: int, *, has_exponent: bool = False) -> str:
    """``-1.10`` with two decimals, ``-1`` with none; a zero has no sign."""
    text = format(value, f".{decimals}{'E' if has_exponent else 'f'}")
    return text[1:] if text.startswith("-") and not text.strip("-0.") else text


def value_text(value: Any, *, is_dnum: bool = False) -> str:
    """Any value: ``TRUE``, ``"a""b"``, ``[1,[2,3]]``. Raises ``TypeError`` for an opaque one."""
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, float | int):
        return number_text(value, is_dnum=is_dnum)
    if isinstance(value, str):
        return '"' + value.replace('"', '""') + '"'
    if isinstance(value, list):
        return "[" + ",".join(value_text(item, is_dnum=is_dnum) for item in value) + "]"
    raise TypeError(f"{type(value).__name__} has no text")


def text_to_value(text: str, like: Any) -> Any:
    """Read a value that is made as ``like`` is; None when the text is none.

    Blanks may stand around every part. Leading zeros, a plus sign and a leading dot are fine.
    """
    try:
        value, end = _read(text, _skip(text, 0), like)
    except ValueError:
        return None
    return value if _skip(text, end) == len(text) else None


def _read(text: str, at: int, like: Any) -> tuple[Any, int]:
    if isinstance(like, list):
        return _read_list(text, at, like)
    if isinstance(like, bool):
        match = _WORD.match(text, at)
        word = match[0].upper() if match else ""
        if match is None or word not in _BOOLEANS:
            raise ValueError("no bool")
        return _BOOLEANS[word], match.end()
    if isinstance(like, float | int):
        match = _NUMBER.match(text, at)
        if match is None:
            raise ValueError("no number")
        return float(match[0]), match.end()
    match = _STRING.match(text, at) if isinstance(like, str) else None
    if match is None:
        raise ValueError("no string")
    return match[1].replace('""', '"'), match.end()


def _read_list(text: str, at: int, like: list[Any]) -> tuple[list[Any], int]:
    found: list[Any] = []
    opening = "["
    for item in like:
        if text[at : at + 1] != opening:
            raise ValueError(f"no {opening}")
        value, at = _read(text, _skip(text, at + 1), item)
        at = _skip(text, at)
        found.append(value)
        opening = ","
    if text[at : at + 1] != "]":
        raise ValueError("no ]")
    return found, at + 1


def _skip(text: str, at: int) -> int:
    match = _BLANKS.match(text, at)
    return match.end() if match else at
