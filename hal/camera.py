"""The stereo camera and its projector."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal.calibration import Region
from hal.device import Device
from hal.motion import Motion

__all__ = ["Projector", "StereoCamera", "StereoCapture", "StereoShot"]

Image = NDArray[np.uint8] | NDArray[np.uint16]


@dataclass(frozen=True, eq=False)
class StereoShot:
    """Two images of one exposure.

    ``left`` and ``right`` have shape (height, width) of their region, mono, raw: unrectified.
    ``block_id`` counts exposures since the camera was opened, the same for both images;
    ``stamp_ns`` is the start of exposure on the camera's clock.
    """

    left: Image
    right: Image
    left_region: Region
    right_region: Region
    block_id: int
    stamp_ns: int
    exposure_s: float


@dataclass(frozen=True, eq=False)
class StereoCapture:
    """One or several shots of the same scene, in the order they were exposed."""

    shots: tuple[StereoShot, ...]
    serials: tuple[str, str]
    bits: int = 8


class StereoCamera(Device):
    """Two cameras that expose together."""

    @property
    @abstractmethod
    def size_px(self) -> tuple[int, int]:
        """Sensor width and height."""

    @property
    @abstractmethod
    def serials(self) -> tuple[str, str]:
        """Serial numbers of the left and the right camera."""

    @abstractmethod
    def set_regions(self, left: Region, right: Region) -> Motion[None]:
        """Read out only these parts of the sensors from the next capture on.

        Raises
        ------
        ValueError
            A region leaves the sensor, or the two differ in size.
        """

    @abstractmethod
    def set_exposure(self, exposure_s: float) -> Motion[None]:
        """Exposure time of the next captures.

        Raises
        ------
        ValueError
            Outside the sensor's range.
        """

    @abstractmethod
    def capture(self, *, shots: int = 1, timeout_s: float = 5.0) -> Motion[StereoCapture]:
        """Expose ``shots`` times and hand over the images.

        A projector on the camera's exposure line shows its next pattern at each shot.

        Raises
        ------
        ValueError
            ``shots`` < 1 or ``timeout_s`` <= 0.
        DeviceTimeoutError
            The images did not arrive in time.
        """


class Projector(Device):
    """Texture light: a static slide (one pattern) or a pattern projector stepped by trigger."""

    @property
    @abstractmethod
    def pattern_count(self) -> int:
        """1 for a static slide."""

    @abstractmethod
    def set_light(self, is_on: bool) -> Motion[None]:
        """Switch the light; saying it twice is harmless."""

    @abstractmethod
    def load_sequence(self, patterns: Sequence[int]) -> Motion[None]:
        """Show these patterns one after the other, a step at each exposure, over and over.

        Raises
        ------
        ValueError
            Empty, or a pattern the projector does not have.
        """
