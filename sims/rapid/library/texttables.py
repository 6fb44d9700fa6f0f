"""Text tables: TextTabInstall, TextTabGet, TextGet, TextTabFreeToUse.

A file names its tables (``NAME::``) and in each of them numbers its texts: ``12:`` on one line,
the text in quotes on the next. ``#`` begins a comment. All tasks share the tables.
"""

import re

from sims.rapid.builtin import TaskContext, builtin
from sims.rapid.disk import locate
from sims.rapid.errors import RapidError
from sims.rapid.task import task_of

__all__: list[str] = []

MOST_TABLES = 100
MOST_TEXTS = 10_000
MAX_FILE_BYTES = 1_000_000
MAX_STRING = 80

_TABLE = re.compile(r"(\w{1,80})::")
_INDEX = re.compile(r"(\d{1,9}):")
_TEXT = re.compile(r'"(.*)"')


class _Tables:
    """The tables in the order in which they were installed; their numbers count from 1."""

    def __init__(self) -> None:
        self.names: list[str] = []
        self.texts: list[dict[int, str]] = []

    def find(self, name: str) -> int | None:
        """The number of a table."""
        return self.names.index(name.lower()) + 1 if name.lower() in self.names else None


def _tables(task: TaskContext) -> _Tables:
    return task_of(task).common_service(_Tables)


@builtin("PROC TextTabInstall(string File)")
def text_tab_install(task: TaskContext, *, file: str) -> None:
    """Install the tables of a file. ERR_FILEACC; ERR_FILEOPEN: it is none, or one is there."""
    path = locate(task.host, file)
    try:
        with path.open("rb") as source:
            text = source.read(MAX_FILE_BYTES + 1).decode("latin-1")
    except OSError as error:
        raise RapidError("ERR_FILEACC", f"{path.name}: {error.strerror}") from None
    if len(text) > MAX_FILE_BYTES:
        raise RapidError("ERR_FILEACC", f"{path.name} has over {MAX_FILE_BYTES} bytes")
    known = _tables(task)
    found = _parsed(path.name, text)
    if taken := [name for name in found if known.find(name) is not None]:
        raise RapidError("ERR_FILEOPEN", f"the text table {taken[0]} is installed already")
    if len(known.names) + len(found) > MOST_TABLES:
        raise RapidError("ERR_TXPNOSPACE", f"{MOST_TABLES} text tables are possible")
    known.names += found.keys()
    known.texts += found.values()


def _parsed(source: str, text: str) -> dict[str, dict[int, str]]:
    found: dict[str, dict[int, str]] = {}
    table: dict[int, str] | None = None
    index: int | None = None
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.strip()
        if not line or line.startswith("#"):
            continue
        if match := _TABLE.fullmatch(line):
            table = found.setdefault(match[1].lower(), {})
        elif table is not None and (match := _INDEX.fullmatch(line)):
            index = int(match[1])
        elif table is not None and index is not None and (match := _TEXT.fullmatch(line)):
            table[index], index = match[1][:MAX_STRING], None
        else:
            raise RapidError("ERR_FILEOPEN", f"{source}:{number}: no table, index or quoted text")
        if table is not None and len(table) > MOST_TEXTS:
            raise RapidError("ERR_TXPNOSPACE", f"{source}: over {MOST_TEXTS} texts in a table")
    if not found:
        raise RapidError("ERR_FILEOPEN", f"{source} has no text table")
    return found


@builtin("FUNC bool TextTabFreeToUse(string TableName)")
def text_tab_free_to_use(task: TaskContext, *, tablename: str) -> bool:
    """Whether a table of that name may still be installed."""
    return _tables(task).find(tablename) is None


@builtin("FUNC num TextTabGet(string TableName)")
def text_tab_get(task: TaskContext, *, tablename: str) -> float:
    """The number of a table. ERR_ARGVALERR."""
    number = _tables(task).find(tablename)
    if number is None:
        raise RapidError("ERR_ARGVALERR", f"there is no text table {tablename}: install it")
    return float(number)


@builtin("FUNC string TextGet(num Table, num Index)")
def text_get(task: TaskContext, *, table: float, index: float) -> str:
    """A text by the numbers of its table and its own. ERR_ARGVALERR."""
    texts = _tables(task).texts
    if table not in range(1, len(texts) + 1) or index not in texts[int(table) - 1]:
        raise RapidError("ERR_ARGVALERR", f"there is no text {index:g} in table {table:g}")
    return texts[int(table) - 1][int(index)]
