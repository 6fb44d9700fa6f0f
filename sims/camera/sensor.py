"""From light to grey levels: optics' blur, exposure, noise, clipping, rounding."""

import zlib
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from hal import Region

__all__ = ["BLUR_BORDER_PX", "NOMINAL_EXPOSURE_S", "Sensor", "exposed"]

BLUR_BORDER_PX = 3
NOMINAL_EXPOSURE_S = 0.010


@dataclass(frozen=True)
class Sensor:
    """An IMX249-class sensor behind a lens of moderate sharpness.

    ``gain`` is the share of the full well that light 1.0 fills in the nominal exposure;
    ``response_rms`` is the fixed pixel-to-pixel difference in response.
    """

    bits: int = 8
    blur_px: float = 0.65
    full_well_e: float = 32000.0
    read_noise_e: float = 8.0
    response_rms: float = 0.006
    gain: float = 2.4


def exposed(
    light: NDArray[np.float32],
    *,
    sensor: Sensor,
    region: Region,
    sensor_px: tuple[int, int],
    exposure_s: float,
    serial: str,
    noise_key: tuple[int, int] | None,
    noise_scale: float = 1.0,
) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """Turn light (height + 6, width + 6) round a region into the region's image.

    ``noise_key`` is (world seed, block id): with the serial number it decides every noise
    value, whatever the thread count. None: no noise at all.
    """
    blurred = cv2.GaussianBlur(light, (7, 7), sensor.blur_px)
    blurred = blurred[BLUR_BORDER_PX:-BLUR_BORDER_PX, BLUR_BORDER_PX:-BLUR_BORDER_PX]
    scale = sensor.gain * sensor.full_well_e * exposure_s / NOMINAL_EXPOSURE_S
    electrons = blurred * np.float32(scale)
    if noise_key is not None:
        identity = zlib.crc32(serial.encode())
        response = _response(identity, sensor_px, sensor.response_rms)[region.slices]
        electrons = electrons * response
        rng = np.random.default_rng([noise_key[0], identity, noise_key[1]])
        deviation = np.sqrt(electrons + np.float32(sensor.read_noise_e**2))
        draw = rng.standard_normal(electrons.shape, dtype=np.float32)
        electrons += deviation * draw * np.float32(noise_scale)
    top = 2**sensor.bits - 1
    levels = np.clip(np.rint(electrons * np.float32(top / sensor.full_well_e)), 0, top)
    if sensor.bits <= 8:
        return np.asarray(levels, np.uint8)
    return np.asarray(levels, np.uint16)


@lru_cache(maxsize=4)
def _response(identity: int, sensor_px: tuple[int, int], rms: float) -> NDArray[np.float32]:
    """The camera's own map of pixel responses: fixed for its life."""
    rng = np.random.default_rng([identity, 0x9121])
    shape = (sensor_px[1], sensor_px[0])
    response = np.float32(1) + np.float32(rms) * rng.standard_normal(shape, dtype=np.float32)
    response.setflags(write=False)
    return np.asarray(response)
