"""Negative controls: one thing made wrong on purpose, to show that the result depends on it."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Self

from hal.errors import ConfigError

__all__ = ["Controls", "Images"]


class Images(StrEnum):
    """What is done to the images between camera and cell."""

    NORMAL = "normal"
    SWAPPED = "swapped"
    MIRRORED = "mirrored"
    DARK = "dark"
    SATURATED = "saturated"


HELP = (
    "Make one thing wrong on purpose: mu=0.02 (pad friction), offset=0.003 (metres by which "
    "the tool misses sideways), one-finger, nominal (calibration of the drawing instead of the "
    "file), swapped, mirrored, dark or saturated images. May be given several times."
)


@dataclass(frozen=True)
class Controls:
    """Nothing wrong by default."""

    pad_friction: float | None = None
    offset_m: float = 0.0
    has_one_finger: bool = False
    has_nominal_calibration: bool = False
    images: Images = Images.NORMAL

    @classmethod
    def parse(cls, words: Sequence[str]) -> Self:
        """From ``NAME`` or ``NAME=VALUE`` words.

        Raises
        ------
        ConfigError
            An unknown name, or a value that is not a number in range.
        """
        found: dict[str, object] = {}
        for word in words:
            name, _, value = word.partition("=")
            match name:
                case "mu":
                    found["pad_friction"] = _number(word, value, 0.0, 2.0)
                case "offset":
                    found["offset_m"] = _number(word, value, 0.0, 0.05)
                case "one-finger":
                    found["has_one_finger"] = True
                case "nominal":
                    found["has_nominal_calibration"] = True
                case _ if name in set(Images):
                    found["images"] = Images(name)
                case _:
                    raise ConfigError(
                        f"unknown control {word!r}; known: mu=X, offset=M, one-finger, nominal, "
                        + ", ".join(Images),
                        key="--control",
                    )
        return cls(**found)  # type: ignore[arg-type]


def _number(word: str, value: str, low: float, high: float) -> float:
    try:
        number = float(value)
    except ValueError as error:
        raise ConfigError(f"{word!r} needs a number after '='", key="--control") from error
    if not low <= number <= high:
        raise ConfigError(f"{word!r} is outside {low:g}..{high:g}", key="--control")
    return number
