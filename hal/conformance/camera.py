"""The promises of ``hal.StereoCamera``."""

import asyncio
from typing import Any, ClassVar

import numpy as np
import pytest

from hal.calibration import Region
from hal.camera import StereoCamera
from hal.conformance.base import Conformance
from hal.conformance.stage import Stage
from hal.errors import DeviceTimeoutError, LinkError

__all__ = ["CameraConformance"]


class CameraConformance(Conformance):
    """The scene must stand still, and must not be dark.

    ``region`` keeps the images small; ``exposure_s`` is one that suits the scene.
    """

    interface = "camera"
    region: ClassVar[Region] = Region(800, 500, 160, 120)
    exposure_s: ClassVar[float] = 0.002

    @pytest.fixture
    def camera(self, device: StereoCamera) -> StereoCamera:
        return device

    async def prepare(self, device: Any) -> None:
        await device.set_regions(self.region, self.region)
        await device.set_exposure(self.exposure_s)

    async def test_there_are_two_different_cameras(self, camera: StereoCamera) -> None:
        left, right = camera.serials
        assert left
        assert right
        assert left != right
        assert (await camera.capture()).serials == camera.serials

    async def test_images_have_the_size_of_their_regions(self, camera: StereoCamera) -> None:
        other = Region(self.region.offset_x_px + 8, self.region.offset_y_px + 4, 96, 64)
        for region in (self.region, other):
            await camera.set_regions(region, region)
            shot = (await camera.capture()).shots[0]
            assert shot.left_region == shot.right_region == region
            for image in (shot.left, shot.right):
                assert image.shape == (region.height_px, region.width_px)
                assert image.dtype in (np.uint8, np.uint16)

    async def test_grey_levels_fit_the_bits(self, camera: StereoCamera) -> None:
        capture = await camera.capture()
        for image in (capture.shots[0].left, capture.shots[0].right):
            assert image.max() < 2**capture.bits
            assert image.max() > image.min()

    async def test_several_shots_come_in_the_order_they_were_exposed(
        self, camera: StereoCamera
    ) -> None:
        capture = await camera.capture(shots=3)
        assert len(capture.shots) == 3
        assert (np.diff([shot.stamp_ns for shot in capture.shots]) > 0).all()
        assert (np.diff([shot.block_id for shot in capture.shots]) == 1).all()

    async def test_block_ids_and_stamps_go_on_from_capture_to_capture(
        self, camera: StereoCamera
    ) -> None:
        first = (await camera.capture()).shots[-1]
        second = (await camera.capture()).shots[0]
        assert second.block_id == first.block_id + 1
        assert second.stamp_ns > first.stamp_ns

    async def test_a_longer_exposure_is_brighter_and_is_told(self, camera: StereoCamera) -> None:
        levels = []
        for factor in (0.25, 1.0):
            await camera.set_exposure(self.exposure_s * factor)
            shot = (await camera.capture()).shots[0]
            assert shot.exposure_s == pytest.approx(self.exposure_s * factor, rel=0.01)
            levels.append(float(shot.left.mean()))
        assert levels[1] > 1.5 * levels[0]

    async def test_a_region_is_a_window_of_the_sensor(self, camera: StereoCamera) -> None:
        whole = (await camera.capture()).shots[0]
        r = self.region
        half = Region(r.offset_x_px + r.width_px // 2, r.offset_y_px, r.width_px // 2, r.height_px)
        await camera.set_regions(half, half)
        part = (await camera.capture()).shots[0]
        seen = whole.left[:, r.width_px // 2 :].astype(float)
        difference = np.abs(part.left.astype(float) - seen).mean()
        shifted = np.abs(part.left.astype(float) - np.roll(seen, 3, axis=1)).mean()
        assert difference < shifted

    async def test_nonsense_is_a_value_error_at_once(self, camera: StereoCamera) -> None:
        width, height = camera.size_px
        outside = Region(width - 10, 0, 20, 20)
        small = Region(0, 0, 64, 32)
        with pytest.raises(ValueError, match="left"):
            camera.set_regions(outside, small)
        with pytest.raises(ValueError, match="differ"):
            camera.set_regions(small, Region(0, 0, 64, 64))
        with pytest.raises(ValueError, match="exposure"):
            camera.set_exposure(0.0)
        with pytest.raises(ValueError, match="exposure"):
            camera.set_exposure(1e6)
        with pytest.raises(ValueError, match="shot"):
            camera.capture(shots=0)
        with pytest.raises(ValueError, match=r"time-?out"):
            camera.capture(timeout_s=0.0)
        assert Region(0, 0, width, height).is_inside(*camera.size_px)

    async def test_images_that_do_not_come_are_a_timeout(
        self, camera: StereoCamera, stage: Stage
    ) -> None:
        await stage.stop_frames()
        with pytest.raises(DeviceTimeoutError) as caught:
            await camera.capture(timeout_s=0.5)
        assert caught.value.timeout_s == 0.5

    async def test_a_cancelled_capture_leaves_a_camera_that_works(
        self, camera: StereoCamera
    ) -> None:
        capture = camera.capture(shots=4)
        await asyncio.sleep(0.01)
        capture.cancel()
        with pytest.raises(asyncio.CancelledError):
            await capture
        assert len((await camera.capture(shots=2)).shots) == 2

    async def test_closed_it_takes_no_images(self, camera: StereoCamera) -> None:
        await camera.close()
        with pytest.raises(LinkError):
            await camera.capture()
