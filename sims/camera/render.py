"""A whole exposure: bodies, poses, rig and pattern in, two raw images out."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hal import CameraIntrinsics, Region, Transform
from sims.camera import patterns
from sims.camera.bodies import Bodies, Poses
from sims.camera.cast import Buffer, RayScene
from sims.camera.influence import Influence
from sims.camera.lens import ray_slopes
from sims.camera.rig import RigTruth
from sims.camera.sensor import BLUR_BORDER_PX, NOMINAL_EXPOSURE_S, Sensor, exposed

__all__ = ["Exposure", "Image", "StereoRenderer"]

SIDES = 2
Image = NDArray[np.uint8] | NDArray[np.uint16]


@dataclass(frozen=True)
class Exposure:
    """What decides an image besides the geometry.

    ``pattern`` None: the lamp is off. ``noise_key`` is (world seed, block id); None: no noise.
    """

    pattern: int | None = 0
    exposure_s: float = NOMINAL_EXPOSURE_S
    noise_key: tuple[int, int] | None = None
    noise_scale: float = 1.0


class StereoRenderer:
    """Draws what the rig's two cameras see. Pure: the same arguments give the same bits."""

    def __init__(self, rig: RigTruth, bodies: Bodies, sensor: Sensor | None = None) -> None:
        self.rig = rig
        self.bodies = bodies
        self.sensor = sensor or Sensor()

    def buffers(self, poses: Poses, left: Region, right: Region) -> tuple[Buffer, Buffer]:
        """The geometry pass of both cameras for one instant."""
        scene = RayScene(self.bodies, poses)
        true = self.rig.calibration
        jobs = [
            (true.left, true.T_base_left, left),
            (true.right, true.T_base_left @ true.T_left_right, right),
        ]
        with ThreadPoolExecutor(SIDES) as side_by_side:
            first, second = side_by_side.map(lambda job: self._buffer(scene, *job), jobs)
        return first, second

    def is_same_picture(self, before: Poses, after: Poses, left: Region, right: Region) -> bool:
        """Whether the buffers of one instant serve for the other: nothing in view has moved."""
        return _influence(self.rig, left, right).is_same_picture(self.bodies, before, after)

    def _buffer(
        self, scene: RayScene, camera: CameraIntrinsics, T_base_camera: Transform, region: Region
    ) -> Buffer:
        slopes = ray_slopes(camera, region, BLUR_BORDER_PX)
        return scene.buffer(T_base_camera, slopes, self.rig.projector)

    def images(
        self, buffers: tuple[Buffer, Buffer], regions: tuple[Region, Region], shot: Exposure
    ) -> tuple[Image, Image]:
        """Left and right image of one exposure."""
        return self.sequence(buffers, regions, [shot])[0]

    def sequence(
        self,
        buffers: tuple[Buffer, Buffer],
        regions: tuple[Region, Region],
        shots: Sequence[Exposure],
    ) -> list[tuple[Image, Image]]:
        """Left and right image of each exposure of one unmoved scene."""
        jobs = [
            (buffers[side], regions[side], self.rig.calibration.serials[side], shot)
            for shot in shots
            for side in range(SIDES)
        ]
        with ThreadPoolExecutor(SIDES) as side_by_side:
            images = list(side_by_side.map(lambda job: self._image(*job), jobs))
        return list(zip(images[::SIDES], images[1::SIDES], strict=True))

    def _image(self, buffer: Buffer, region: Region, serial: str, shot: Exposure) -> Image:
        light = buffer.ambient
        if shot.pattern is not None:
            optics = self.rig.projector
            size_px = (optics.width_px, optics.height_px)
            light = light + buffer.lamp * patterns.lookup(
                shot.pattern, buffer.u_px, buffer.v_px, size_px
            )
        camera = self.rig.calibration.left
        return exposed(
            light,
            sensor=self.sensor,
            region=region,
            sensor_px=(camera.width_px, camera.height_px),
            exposure_s=shot.exposure_s,
            serial=serial,
            noise_key=shot.noise_key,
            noise_scale=shot.noise_scale,
        )


@lru_cache(maxsize=4)
def _influence(rig: RigTruth, left: Region, right: Region) -> Influence:
    return Influence(rig, left, right)
