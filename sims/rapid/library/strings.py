"""Strings: parts, searches, comparison. Positions count from 1."""

import math
import re

from sims.rapid.builtin import TaskContext, builtin
from sims.rapid.errors import RapidError

__all__: list[str] = []

_MAX = 80
_SLOT = re.compile(r"\{([1-9]|10)\}")


def _start(name: str, text: str, position: float) -> int:
    """Return an index; right behind the last character is fine for a search."""
    if position != math.trunc(position) or not 1 <= position <= len(text) + 1:
        raise RapidError(
            "ERR_ARGVALERR", f"{name}: position {position:g} in a string of {len(text)} characters"
        )
    return int(position) - 1


@builtin("FUNC num StrLen(string Str)")
def str_len(task: TaskContext, *, str_: str) -> float:
    """How many characters."""
    del task
    return float(len(str_))


@builtin("FUNC string StrPart(string Str, num ChPos, num Len)")
def str_part(task: TaskContext, *, str_: str, chpos: float, len_: float) -> str:
    """Return a part that lies in the string. ERR_ARGVALERR otherwise."""
    del task
    begin = _start("StrPart", str_, chpos)
    if len_ != math.trunc(len_) or not 0 <= len_ <= len(str_) - begin:
        raise RapidError(
            "ERR_ARGVALERR",
            f"StrPart: {len_:g} characters from {chpos:g} in a string of {len(str_)}",
        )
    return str_[begin : begin + int(len_)]


@builtin("FUNC num StrFind(string Str, num ChPos, string Set \\switch NotInSet)")
def str_find(
    task: TaskContext, *, str_: str, chpos: float, set_: str, notinset: bool = False
) -> float:
    """Where the first character (not) of a set stands; one past the end when there is none."""
    del task
    for k in range(_start("StrFind", str_, chpos), len(str_)):
        if (str_[k] in set_) != notinset:
            return float(k + 1)
    return float(len(str_) + 1)


@builtin("FUNC num StrMatch(string Str, num ChPos, string Pattern)")
def str_match(task: TaskContext, *, str_: str, chpos: float, pattern: str) -> float:
    """Where a pattern begins; one past the end when it is not there."""
    del task
    found = str_.find(pattern, _start("StrMatch", str_, chpos))
    return float((len(str_) if found < 0 else found) + 1)


@builtin("FUNC string StrMap(string Str, string FromMap, string ToMap)")
def str_map(task: TaskContext, *, str_: str, frommap: str, tomap: str) -> str:
    """Exchange characters. ERR_ARGVALERR: the maps differ in length."""
    del task
    if len(frommap) != len(tomap):
        raise RapidError(
            "ERR_ARGVALERR", f"StrMap: maps of {len(frommap)} and {len(tomap)} characters"
        )
    table = dict(zip(reversed(frommap), reversed(tomap), strict=True))
    return "".join(table.get(char, char) for char in str_)


@builtin("FUNC bool StrMemb(string Str, num ChPos, string Set)")
def str_memb(task: TaskContext, *, str_: str, chpos: float, set_: str) -> bool:
    """Whether the character at a position is of a set."""
    del task
    begin = _start("StrMemb", str_, chpos)
    return str_[begin : begin + 1] in set_ if begin < len(str_) else False


@builtin("FUNC bool StrOrder(string Str1, string Str2, string Order)")
def str_order(task: TaskContext, *, str1: str, str2: str, order: str) -> bool:
    """Whether two strings are in order; characters that ``Order`` lacks come behind all others."""
    del task
    rank = {char: k for k, char in reversed(list(enumerate(order)))}

    def key(text: str) -> list[int]:
        return [rank.get(char, len(order) + ord(char)) for char in text]

    return key(str1) <= key(str2)


@builtin(
    "FUNC string StrFormat(string Str \\string Arg1 \\string Arg2 \\string Arg3 \\string Arg4 "
    "\\string Arg5 \\string Arg6 \\string Arg7 \\string Arg8 \\string Arg9 \\string Arg10)"
)
def str_format(
    task: TaskContext,
    *,
    str_: str,
    arg1: str | None = None,
    arg2: str | None = None,
    arg3: str | None = None,
    arg4: str | None = None,
    arg5: str | None = None,
    arg6: str | None = None,
    arg7: str | None = None,
    arg8: str | None = None,
    arg9: str | None = None,
    arg10: str | None = None,
) -> str:
    """Put the arguments where ``{1}`` to ``{10}`` stand. ERR_STRTOOLNG: over 80 characters."""
    del task
    args = (arg1, arg2, arg3, arg4, arg5, arg6, arg7, arg8, arg9, arg10)

    def given(match: re.Match[str]) -> str:
        value = args[int(match[1]) - 1]
        return match[0] if value is None else value

    text = _SLOT.sub(given, str_)
    if len(text) > _MAX:
        raise RapidError("ERR_STRTOOLNG", f"StrFormat: {len(text)} characters, {_MAX} are possible")
    return text


@builtin("FUNC bool StrDigCmp(stringdig StrDig1, opnum Relation, stringdig StrDig2)")
def str_dig_cmp(task: TaskContext, *, strdig1: str, relation: float, strdig2: str) -> bool:
    """Compare whole numbers in strings (0 to 4294967295) by ``LT LTEQ EQ NOTEQ GTEQ GT``."""
    del task
    left, right = (_digits(text) for text in (strdig1, strdig2))
    answers = (
        left < right,
        left <= right,
        left == right,
        left != right,
        left >= right,
        left > right,
    )
    if relation not in range(1, len(answers) + 1):
        raise RapidError("ERR_ARGVALERR", f"StrDigCmp: relation {relation:g}; use LT to GT")
    return answers[int(relation) - 1]


def _digits(text: str) -> int:
    if not (text.isascii() and text.isdigit() and int(text) < 2**32):
        raise RapidError("ERR_INT_NOTVAL", f"{text!r} is not a whole number of 0 to 4294967295")
    return int(text)


@builtin("FUNC stringdig StrDigCalc(stringdig StrDig1, opcalc Operation, stringdig StrDig2)")
def str_dig_calc(task: TaskContext, *, strdig1: str, operation: float, strdig2: str) -> str:
    """Calculate with whole numbers in strings; the result is of 0 to 4294967295 too.

    ``OpAdd OpSub OpMult OpDiv OpMod``. ERR_CALC_OVERFLOW, ERR_CALC_NEG, ERR_CALC_DIVZERO.
    """
    del task
    left, right = (_digits(text) for text in (strdig1, strdig2))
    if operation not in range(1, 6):
        raise RapidError(
            "ERR_ARGVALERR", f"StrDigCalc: operation {operation:g}; use OpAdd to OpMod"
        )
    if operation > 3 and right == 0:
        raise RapidError("ERR_CALC_DIVZERO", "StrDigCalc: division by zero")
    whole, remainder = divmod(left, right or 1)
    result = (left + right, left - right, left * right, whole, remainder)[int(operation) - 1]
    if result < 0:
        raise RapidError("ERR_CALC_NEG", f"StrDigCalc: {left} - {right} is below 0")
    if result >= 2**32:
        raise RapidError("ERR_CALC_OVERFLOW", f"StrDigCalc: {result} is over 4294967295")
    return str(result)
