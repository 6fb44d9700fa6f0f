"""One rendered look into a bin, shared by the tests that need real pictures."""

from dataclasses import dataclass

import numpy as np
import pytest

from hal import StereoCalibration, StereoCapture, StereoShot
from perception.rectify import rectifier_for, regions_for
from perception.volume import Volume
from sims.camera import (
    Exposure,
    RigTruth,
    TrueView,
    calibration_for,
    trial_scene,
    true_view,
)

SEED, PARTS, SHOTS = 3, 10, 8


@dataclass(frozen=True)
class Look:
    rig: RigTruth
    true: StereoCalibration
    estimated: StereoCalibration
    volume: Volume
    capture: StereoCapture
    truth: TrueView

    def first(self, shots: int) -> StereoCapture:
        return StereoCapture(self.capture.shots[:shots], self.capture.serials)


@pytest.fixture(scope="session")
def look() -> Look:
    scene = trial_scene(SEED, PARTS)
    rig = scene.stand.rig
    true = rig.calibration
    volume = Volume.of_bin(scene.stand.world.layout.bin)
    regions = regions_for(true, volume)
    renderer = scene.stand.renderer
    buffers = renderer.buffers(scene.poses, *regions)
    shots = []
    for k in range(SHOTS):
        exposure = Exposure(k, noise_key=(SEED, k))
        left, right = renderer.images(buffers, regions, exposure)
        for image in (left, right):
            image.setflags(write=False)
        shots.append(StereoShot(left, right, *regions, k, 1000 * k, exposure.exposure_s))
    pinhole = rectifier_for(true, *regions, volume).pinhole
    truth = true_view(rig, scene.bodies, scene.poses, true, pinhole)
    capture = StereoCapture(tuple(shots), true.serials)
    return Look(rig, true, calibration_for(rig, SEED), volume, capture, truth)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(7)
