"""The simulated stereo rig as a ``hal.StereoCamera``, without a wire between."""

import asyncio
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from hal import Identity, Motion, Region, StereoCamera, StereoCapture, StereoShot, compute
from hal.errors import DeviceTimeoutError
from sims.camera.bodies import Poses
from sims.camera.cast import Buffer
from sims.camera.render import Exposure, Image
from sims.camera.sensor import NOMINAL_EXPOSURE_S
from sims.camera.stand import CameraFaults, rig_over
from sims.direct.link import DirectLink
from sims.world import World

__all__ = ["DirectCamera"]

FRAME_PERIOD_S = 1 / 41
READOUT_S = FRAME_PERIOD_S
SHORTEST_EXPOSURE_S = 20e-6
LONGEST_EXPOSURE_S = 1.0


@dataclass(frozen=True, eq=False)
class _Trigger:
    """All that an image depends on, frozen when its exposure began."""

    poses: Poses
    exposure: Exposure
    block_id: int
    stamp_ns: int
    exposure_s: float


class DirectCamera(StereoCamera):
    """Freezes the scene at each exposure's start; images are drawn off the loop's thread."""

    def __init__(
        self,
        world: World,
        *,
        name: str = "camera",
        exposure_s: float = NOMINAL_EXPOSURE_S,
        frame_period_s: float = FRAME_PERIOD_S,
    ) -> None:
        self.name = name
        self._stand = rig_over(world)
        self._world = world
        left = self._stand.rig.calibration.left
        self._size_px = (left.width_px, left.height_px)
        whole = Region(0, 0, *self._size_px)
        self._regions = (whole, whole)
        self._exposure_s = _checked_exposure(exposure_s)
        self._frame_period_s = frame_period_s
        self._link = DirectLink(
            world, name, Identity("binpick", "stereo rig", "/".join(self.serials))
        )
        self._next_block = 0
        self._ready_at_s = 0.0
        self._drawn: tuple[Poses, tuple[Region, Region], tuple[Buffer, Buffer]] | None = None

    @property
    def size_px(self) -> tuple[int, int]:
        return self._size_px

    @property
    def serials(self) -> tuple[str, str]:
        return self._stand.rig.calibration.serials

    @property
    def is_open(self) -> bool:
        return self._link.is_open

    async def open(self) -> None:
        if not self.is_open:
            self._link.open()
            self._next_block = 0

    async def close(self) -> None:
        self._link.close()

    async def identity(self) -> Identity:
        self._link.check()
        return self._link.identity

    def set_regions(self, left: Region, right: Region) -> Motion[None]:
        for side, region in (("left", left), ("right", right)):
            if not region.is_inside(*self._size_px):
                raise ValueError(f"the {side} region {region} leaves the sensor {self._size_px}")
        if (left.width_px, left.height_px) != (right.width_px, right.height_px):
            raise ValueError(f"regions differ in size: {left} and {right}")
        return Motion(self._set_regions(left, right), name=f"{self.name} set_regions")

    def set_exposure(self, exposure_s: float) -> Motion[None]:
        wanted_s = _checked_exposure(exposure_s)
        return Motion(self._set_exposure(wanted_s), name=f"{self.name} set_exposure")

    def capture(self, *, shots: int = 1, timeout_s: float = 5.0) -> Motion[StereoCapture]:
        if shots < 1:
            raise ValueError(f"a capture has at least one shot, not {shots}")
        if not timeout_s > 0:
            raise ValueError(f"a timeout is longer than {timeout_s:g} s")
        return Motion(self._capture(shots, timeout_s), name=f"{self.name} capture")

    async def _set_regions(self, left: Region, right: Region) -> None:
        self._link.check()
        self._regions = (left, right)

    async def _set_exposure(self, exposure_s: float) -> None:
        self._link.check()
        self._exposure_s = exposure_s

    async def _capture(self, shots: int, timeout_s: float) -> StereoCapture:
        self._link.check()
        try:
            async with asyncio.timeout(timeout_s):
                triggers = [await self._expose() for _ in range(shots)]
                await asyncio.sleep(READOUT_S)
                self._link.check()
                if self._is_anything_missing(shots):
                    await asyncio.get_running_loop().create_future()
        except TimeoutError as error:
            raise DeviceTimeoutError(
                device=self.name, action="capture", timeout_s=timeout_s
            ) from error
        regions, faults = self._regions, replace(self._stand.faults)
        job = partial(self._draw, triggers, regions, faults)
        images = await compute(job, name=f"{self.name} draw")
        return StereoCapture(images, self.serials, self._stand.renderer.sensor.bits)

    def _is_anything_missing(self, shots: int) -> bool:
        faults = self._stand.faults
        if faults.frames_to_drop > 0:
            faults.frames_to_drop = max(0, faults.frames_to_drop - shots)
            return True
        return bool(faults.dead)

    async def _expose(self) -> _Trigger:
        """Wait for the sensor, freeze the scene, expose."""
        loop = asyncio.get_running_loop()
        if (wait_s := self._ready_at_s - loop.time()) > 0:
            await asyncio.sleep(wait_s)
        self._link.check()
        began_s, exposure_s = loop.time(), self._exposure_s
        self._ready_at_s = began_s + max(self._frame_period_s, exposure_s)
        block_id = self._next_block
        self._next_block += 1
        faults, rig = self._stand.faults, self._stand.rig
        pattern = self._stand.lamp.next_pattern()
        exposure = Exposure(
            pattern=None if faults.is_lamp_dead else pattern,
            exposure_s=exposure_s * faults.brightness,
            noise_key=(rig.seed, block_id),
            noise_scale=faults.noise_scale,
        )
        stamp_ns = round(began_s * 1_000_000_000)
        poses = Poses.of_world(self._world)
        trigger = _Trigger(poses, exposure, block_id, stamp_ns, exposure_s)
        await asyncio.sleep(exposure_s)
        return trigger

    def _draw(
        self, triggers: list[_Trigger], regions: tuple[Region, Region], faults: CameraFaults
    ) -> tuple[StereoShot, ...]:
        """In a worker thread: images of frozen scenes, drawn anew only where things moved."""
        images: list[tuple[Image, Image]] = []
        for buffers, group in self._grouped(triggers, regions):
            exposures = [trigger.exposure for trigger in group]
            images += self._stand.renderer.sequence(buffers, regions, exposures)
        shots = []
        for trigger, (left, right) in zip(triggers, images, strict=True):
            first, second = (right, left) if faults.are_swapped else (left, right)
            if faults.is_mirrored:
                first, second = np.fliplr(first).copy(), np.fliplr(second).copy()
            shots.append(
                StereoShot(
                    left=first,
                    right=second,
                    left_region=regions[0],
                    right_region=regions[1],
                    block_id=trigger.block_id,
                    stamp_ns=trigger.stamp_ns,
                    exposure_s=trigger.exposure_s,
                )
            )
        return tuple(shots)

    def _grouped(
        self, triggers: list[_Trigger], regions: tuple[Region, Region]
    ) -> list[tuple[tuple[Buffer, Buffer], list[_Trigger]]]:
        """Put shots of one unmoved scene together, in order, with its geometry."""
        groups: list[tuple[tuple[Buffer, Buffer], list[_Trigger]]] = []
        for trigger in triggers:
            buffers = self._buffers(trigger.poses, regions)
            if groups and groups[-1][0] is buffers:
                groups[-1][1].append(trigger)
            else:
                groups.append((buffers, [trigger]))
        return groups

    def _buffers(self, poses: Poses, regions: tuple[Region, Region]) -> tuple[Buffer, Buffer]:
        if self._drawn is not None:
            known, known_regions, buffers = self._drawn
            renderer = self._stand.renderer
            if known_regions == regions and renderer.is_same_picture(known, poses, *regions):
                return buffers
        buffers = self._stand.renderer.buffers(poses, *regions)
        self._drawn = (poses, regions, buffers)
        return buffers


def _checked_exposure(exposure_s: float) -> float:
    if not SHORTEST_EXPOSURE_S <= exposure_s <= LONGEST_EXPOSURE_S:
        raise ValueError(
            f"exposure is {SHORTEST_EXPOSURE_S:g} to {LONGEST_EXPOSURE_S:g} s, not {exposure_s:g}"
        )
    return exposure_s
