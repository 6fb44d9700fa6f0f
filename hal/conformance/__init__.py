"""The promises of hal's interfaces as tests: subclass one, say how to get a device, and run.

A subclass lives in a test module, is called ``Test...``, names its ``backend`` and gives a
``make_bench``. It adds no promise and replaces none; what its device or its stage cannot do it
lists in ``lacks``, by the name of the promise or of the stage's ability, with the reason.
``pytest_plugins = ["hal.conformance.plugin"]`` in the test suite's conftest runs the coroutine
tests on the bench's loop, fails skips that were not declared, and prints who keeps what.
"""

import pytest

for _name in ("base", "camera", "gripper", "io", "projector", "robot"):
    pytest.register_assert_rewrite(f"hal.conformance.{_name}")

from hal.conformance.base import Bench, Conformance  # noqa: E402
from hal.conformance.camera import CameraConformance  # noqa: E402
from hal.conformance.gripper import GripperConformance  # noqa: E402
from hal.conformance.io import IoConformance  # noqa: E402
from hal.conformance.projector import ProjectorConformance  # noqa: E402
from hal.conformance.robot import RobotConformance  # noqa: E402
from hal.conformance.stage import Stage, StageCannotError  # noqa: E402

__all__ = [
    "Bench",
    "CameraConformance",
    "Conformance",
    "GripperConformance",
    "IoConformance",
    "ProjectorConformance",
    "RobotConformance",
    "Stage",
    "StageCannotError",
]
