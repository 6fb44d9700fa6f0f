"""From names in a cell file to devices."""

from collections.abc import Mapping
from typing import Any

import drivers
import sims
from cell.config import DeviceConfig
from hal import Address, Kind, Registry
from hal.errors import ConfigError

__all__ = ["make_device", "registry"]


def registry() -> Registry:
    """Drivers, simulated devices, and what other installed packages add."""
    return Registry(
        drivers.BACKENDS,
        sims.BACKENDS,
        schemes=[drivers.SCHEMES, sims.SCHEMES],
        suites=[drivers.SUITES, sims.SUITES],
    ).add_installed()


def make_device(
    name: str,
    kind: Kind,
    config: DeviceConfig,
    known: Registry,
    opened: Mapping[str, Any],
) -> Any:
    """Build the device that a section of the cell file describes.

    ``opened`` holds what is already open by scheme, such as the simulated world for ``sim``;
    any other address is opened by its scheme's opener.

    Raises
    ------
    ConfigError
        Unknown backend or address scheme, or options that the backend does not take.
    """
    try:
        backend = known.backend(config.backend, kind)
        address = Address.parse(config.address, known=known.schemes)
    except ConfigError as error:
        raise ConfigError(str(error), source="cell file", key=name) from error
    if address.scheme in opened:
        resource = opened[address.scheme]
    else:
        resource = known.opener(address)(address.rest)
    factory = backend.load(config.backend)
    try:
        return factory(resource, **config.options)
    except TypeError as error:
        raise ConfigError(f"does not take these options: {error}", key=name) from error
