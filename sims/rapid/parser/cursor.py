"""The place in the tokens, and what has been found wrong on the way."""

from collections.abc import Collection
from typing import NoReturn

from sims.rapid.ast import Place
from sims.rapid.errors import Diagnostic, Severity
from sims.rapid.lexer import KEYWORDS, Tokens

__all__ = [
    "MAX_DIAGNOSTICS",
    "MAX_NESTING",
    "Cursor",
    "RapidSyntaxError",
    "TooManyDiagnosticsError",
]

MAX_DIAGNOSTICS = 200

# A level costs up to seven frames of the Python stack; real programs stay below 30 levels.
MAX_NESTING = 64

_IDENTIFIER_CHARS = 32


class RapidSyntaxError(Exception):
    """Stops a statement or declaration; caught where the parser can go on."""

    def __init__(self, at: Place, message: str) -> None:
        super().__init__(message)
        self.at = at
        self.message = message


class TooManyDiagnosticsError(Exception):
    """Stops the parser: what follows would only repeat itself."""


class Cursor:
    """Walks over tokens. ``kind`` is the current token's.

    ``height`` is that of the expression parsed last, ``nesting`` how deep the parser stands,
    ``placeholder`` the text of an editor's placeholder met since it was last cleared.
    """

    __slots__ = (
        "_kinds",
        "diagnostics",
        "height",
        "index",
        "kind",
        "nesting",
        "open_ends",
        "placeholder",
        "tokens",
    )

    def __init__(self, tokens: Tokens) -> None:
        self.tokens = tokens
        self.diagnostics: list[Diagnostic] = []
        self.height = 0
        self.nesting = 0
        self.placeholder: str | None = None
        self.open_ends: list[frozenset[str]] = []
        self._kinds = tokens.kinds
        self.index = 0
        self.kind = self._kinds[0]

    @property
    def text(self) -> str:
        """The current token as written."""
        return self.tokens.texts[self.index]

    @property
    def place(self) -> Place:
        """Where the current token begins."""
        return self.tokens.place(self.tokens.offsets[self.index])

    @property
    def begins_line(self) -> bool:
        """Whether the token before the current one, if any, stands on an earlier line."""
        return self.index == 0 or self.gap.line < self.place.line

    @property
    def gap(self) -> Place:
        """Right behind the token before the current one."""
        last = max(self.index - 1, 0)
        return self.tokens.place(self.tokens.offsets[last] + len(self.tokens.texts[last]))

    def advance(self) -> None:
        """Go to the next token; the last one stays."""
        if self.kind != "end":
            self.index += 1
            self.kind = self._kinds[self.index]

    def peek(self, ahead: int = 1) -> str:
        """The kind of a token further on, or before."""
        at = self.index + ahead
        return self._kinds[at] if 0 <= at < len(self._kinds) else "end"

    def accept(self, kind: str) -> bool:
        """Step over the token if it is of this kind."""
        if self.kind != kind:
            return False
        self.advance()
        return True

    def expect(self, kind: str, after: str) -> None:
        """Step over a token that has to be there."""
        if self.kind != kind:
            self.refuse(f"expected {kind!r} {after}")
        self.advance()

    def name(self, what: str) -> str:
        """Step over an identifier."""
        if self.kind == "placeholder":
            self.placeholder = self.text
        elif self.kind != "name":
            self.refuse(f"expected {what}")
        text = self.text
        self.advance()
        return text

    def new_name(self, what: str) -> str:
        """Step over an identifier that is being declared."""
        at = self.place
        text = self.name(what)
        if len(text) > _IDENTIFIER_CHARS:
            self.warn(
                at,
                f"{text!r} has {len(text)} characters; a controller takes {_IDENTIFIER_CHARS}: "
                "shorten it",
            )
        return text

    def refuse(self, message: str) -> NoReturn:
        """Fail at the current token, or after the last one if that stands on an earlier line."""
        found = _in_words(self.kind, self.text)
        at = self.gap if self.begins_line and self.index else self.place
        raise RapidSyntaxError(at, f"{message}, found {found}")

    def report(self, at: Place, message: str, severity: Severity = Severity.ERROR) -> None:
        """Note what is wrong and go on."""
        self.diagnostics.append(Diagnostic(at, message, severity))
        if len(self.diagnostics) >= MAX_DIAGNOSTICS:
            raise TooManyDiagnosticsError

    def warn(self, at: Place, message: str) -> None:
        """Note what a controller may not like."""
        self.report(at, message, Severity.WARNING)

    def skip_to(self, stops: Collection[str]) -> None:
        """Go to the next token of one of these kinds."""
        while self.kind != "end" and self.kind not in stops:
            self.advance()


def _in_words(kind: str, text: str) -> str:
    if kind == "end":
        return "the end of the text"
    if kind == "bad" and text.startswith('"'):
        return "a string without its closing quote"
    shown = text if len(text) <= 24 else text[:21] + "..."
    return f"the reserved word {shown!r}" if kind in KEYWORDS else repr(shown)
