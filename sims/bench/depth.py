"""Depth of rendered piles against truth, and against OpenCV's SGBM on the same images.

Every figure is per scene and noise draw; the value is their median, min and max their range.

* ``interior_rms``, ``interior_p95``, ``bias``: over parts' pixels that both cameras see, that
  are lit, more than 4 px from a step of depth and off by less than 5 mm; metres.
* ``within_1mm``, ``gross``: shares of all parts' pixels that both cameras see and that are lit,
  edges included; a pixel without depth is in neither. Gross is more than 5 mm off.
* ``complete``: the share of those that have depth.
* ``seconds``: wall time from raw images of the bin's region to the depth image, rectification
  maps at hand.

The suffix says how many pattern pairs; ``_estimated``: with a calibration that has the errors
of a real one, without the mounting's. SGBM takes one pair; for several it is the median of its
results.
"""

import time
from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hal import Figure, Region, StereoCalibration, StereoCapture, StereoShot
from perception.depth import depth_from_disparity, depth_view
from perception.parts import Part
from perception.rectify import Rectifier, rectifier_for, regions_for
from perception.volume import Volume
from sims.bench.sgbm import NAME, sgbm_disparity
from sims.camera.cast import Buffer
from sims.camera.render import Exposure
from sims.camera.residual import calibration_for
from sims.camera.trial import TrialScene, trial_scene
from sims.camera.truth import TrueView, true_view

__all__ = ["run", "score"]

Buffers = tuple[Buffer, Buffer]
Regions = tuple[Region, Region]

PAIRS = (1, 4, 8)
NOISE_DRAWS = 2
GROSS_M = 0.005
CLOSE_M = 0.001

UNITS = {
    "interior_rms": "m",
    "interior_p95": "m",
    "bias": "m",
    "within_1mm": "1",
    "gross": "1",
    "complete": "1",
    "seconds": "s",
}


def run(*, seeds: Sequence[int], part: Part, count: int) -> list[Figure]:
    """Measure ``depth.*`` on a pile of ``count`` parts for each seed.

    Raises
    ------
    ConfigError
        The part is not a turned one, or so many do not fit the bin.
    """
    ours: dict[str, list[float]] = defaultdict(list)
    peers: dict[str, list[float]] = defaultdict(list)
    for seed in seeds:
        scene = trial_scene(seed, count, part=part)
        true = scene.stand.rig.calibration
        estimated = calibration_for(scene.stand.rig, seed)
        volume = Volume.of_bin(scene.stand.world.layout.bin)
        regions = regions_for(true, volume)
        buffers = scene.stand.renderer.buffers(scene.poses, *regions)
        views = {}
        for calibration in (true, estimated):
            rectify = rectifier_for(calibration, *regions, volume)
            rig, bodies, poses = scene.stand.rig, scene.bodies, scene.poses
            views[calibration] = true_view(rig, bodies, poses, calibration, rectify.pinhole)
        for draw in range(NOISE_DRAWS):
            shots = _shots(scene, buffers, regions, first_block=draw * max(PAIRS))
            for pairs in PAIRS:
                capture = StereoCapture(shots[:pairs], true.serials)
                name = f"{pairs}pair" + "s" * (pairs > 1)
                _measure(capture, true, volume, views[true], name, ours)
                _measure(capture, estimated, volume, views[estimated], f"{name}_estimated", ours)
                rectify = rectifier_for(true, *regions, volume)
                _measure_peer(capture, rectify, views[true], name, peers)
    return [_figure(key, values, peers.get(key)) for key, values in ours.items()]


def score(depth_m: NDArray[np.float32], truth: TrueView) -> dict[str, float]:
    """Compare a depth image with the truth of the same pixels; see the module."""
    error_m = depth_m - truth.depth_m
    inside = error_m[truth.is_interior]
    inside = inside[np.abs(inside) < GROSS_M].astype(np.float64)
    seen = np.abs(error_m[truth.is_measurable])
    return {
        "interior_rms": float(np.sqrt((inside**2).mean())),
        "interior_p95": float(np.percentile(np.abs(inside), 95)),
        "bias": float(inside.mean()),
        "within_1mm": float((seen < CLOSE_M).mean()),
        "gross": float((seen > GROSS_M).mean()),
        "complete": float(np.isfinite(seen).mean()),
    }


def _shots(
    scene: TrialScene, buffers: Buffers, regions: Regions, *, first_block: int
) -> tuple[StereoShot, ...]:
    shots = []
    for pattern in range(max(PAIRS)):
        block_id = first_block + pattern
        exposure = Exposure(pattern, noise_key=(scene.stand.rig.seed, block_id))
        images = scene.stand.renderer.images(buffers, regions, exposure)
        shots.append(StereoShot(*images, *regions, block_id, 0, exposure.exposure_s))
    return tuple(shots)


def _measure(
    capture: StereoCapture,
    calibration: StereoCalibration,
    volume: Volume,
    truth: TrueView,
    suffix: str,
    into: dict[str, list[float]],
) -> None:
    began = time.perf_counter()
    view = depth_view(capture, calibration, volume)
    _note(score(view.depth_m, truth), time.perf_counter() - began, suffix, into)


def _measure_peer(
    capture: StereoCapture,
    rectify: Rectifier,
    truth: TrueView,
    suffix: str,
    into: dict[str, list[float]],
) -> None:
    began = time.perf_counter()
    pinhole = rectify.pinhole
    disparity_px = sgbm_disparity([rectify(shot) for shot in capture.shots], pinhole)
    depth_m = depth_from_disparity(
        disparity_px, focal_px=pinhole.focal_px, baseline_m=pinhole.baseline_m
    )
    _note(score(depth_m, truth), time.perf_counter() - began, suffix, into)


def _note(
    scores: dict[str, float], seconds: float, suffix: str, into: dict[str, list[float]]
) -> None:
    for key, value in {**scores, "seconds": seconds}.items():
        into[f"{key}_{suffix}"].append(value)


def _figure(key: str, values: list[float], peer_values: list[float] | None) -> Figure:
    unit = next(unit for name, unit in UNITS.items() if key.startswith(name))
    if not peer_values:
        return Figure.median(f"depth.{key}", values, unit)
    peer_value = Figure.median(key, peer_values, unit).value
    return Figure.median(f"depth.{key}", values, unit, peer=NAME, peer_value=peer_value)
