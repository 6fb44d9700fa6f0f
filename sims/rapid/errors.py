"""What can be wrong with RAPID: in the source, and while it runs."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from hal.errors import CellError
from sims.rapid.ast import Place

__all__ = ["Diagnostic", "RapidError", "RapidLoadError", "Severity"]


class Severity(StrEnum):
    """Errors keep a module from being loaded; warnings do not."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One thing that is wrong, and where."""

    at: Place
    message: str
    severity: Severity = Severity.ERROR

    def __str__(self) -> str:
        return f"{self.at}: {self.severity}: {self.message}"


class RapidLoadError(CellError):
    """Modules were refused; ``diagnostics`` has all that is wrong with them."""

    def __init__(self, diagnostics: Sequence[Diagnostic]) -> None:
        first = str(diagnostics[0])
        more = f" (and {len(diagnostics) - 1} more)" if len(diagnostics) > 1 else ""
        super().__init__(first + more)
        self.diagnostics = tuple(diagnostics)


class RapidError(Exception):
    """A run-time error of the program: ``ERROR`` handlers may catch it.

    ``name`` is the ``ERR_`` constant. A fatal one has no constant and no handler sees it: the
    task stops. ``number`` is the event log's, ``cause`` its text.
    """

    def __init__(
        self, name: str, message: str = "", *, is_fatal: bool = False, number: int = 0
    ) -> None:
        super().__init__(f"{name}: {message}" if message else name)
        self.name = name
        self.message = message
        self.is_fatal = is_fatal
        self.number = number
