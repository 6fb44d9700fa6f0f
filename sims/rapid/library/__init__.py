"""Instructions and functions that need no robot."""

import pkgutil
from importlib import import_module

__all__ = ["register"]


def register() -> None:
    """Make all of the library's built-ins known; once is enough."""
    for module in pkgutil.iter_modules(__path__):
        import_module(f"{__name__}.{module.name}")
