"""Worlds by name, so that a cell file's ``sim:`` addresses reach the one that runs."""

from hal.errors import ConfigError
from sims.world.world import World

__all__ = ["open_address", "serve", "withdraw"]

_WORLDS: dict[str, World] = {}


def serve(world: World, name: str = "") -> None:
    """Let ``sim:<name>`` mean this world from now on."""
    _WORLDS[name] = world


def withdraw(name: str = "") -> None:
    """Forget it; harmless when it was not served."""
    _WORLDS.pop(name, None)


def open_address(rest: str) -> World:
    """Return the world behind ``sim:<rest>``.

    Raises
    ------
    ConfigError
        No world of this name runs.
    """
    if rest not in _WORLDS:
        known = ", ".join(f"sim:{name}" for name in sorted(_WORLDS)) or "none"
        raise ConfigError(f"no simulated world runs at sim:{rest}; running: {known}")
    return _WORLDS[rest]
