"""The event log: what happened, with a number, a title and a cause; the last ones only."""

import asyncio
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from sims.rapid.host import EventKind

__all__ = ["ControllerLog", "Entry"]

MOST_ENTRIES = 1000
MOST_LINE = 200

Cancel = Callable[[], None]


@dataclass(frozen=True)
class Entry:
    """One entry; ``stamp_s`` is loop time."""

    stamp_s: float
    kind: EventKind
    domain: int
    number: int
    title: str
    cause: tuple[str, ...] = ()

    @property
    def code(self) -> int:
        """Domain and number in one, as the pendant shows them."""
        return self.number if self.number >= 10_000 else self.domain * 10_000 + self.number

    def __str__(self) -> str:
        return f"{self.kind} {self.code} {': '.join([self.title, *self.cause])}"


class ControllerLog:
    """A bounded log with watchers."""

    def __init__(self) -> None:
        self._entries: deque[Entry] = deque(maxlen=MOST_ENTRIES)
        self._watchers: list[Callable[[Entry], None]] = []

    def __iter__(self) -> Iterator[Entry]:
        return iter(list(self._entries))

    def __len__(self) -> int:
        return len(self._entries)

    def numbers(self) -> list[int]:
        """The codes of all entries, oldest first."""
        return [entry.code for entry in self._entries]

    def write(
        self,
        kind: EventKind,
        domain: int,
        number: int,
        title: str,
        cause: Sequence[str] = (),
    ) -> None:
        """Add an entry; long lines are cut."""
        try:
            stamp_s = asyncio.get_running_loop().time()
        except RuntimeError:
            stamp_s = 0.0
        lines = tuple(line[:MOST_LINE] for line in cause[:8])
        entry = Entry(stamp_s, kind, domain, number, title[:MOST_LINE], lines)
        self._entries.append(entry)
        for watcher in list(self._watchers):
            watcher(entry)

    def watch(self, written: Callable[[Entry], None]) -> Cancel:
        """Call back with every new entry, until cancelled."""
        self._watchers.append(written)

        def cancel() -> None:
            if written in self._watchers:
                self._watchers.remove(written)

        return cancel
