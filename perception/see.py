"""All of perception in one call: a capture in, parts out, with what was seen on the way."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal import Bin, StereoCalibration, StereoCapture, Transform
from perception.depth import depth_view
from perception.pose import BinVolume, Finding, PartModel, find_parts
from perception.rectify import T_base_camera
from perception.view import DepthView
from perception.volume import Volume

__all__ = ["Sight", "see"]

CLUTTER_CELL_M = 0.006
CLUTTER_LIMIT = 400


@dataclass(frozen=True, eq=False)
class Sight:
    """What one capture showed. Poses of ``finding`` are in frame ``camera``."""

    view: DepthView
    finding: Finding
    T_base_camera: Transform
    T_base_bin: Transform

    def objects_base(self) -> tuple[Transform, ...]:
        """``T_base_object`` of each detection, the surest first."""
        return tuple(self.T_base_camera @ d.T_camera_object for d in self.finding.detections)

    def points_bin(self) -> NDArray[np.float32]:
        """Return the organised cloud (H, W, 3) in frame ``bin``, metres; NaN where no depth."""
        T_bin_camera = self.T_base_bin.inverse() @ self.T_base_camera
        return T_bin_camera.apply(self.view.points()).astype(np.float32)

    def clutter_base(self) -> NDArray[np.float64]:
        """Centres (K, 3), frame ``base``, of 6 mm cells in which something unexplained stands."""
        points = self.view.points()[self.finding.labels < 0].astype(np.float64)
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            return np.zeros((0, 3))
        cells = np.floor(self.T_base_camera.apply(points) / CLUTTER_CELL_M).astype(np.int64)
        cells, counts = np.unique(cells, axis=0, return_counts=True)
        fullest = np.argsort(-counts, kind="stable")[:CLUTTER_LIMIT]
        return np.asarray((cells[np.sort(fullest)] + 0.5) * CLUTTER_CELL_M, np.float64)


def see(
    capture: StereoCapture,
    calibration: StereoCalibration,
    model: PartModel,
    box: Bin,
    *,
    seed: int = 0,
) -> Sight:
    """Rectify, match, find the parts in the bin.

    Raises
    ------
    ConfigError
        The capture belongs to another rig.
    NoDepthError
        The images are dark, saturated, swapped, mirrored, or do not show the bin.
    """
    view = depth_view(capture, calibration, Volume.of_bin(box))
    T = T_base_camera(calibration)
    volume = BinVolume.of(box, T.inverse() @ box.T_base_bin)
    return Sight(view, find_parts(view, model, volume=volume, seed=seed), T, box.T_base_bin)
