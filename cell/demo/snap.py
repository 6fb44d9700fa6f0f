"""One capture of a simulated bin as a shot folder, with the truth beside it if asked."""

import asyncio
from pathlib import Path
from typing import Any

from cell.build import make_rig
from cell.config import CellConfig
from cell.demo.controls import Controls
from cell.demo.twin import Twin
from cell.journal import quantise
from hal import StereoCapture
from hal.errors import ConfigError
from perception.files import write_shot
from perception.parts import Part
from perception.rectify import T_base_camera, rectifier_for, regions_for
from perception.volume import Volume
from sims.camera.bodies import Poses
from sims.camera.truth import visible_shares
from sims.loop import LockstepLoop

__all__ = ["snap"]


def snap(
    folder: Path,
    config: CellConfig,
    part: Part,
    *,
    count: int,
    seed: int,
    controls: Controls,
    has_truth: bool,
    is_whole: bool,
) -> dict[str, Any]:
    """Fill a bin, take a capture, write the folder; return a summary of it.

    Raises
    ------
    ConfigError
        The folder exists already, or the parts do not fit.
    """
    if folder.exists():
        raise ConfigError("exists already: name another folder or remove it", source=str(folder))
    twin = Twin.filled(config, part, count=count, seed=seed, controls=controls)
    loop = LockstepLoop(twin.world)
    try:
        asyncio.set_event_loop(loop)
        capture = loop.run_until_complete(_capture(twin, is_whole))
    finally:
        asyncio.set_event_loop(None)
        loop.close()
    truth = _truth(twin, capture) if has_truth else None
    write_shot(folder, capture, twin.calibration, truth=truth)
    shot = capture.shots[0]
    return {
        "folder": str(folder),
        "parts": [part.name],
        "count": count,
        "seed": seed,
        "shots": len(capture.shots),
        "width_px": shot.left_region.width_px,
        "height_px": shot.left_region.height_px,
        "serials": list(capture.serials),
    }


async def _capture(twin: Twin, is_whole: bool) -> StereoCapture:
    config = twin.config.camera
    rig_camera, rig_projector = make_rig(twin.config, {"sim": twin.world})
    async with rig_camera as camera, rig_projector as projector:
        if not is_whole:
            volume = Volume.of_bin(twin.config.layout.bin, margin_m=config.margin_m)
            await camera.set_regions(*regions_for(twin.calibration, volume))
        await camera.set_exposure(config.exposure_s)
        await projector.set_light(True)
        await projector.load_sequence(list(range(min(config.shots, projector.pattern_count))))
        return await camera.capture(shots=config.shots, timeout_s=config.timeout_s)


def _truth(twin: Twin, capture: StereoCapture) -> dict[str, Any]:
    """Where every part really is, in the true base and in the frame that the file defines."""
    box = twin.config.layout.bin
    shot = capture.shots[0]
    pinhole = rectifier_for(
        twin.calibration, shot.left_region, shot.right_region, Volume.of_bin(box)
    ).pinhole
    bodies, poses = twin.stand.renderer.bodies, Poses.of_world(twin.world)
    shares = visible_shares(twin.stand.rig, bodies, poses, twin.calibration, pinhole)
    # The true camera, and the rectification that the file asks for: where a perfect matcher
    # with this calibration would see the part.
    true = twin.stand.rig.calibration
    T_left_camera = twin.calibration.T_base_left.inverse() @ T_base_camera(twin.calibration)
    T_camera_base = (true.T_base_left @ T_left_camera).inverse()
    rows = []
    for k in range(twin.world.parts):
        T_base_part = twin.world.part_pose(k) @ twin.part.T_object_mesh
        rows.append(
            {
                "part": twin.part.name,
                "T_base_part": T_base_part.matrix,
                "T_camera_part": (T_camera_base @ T_base_part).matrix,
                "visible": shares.get(k, 0.0),
            }
        )
    answer: dict[str, Any] = quantise({"parts": rows})
    return answer
