"""A seeded pile, seen through the rendered stereo rig: depth as perception gets it, and truth."""

from dataclasses import dataclass

import numpy as np

from hal import Bin, StereoCapture, StereoShot, Transform
from perception.depth import depth_view
from perception.parts import Part
from perception.pose import BinVolume
from perception.rectify import T_base_camera, rectifier_for, regions_for
from perception.view import DepthView
from perception.volume import Volume
from sims.camera.render import Exposure
from sims.camera.trial import TrialScene, trial_scene
from sims.camera.truth import visible_shares

__all__ = ["Look", "look_at", "pile_of"]


@dataclass(frozen=True, eq=False)
class Look:
    """What perception gets, and what only a bench may know.

    ``T_camera_parts`` are the true poses in the camera of the view; ``visible`` the share of
    each part's camera-facing surface that the left camera sees, 0..1.
    """

    seed: int
    part: Part
    view: DepthView
    volume: BinVolume
    T_camera_parts: tuple[Transform, ...]
    visible: tuple[float, ...]


def pile_of(seed: int, count: int, part: Part) -> TrialScene:
    """Drop a pile; one scene serves looks with any number of patterns."""
    return trial_scene(seed, count, part=part)


def look_at(scene: TrialScene, *, seed: int, pairs: int) -> Look:
    """Take ``pairs`` pattern pairs and measure depth, with the rig's true calibration."""
    rig = scene.stand.rig
    calibration = rig.calibration
    box = Bin()
    inside = Volume.of_bin(box)
    regions = regions_for(calibration, inside)
    renderer = scene.stand.renderer
    buffers = renderer.buffers(scene.poses, *regions)
    shots = []
    for k in range(pairs):
        exposure = Exposure(pattern=k, noise_key=(rig.seed, k))
        left, right = renderer.images(buffers, regions, exposure)
        shots.append(StereoShot(left, right, *regions, k, 0, exposure.exposure_s))
    capture = StereoCapture(tuple(shots), calibration.serials, renderer.sensor.bits)
    view = depth_view(capture, calibration, inside)
    pinhole = rectifier_for(calibration, *regions, inside).pinhole
    shares = visible_shares(rig, scene.bodies, scene.poses, calibration, pinhole)
    T_camera_base = T_base_camera(calibration).inverse()
    return Look(
        seed=seed,
        part=scene.part,
        view=view,
        volume=BinVolume.of(box, T_camera_base @ box.T_base_bin),
        T_camera_parts=tuple(T_camera_base @ pose for pose in scene.T_base_parts),
        visible=tuple(float(np.clip(shares.get(k, 0.0), 0, 1)) for k in range(len(shares))),
    )
