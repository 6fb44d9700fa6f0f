"""Devices that are there: codec, transport and device, one folder a family."""

from hal.registry import Backend, Kind, Scheme

__all__ = ["BACKENDS", "SCHEMES", "SUITES"]

ABB_NEEDS = "RAPID sockets (616-1) and a second task (623-1); see docs/how-to/connect-an-abb.md"

BACKENDS: dict[str, Backend] = {
    "abb-rapid": Backend(Kind.ROBOT, "drivers.abb:RapidRobot", "tcp", ABB_NEEDS),
    "abb-io": Backend(Kind.IO, "drivers.abb:RapidIo", "tcp", ABB_NEEDS),
}

SCHEMES: dict[str, Scheme] = {
    "tcp": Scheme("drivers.transports:open_tcp", "tcp:192.168.125.1"),
}

# With the simulated controller behind the wire.
SUITES: dict[str, str] = {
    "abb-rapid": "sims.controller.suites:TestRapidRobot",
    "abb-io": "sims.controller.suites:TestRapidIo",
}
