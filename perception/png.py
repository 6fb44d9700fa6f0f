"""Mono PNG images that are whole: OpenCV would fill a truncated one with black and say nothing."""

import zlib
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from hal.errors import ConfigError

__all__ = ["read_png", "write_png"]

SIGNATURE = b"\x89PNG\r\n\x1a\n"

Image = NDArray[np.uint8] | NDArray[np.uint16]


def read_png(path: Path) -> Image:
    """Read a mono image, (H, W) uint8 or uint16.

    Raises
    ------
    ConfigError
        Missing, not a PNG, truncated, damaged, or in colour.
    """
    try:
        content = path.read_bytes()
    except FileNotFoundError as error:
        raise ConfigError("no such file", source=str(path)) from error
    except OSError as error:
        raise ConfigError(f"cannot be read ({error.strerror})", source=str(path)) from error
    if problem := _damage(content):
        raise ConfigError(f"{problem}: copy the file again", source=str(path))
    image: Any = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise ConfigError("cannot be decoded: copy the file again", source=str(path))
    if image.ndim != 2 or image.dtype not in (np.uint8, np.uint16):
        raise ConfigError("is not a mono image of 8 or 16 bits", source=str(path))
    return np.asarray(image)


def write_png(path: Path, image: Image) -> None:
    """Write a mono image."""
    _, content = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    path.write_bytes(content.tobytes())


def _damage(content: bytes) -> str:
    """What is wrong with a PNG's chunks, or nothing."""
    if not content.startswith(SIGNATURE):
        return "is not a PNG"
    at = len(SIGNATURE)
    while at + 12 <= len(content):
        length = int.from_bytes(content[at : at + 4], "big")
        kind, end = content[at + 4 : at + 8], at + 12 + length
        if end > len(content):
            break
        if zlib.crc32(content[at + 4 : end - 4]) != int.from_bytes(content[end - 4 : end], "big"):
            return "is damaged"
        if kind == b"IEND":
            return ""
        at = end
    return "is truncated"
