"""Devices that are not there: the MuJoCo world and what stands in front of it."""

from hal.registry import Backend, Kind, Scheme

__all__ = ["BACKENDS", "SCHEMES", "SUITES"]

NEEDS = "the extra 'sim': pip install binpick[sim]"

BACKENDS: dict[str, Backend] = {
    "direct-robot": Backend(Kind.ROBOT, "sims.direct:DirectRobot", "sim", NEEDS),
    "direct-gripper": Backend(Kind.GRIPPER, "sims.direct:DirectGripper", "sim", NEEDS),
    "direct-camera": Backend(Kind.CAMERA, "sims.direct:DirectCamera", "sim", NEEDS),
    "direct-projector": Backend(Kind.PROJECTOR, "sims.direct:DirectProjector", "sim", NEEDS),
    "direct-io": Backend(Kind.IO, "sims.direct:DirectIo", "sim", NEEDS),
}

SCHEMES: dict[str, Scheme] = {
    "sim": Scheme("sims.world.serving:open_address", "sim:"),
    "sim-abb": Scheme("sims.controller.wire:open_address", "sim-abb:"),
}

SUITES: dict[str, str] = {
    "direct-robot": "sims.direct.suites:TestDirectRobot",
    "direct-gripper": "sims.direct.suites:TestDirectGripper",
    "direct-camera": "sims.direct.suites:TestDirectCamera",
    "direct-projector": "sims.direct.suites:TestDirectProjector",
    "direct-io": "sims.direct.suites:TestDirectIo",
}
