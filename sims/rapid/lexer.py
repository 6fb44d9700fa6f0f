"""RAPID text to tokens, in one pass of one expression.

Nothing is refused here: what is no token comes out as ``bad``, and the parser says where it
stands and whether it matters.
"""

import re
from bisect import bisect_right
from dataclasses import dataclass

from sims.rapid.ast import Place

__all__ = ["KEYWORDS", "Tokens", "tokenize"]

_RESERVED = """
    ALIAS AND BACKWARD CASE CONNECT CONST DEFAULT DIV DO ELSE ELSEIF ENDFOR ENDFUNC ENDIF
    ENDMODULE ENDPROC ENDRECORD ENDTEST ENDTRAP ENDWHILE ERROR EXIT FALSE FOR FROM FUNC GOTO IF
    INOUT LOCAL MOD MODULE NOSTEPIN NOT NOVIEW OR PERS PROC RAISE READONLY RECORD RETRY RETURN
    STEP SYSMODULE TASK TEST THEN TO TRAP TRUE TRYNEXT UNDO VAR VIEWONLY WHILE WITH XOR
"""

KEYWORDS = frozenset(_RESERVED.split())

_TOKEN = re.compile(
    r"""
    (?:[\s\x1a\ufeff]++ | ![^\n]*+ | %%%[^%]*+%%%)*+
    (?:
      (?P<name> [^\W\d]\w*+)
    | (?P<placeholder> < (?: [TDR]DN|PAR|ALT|DIM|SMT|VAR|EIT|CSE|EXP|ARG|ID ) > )
    | (?P<symbol> := | <> | <= | >= | [-+*/=(){}\[\],;:\\?|%<>] | \.(?![0-9]) )
    | (?P<number> 0[xX][0-9a-fA-F]++ | 0[oO][0-7]++ | 0[bB][01]++
                | (?: [0-9]++ \.?+ [0-9]*+ | \.[0-9]++ ) (?: [eE][-+]?[0-9]++ )?+ )
    | (?P<string> " (?: [^"\n]++ | "" )*+ ")
    | (?P<end> \Z)
    | (?P<bad> "[^\n]*+ | .)
    )
    """,
    re.VERBOSE | re.IGNORECASE,
)


@dataclass(slots=True)
class Tokens:
    """Three columns, one row a token; the last is ``end``.

    A kind is ``name number string placeholder bad end``, the upper-case keyword, or the symbol.
    """

    source: str
    kinds: list[str]
    texts: list[str]
    offsets: list[int]
    line_starts: list[int]

    def place(self, offset: int) -> Place:
        """Line and column of an offset into the text."""
        line = bisect_right(self.line_starts, offset)
        return Place(self.source, line, offset - self.line_starts[line - 1] + 1)


def tokenize(text: str, source: str) -> Tokens:
    r"""Cut a text with ``\n`` line ends; never fails, and takes time linear in its length."""
    kinds: list[str] = []
    texts: list[str] = []
    offsets: list[int] = []
    kind_of: dict[str, str] = {}
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup or "bad"
        word = match[kind]
        if kind in ("name", "symbol"):
            known = kind_of.get(word)
            if known is None:
                known = kind_of[word] = _kind_of_word(kind, word)
            kind = known
        kinds.append(kind)
        texts.append(word)
        offsets.append(match.start(match.lastgroup or 0))
        if kind == "end":
            break
    starts = [0]
    starts.extend(match.end() for match in re.finditer("\n", text))
    return Tokens(source, kinds, texts, offsets, starts)


def _kind_of_word(kind: str, word: str) -> str:
    if kind == "symbol":
        return word
    upper = word.upper()
    return upper if upper in KEYWORDS else "name"
