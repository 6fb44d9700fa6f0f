"""Every direct device keeps the promises of its interface."""

from sims.direct.suites import (
    TestDirectCamera,
    TestDirectGripper,
    TestDirectIo,
    TestDirectProjector,
    TestDirectRobot,
)

__all__ = [
    "TestDirectCamera",
    "TestDirectGripper",
    "TestDirectIo",
    "TestDirectProjector",
    "TestDirectRobot",
]
