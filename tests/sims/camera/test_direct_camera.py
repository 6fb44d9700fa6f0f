import asyncio

import numpy as np
import pytest

from hal import Region, Transform
from hal.errors import DeviceTimeoutError, LinkError
from sims.camera import hang_rig, rig_over
from sims.direct import DirectCamera, DirectProjector
from sims.loop import LockstepLoop
from sims.world import World
from sims.world.shapes import cylinders

SMALL = (Region(1000, 520, 224, 176), Region(720, 520, 224, 176))


def run(test, *, seed=0, parts=1):
    """Run ``test(world, camera, projector)`` in lock-step with small regions."""
    world = World(shape=cylinders((-0.04, 0.04), (0.015,)), parts=parts)
    world.put_part(0, Transform.from_translation("base", "object", (0.55, 0.0, 0.3)))
    hang_rig(world, seed=seed)
    loop = LockstepLoop(world)

    async def main():
        async with DirectCamera(world) as camera, DirectProjector(world) as projector:
            await camera.set_regions(*SMALL)
            return await test(world, camera, projector)

    try:
        return loop.run_until_complete(main())
    finally:
        loop.close()


def test_shots_follow_at_the_frame_rate_with_ids_and_stamps():
    async def test(world, camera, projector):
        first = await camera.capture(shots=3)
        second = await camera.capture()
        return first, second, asyncio.get_running_loop().time()

    first, second, now_s = run(test)
    shots = (*first.shots, *second.shots)
    assert [shot.block_id for shot in shots] == [0, 1, 2, 3]
    gaps = np.diff([shot.stamp_ns for shot in shots]) / 1e9
    assert gaps[:2] == pytest.approx([1 / 41] * 2, abs=2e-9)
    assert gaps[2] >= 1 / 41 - 1e-9
    assert shots[-1].stamp_ns / 1e9 + 0.010 < now_s < 0.5
    assert first.serials == second.serials
    assert shots[0].left.shape == (176, 224)
    assert shots[0].left.dtype == np.uint8
    assert (shots[0].left_region, shots[0].right_region) == SMALL
    assert shots[0].exposure_s == 0.010


def test_each_exposure_shows_the_projectors_next_pattern():
    async def test(world, camera, projector):
        rig_over(world).faults.noise_scale = 0.0
        world.set_floating(0, True)
        await projector.load_sequence([4, 2])
        capture = await camera.capture(shots=4)
        await projector.set_light(False)
        dark = await camera.capture()
        return [shot.left.astype(int) for shot in capture.shots], dark.shots[0].left

    images, dark = run(test)
    assert np.abs(images[0] - images[2]).max() <= 1
    assert np.abs(images[1] - images[3]).max() <= 1
    assert np.abs(images[0] - images[1]).max() > 50
    assert dark.max() < 40


def test_the_scene_is_frozen_at_each_exposure_and_a_falling_part_moves_between():
    async def test(world, camera, projector):
        rig_over(world).faults.noise_scale = 0.0
        await projector.load_sequence([0])
        world.put_part(0, Transform.from_translation("base", "object", (0.55, 0.0, 0.3)))
        first = await camera.capture(shots=2)
        return [shot.left.astype(int) for shot in first.shots]

    images = run(test)
    assert np.abs(images[0] - images[1]).mean() > 1


def test_reruns_give_the_same_bits_and_another_seed_another_rig():
    async def test(world, camera, projector):
        capture = await camera.capture(shots=2)
        return capture.serials, b"".join(
            s.left.tobytes() + s.right.tobytes() for s in capture.shots
        )

    assert run(test) == run(test)
    assert run(test)[0] != run(test, seed=1)[0]


def test_a_longer_exposure_is_brighter_and_takes_longer():
    async def test(world, camera, projector):
        short = await camera.capture()
        await camera.set_exposure(0.040)
        long = await camera.capture(shots=2)
        return short.shots[0], long.shots

    short, (first, second) = run(test)
    assert first.left.mean() > 1.5 * short.left.mean()
    assert second.stamp_ns - first.stamp_ns >= 40_000_000
    assert first.exposure_s == 0.040


def test_wrong_arguments_are_refused_before_anything_happens():
    async def test(world, camera, projector):
        outside = Region(1900, 0, 224, 176)
        larger = Region(0, 0, 232, 176)
        for regions in ((outside, SMALL[1]), (SMALL[0], larger)):
            with pytest.raises(ValueError, match="region"):
                camera.set_regions(*regions)
        for exposure_s in (0.0, -1.0, 2.0, float("nan")):
            with pytest.raises(ValueError, match="exposure"):
                camera.set_exposure(exposure_s)
        with pytest.raises(ValueError, match="shot"):
            camera.capture(shots=0)
        with pytest.raises(ValueError, match="timeout"):
            camera.capture(timeout_s=0.0)
        for patterns in ([], [16], [-1]):
            with pytest.raises(ValueError, match="patterns"):
                projector.load_sequence(patterns)
        return await camera.capture()

    assert run(test).shots[0].block_id == 0


def test_a_dead_camera_and_a_lost_frame_are_timeouts_on_time_and_then_all_is_well():
    async def test(world, camera, projector):
        faults, loop = rig_over(world).faults, asyncio.get_running_loop()
        for fault in ("dead", "dropped"):
            began = loop.time()
            if fault == "dead":
                faults.dead.add("right")
            else:
                faults.frames_to_drop = 1
            with pytest.raises(DeviceTimeoutError, match="capture") as caught:
                await camera.capture(timeout_s=0.3)
            assert loop.time() - began == pytest.approx(0.3, abs=1e-6)
            assert caught.value.retryable
            faults.dead.clear()
            await camera.capture()
        with pytest.raises(DeviceTimeoutError):
            await camera.capture(shots=10, timeout_s=0.1)

    run(test)


def test_spoilt_pictures_are_spoilt_as_ordered():
    async def test(world, camera, projector):
        world.set_floating(0, True)
        faults = rig_over(world).faults
        faults.noise_scale = 0.0
        await projector.load_sequence([0])

        async def shoot():
            return (await camera.capture()).shots[0]

        good = await shoot()
        faults.are_swapped = True
        swapped = await shoot()
        faults.are_swapped, faults.is_mirrored = False, True
        mirrored = await shoot()
        faults.is_mirrored, faults.is_lamp_dead = False, True
        unlit = await shoot()
        faults.is_lamp_dead, faults.brightness = False, 0.0
        covered = await shoot()
        faults.brightness = 50.0
        burnt = await shoot()
        return good, swapped, mirrored, unlit, covered, burnt

    good, swapped, mirrored, unlit, covered, burnt = run(test)
    assert np.abs(swapped.left.astype(int) - good.right).max() <= 2
    assert np.abs(mirrored.left[:, ::-1].astype(int) - good.left).max() <= 2
    assert unlit.left.max() < 40 < good.left.max()
    assert covered.left.max() <= 1
    assert (burnt.left == 255).mean() > 0.5


def test_a_closed_camera_says_so():
    async def test(world, camera, projector):
        await camera.capture()
        await camera.close()
        assert not camera.is_open
        with pytest.raises(LinkError):
            await camera.capture()
        await camera.open()
        assert (await camera.capture()).shots[0].block_id == 0

    run(test)
