"""hal devices straight on the world: fast, deterministic, and no wiser than the hardware."""

from sims.direct.camera import DirectCamera
from sims.direct.gripper import DirectGripper
from sims.direct.io import DirectIo
from sims.direct.projector import DirectProjector
from sims.direct.robot import DirectRobot

__all__ = ["DirectCamera", "DirectGripper", "DirectIo", "DirectProjector", "DirectRobot"]
