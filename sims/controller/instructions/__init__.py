"""Motion instructions and functions; importing a module here adds what it has."""

from sims.controller.instructions import (
    moves,
    positions,
    settings,
    stopping,
    triggered,
    triggers,
    units,
)

__all__ = ["moves", "positions", "settings", "stopping", "triggered", "triggers", "units"]
