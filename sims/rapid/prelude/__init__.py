"""What every task knows before a module is loaded, as RAPID source.

``types.sys`` has the records and aliases, ``motion.sys``, ``constants.sys`` and ``errors.sys``
what all tasks share, ``task.sys`` the variables that each task has for itself.
"""

from functools import lru_cache
from importlib.resources import files

from sims.rapid.ast import Module
from sims.rapid.errors import RapidLoadError
from sims.rapid.parser import parse_text

__all__ = ["prelude_modules"]

_SOURCES = ("types.sys", "constants.sys", "errors.sys", "motion.sys", "task.sys")


@lru_cache(maxsize=1)
def prelude_modules() -> tuple[Module, ...]:
    """Return the predefined modules, in an order in which names come before their use."""
    found: list[Module] = []
    for name in _SOURCES:
        text = files(__name__).joinpath(name).read_text("latin-1")
        modules, diagnostics = parse_text(text, name)
        if diagnostics:
            raise RapidLoadError(diagnostics)
        found.extend(modules)
    return tuple(found)
