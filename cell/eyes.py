"""The stereo camera as eyes: capture, find the parts, take them to the base frame."""

import asyncio
import hashlib
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cell.config import CellConfig
from cell.report.pictures import LookPictures
from cell.scene import Scene
from cell.walltime import WallTimes
from hal import Bin, Projector, StereoCalibration, StereoCamera, StereoCapture, compute
from perception.parts import Part
from perception.pose import PartModel, build_model
from perception.pose.outline import outline
from perception.rectify import regions_for
from perception.see import Sight, see
from perception.volume import Volume

__all__ = ["StereoEyes", "look_pictures"]

MOST_SEEDS = 1_000_003


def _silent(event: str, **fields: Any) -> None:
    """Nobody listens."""


@dataclass(eq=False)
class StereoEyes:
    """``prepare`` once, then ``look``; the images never leave here but for the report."""

    camera: StereoCamera
    projector: Projector
    calibration: StereoCalibration
    part: Part
    config: CellConfig
    seed: int = 0
    keeps_pictures: bool = False
    note: Callable[..., None] = _silent
    pictures: list[LookPictures] = field(default_factory=list)
    wall: WallTimes = field(default_factory=WallTimes)
    _looks: int = 0
    _model: PartModel | None = None

    async def prepare(self) -> None:
        """Set regions, exposure and patterns; build what perception knows of the part.

        Raises
        ------
        ConfigError
            The calibration file is of another rig.
        NoDepthError
            By the calibration, the bin is out of the cameras' view.
        """
        camera = self.config.camera
        volume = Volume.of_bin(self.config.layout.bin, margin_m=camera.margin_m)
        await self.camera.set_regions(*regions_for(self.calibration, volume))
        await self.camera.set_exposure(camera.exposure_s)
        await self.projector.set_light(True)
        patterns = range(min(camera.shots, self.projector.pattern_count))
        await self.projector.load_sequence(list(patterns))
        self._model = await compute(lambda: build_model(self.part), name="build model")

    async def look(self) -> Scene:
        """Capture and see; see ``cell.scene.Eyes``."""
        assert self._model is not None, "prepare first"
        self._looks += 1
        capture = await self._capture()
        model, number = self._model, self._looks
        began_s = asyncio.get_running_loop().time()
        sight = await compute(
            self.wall.timed("see", lambda: self._see(capture, model, number)),
            charge_s=self.config.charge.see_s,
            name="find parts",
        )
        self._note_time("find parts", began_s)
        if self.keeps_pictures:
            self.pictures.append(look_pictures(number, sight, self.part, self.config.layout.bin))
        return Scene(
            number=number,
            objects=sight.objects_base(),
            confidences=tuple(d.score for d in sight.finding.detections),
            clutter_m=sight.clutter_base(),
            is_empty=sight.finding.is_empty,
            digest=_digest(capture),
            notes={"leftover_m2": sight.finding.leftover_m2, "noise_m": sight.finding.noise_m},
        )

    async def _capture(self) -> StereoCapture:
        camera = self.config.camera
        began_s, wall_s = asyncio.get_running_loop().time(), time.perf_counter()
        capture = await self.camera.capture(shots=camera.shots, timeout_s=camera.timeout_s)
        self.wall.add("capture", time.perf_counter() - wall_s)
        self._note_time("capture", began_s)
        return capture

    def _see(self, capture: StereoCapture, model: PartModel, number: int) -> Sight:
        seed = (self.seed * 1000 + number) % MOST_SEEDS
        return see(capture, self.calibration, model, self.config.layout.bin, seed=seed)

    def _note_time(self, name: str, began_s: float) -> None:
        now_s = asyncio.get_running_loop().time()
        self.note("computed", name=name, start_s=began_s, end_s=now_s)


def _digest(capture: StereoCapture) -> str:
    """Over every byte of every image."""
    digest = hashlib.sha256()
    for shot in capture.shots:
        digest.update(np.ascontiguousarray(shot.left).tobytes())
        digest.update(np.ascontiguousarray(shot.right).tobytes())
    return digest.hexdigest()


def look_pictures(number: int, sight: Sight, part: Part, box: Bin) -> LookPictures:
    """Take from a sight what the report draws."""
    return LookPictures(
        number=number,
        image=sight.view.image,
        depth_m=sight.view.depth_m,
        points_bin_m=sight.points_bin(),
        labels=np.maximum(sight.finding.labels, 0) - 1,
        outlines=tuple(
            tuple(outline(part, d.T_camera_object, sight.view)) for d in sight.finding.detections
        ),
        bin_size_m=box.size_m,
    )
