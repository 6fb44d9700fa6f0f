"""Which lines of some modules an input reaches."""

import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from types import FrameType
from typing import Any

__all__ = ["LineReach"]


class LineReach:
    """Collects lines; imports the modules so that their files are known.

    ``prefixes`` are beginnings of the names of generated code, such as compiled RAPID's.
    """

    def __init__(self, modules: Sequence[str], prefixes: tuple[str, ...] = ()) -> None:
        self._prefixes = prefixes
        files = (import_module(name).__file__ for name in modules)
        self._files = {file for file in files if file}
        self.lines: set[tuple[str, int]] = set()

    def watch(self, run: Callable[[bytes], None], data: bytes) -> bool:
        """Run, and say whether a line was reached that none had reached before."""
        before = len(self.lines)
        sys.settrace(self._called)
        try:
            run(data)
        finally:
            sys.settrace(None)
        return len(self.lines) > before

    def _called(self, frame: FrameType, event: str, arg: Any) -> Any:
        del event, arg
        name = frame.f_code.co_filename
        return self._line if name in self._files or name.startswith(self._prefixes) else None

    def _line(self, frame: FrameType, event: str, arg: Any) -> Any:
        del arg
        if event == "line":
            self.lines.add((frame.f_code.co_filename, frame.f_lineno))
        return self._line
