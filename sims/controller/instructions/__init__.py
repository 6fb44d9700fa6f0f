"""Motion instructions and functions: every module here adds built-ins when it is imported."""

from importlib import import_module

__all__ = ["register"]

MODULES = (
    "displacement",
    "moves",
    "positions",
    "searches",
    "settings",
    "stopping",
    "triggered",
    "triggers",
    "units",
)


def register() -> None:
    """Add all of them; harmless when done before."""
    for name in MODULES:
        import_module(f"{__name__}.{name}")
