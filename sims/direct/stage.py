"""Hands in the simulated world for the conformance suites; only tests import this."""

import numpy as np

from drivers.arms import Kinematics
from hal import OperatingMode, Transform
from hal.conformance import Stage, StageCannotError
from sims.world import Faults, World

__all__ = ["WorldStage"]


class WorldStage(Stage):
    """Arranges a world around the device ``device`` (a direct device's name)."""

    def __init__(self, world: World, device: str) -> None:
        self.world = world
        self.faults = Faults(world)
        self._device = device

    async def cut_link(self) -> None:
        self.faults.cut_link(self._device)

    async def restore_link(self) -> None:
        self.faults.restore_link(self._device)

    async def press_emergency_stop(self) -> None:
        self.faults.press_emergency_stop()

    async def release_emergency_stop(self) -> None:
        self.faults.release_emergency_stop()

    async def press_protective_stop(self) -> None:
        self.faults.press_protective_stop()

    async def release_protective_stop(self) -> None:
        self.faults.release_protective_stop()

    async def switch_motors(self, is_on: bool) -> None:
        self.faults.switch_motors(is_on)

    async def turn_key(self, mode: OperatingMode) -> None:
        self.faults.turn_key(mode)

    async def true_joints_rad(self) -> tuple[float, ...]:
        return tuple(float(q) for q in self.world.data.qpos[:6])

    async def place_part(self, size_m: float) -> None:
        """Hang part 0 weightless between the pads, its axis across the closing direction."""
        shape = self.world.shape
        if shape is None or abs(2 * shape.radius_m - size_m) > 1e-9:
            raise StageCannotError("place_part")
        self.world.put_part(0, grasp_pose(self.world), is_floating=True)

    async def pull_part(self) -> None:
        self.world.set_floating(0, False)
        self.faults.drop_part()

    async def block_fingers(self, width_m: float) -> None:
        self.faults.block_fingers(width_m)

    async def unblock_fingers(self) -> None:
        self.faults.unblock_fingers()

    async def true_width_m(self) -> float:
        data = self.world.data
        joints = [data.joint(name).qpos[0] for name in ("finger_left", "finger_right")]
        return float(sum(joints))

    async def set_input(self, name: str, value: bool) -> None:
        self.faults.set_input(name, value)

    async def true_output(self, name: str) -> bool:
        return self.world.cabinet.outputs[name]


def grasp_pose(world: World) -> Transform:
    """Where a turned part lies between the pads, its axis along the tool's x: base, object."""
    T_base_flange = Kinematics(world.arm_model).forward(world.arm.measured_rad)
    tool = T_base_flange[:3, :3]
    place = T_base_flange[:3, 3] + tool[:, 2] * world.layout.fingers.tcp_m
    rotation = np.column_stack([tool[:, 1], tool[:, 2], tool[:, 0]])
    return Transform.from_parts("base", "object", rotation, place)
