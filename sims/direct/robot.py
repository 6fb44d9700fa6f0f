"""The simulated arm as a ``hal.Robot``, without a wire between."""

import asyncio
from collections.abc import Sequence

from drivers.arms import Kinematics
from hal import (
    Identity,
    Load,
    Motion,
    OperatingMode,
    Robot,
    RobotLimits,
    RobotState,
    Target,
    Tool,
    Transform,
)
from hal.errors import PreemptedError, RejectedError, SafetyError
from sims.direct.link import DirectLink
from sims.motion import Program, plan_program
from sims.world import World

__all__ = ["DirectRobot"]


class DirectRobot(Robot):
    """Moves the world's arm; measures what its resolvers say.

    The tool is, until another is set, the gripper the world has: ``layout.fingers.tcp_m``
    along the flange's z. Its weight is known to the controller; ``set_load`` is for the part.
    """

    def __init__(self, world: World, *, name: str = "robot") -> None:
        arm = world.arm_model
        self.name = name
        self._link = DirectLink(world, name, Identity(arm.vendor, arm.model, "simulated"))
        self._world = world
        self._kinematics = Kinematics(arm)
        tcp_m = world.layout.fingers.tcp_m
        self._tool = Tool(Transform.from_translation("flange", "tcp", (0.0, 0.0, tcp_m)))
        self._load = Load()
        self._program: Program | None = None
        self._is_stopping = False

    @property
    def limits(self) -> RobotLimits:
        return self._kinematics.arm.limits

    @property
    def is_open(self) -> bool:
        return self._link.is_open

    async def open(self) -> None:
        self._link.open()

    async def close(self) -> None:
        if self._link.is_open and self._program is not None:
            await self.stop()
        self._link.close()

    async def identity(self) -> Identity:
        self._link.check()
        return self._link.identity

    async def state(self) -> RobotState:
        self._link.check()
        return self._state()

    def move(self, targets: Sequence[Target]) -> Motion[RobotState]:
        if not targets:
            raise ValueError("no targets")
        for target in targets:
            self.limits.check_target(target)
        return Motion(self._move(list(targets)), name=f"{self.name} move")

    def set_tool(self, tool: Tool) -> Motion[None]:
        self.limits.check_load(tool.load)
        return Motion(self._set_tool(tool), name=f"{self.name} set_tool")

    def set_load(self, load: Load) -> Motion[None]:
        self.limits.check_load(load)
        return Motion(self._set_load(load), name=f"{self.name} set_load")

    def stop(self) -> Motion[RobotState]:
        return Motion(self._stop(), name=f"{self.name} stop")

    def _check_may_move(self) -> None:
        safety = self._world.cabinet.safety
        self._check_safe()
        for is_wrong, code in (
            (not safety.motors_on, "motors off"),
            (safety.mode is not OperatingMode.AUTO, "not in auto"),
            (self._program is not None or self._world.arm.is_following, "busy"),
        ):
            if is_wrong:
                raise RejectedError(f"the motion was refused: {code}", device=self.name, code=code)

    def _check_safe(self) -> None:
        safety = self._world.cabinet.safety
        if safety.emergency_stop:
            raise SafetyError(f"{self.name}: the emergency stop is pressed")
        if safety.protective_stop:
            raise SafetyError(f"{self.name}: a protective stop is active")

    async def _move(self, targets: list[Target]) -> RobotState:
        self._link.check()
        self._check_may_move()
        world = self._world
        start = world.arm.target_rad
        program = plan_program(self._kinematics, start, targets, self._tool, world.physics.tick_s)
        self._program, self._is_stopping = program, False
        world.arm.follow(program)
        try:
            await self._standing()
        except asyncio.CancelledError:
            world.arm.brake()
            await world.until(lambda: world.arm.is_standing)
            raise
        finally:
            self._program = None
        return self._ended(program)

    def _ended(self, program: Program) -> RobotState:
        """Say how the motion ended: at its target, or why not."""
        self._link.check()
        self._check_safe()
        if self._is_stopping:
            raise PreemptedError("the motion was stopped", device=self.name)
        if not self._world.cabinet.safety.motors_on or program.was_stopped:
            raise SafetyError(f"{self.name}: the motors went off during the motion")
        return self._state()

    async def _standing(self) -> None:
        """Wait until the arm stands; a controller without a link stops it."""
        world = self._world
        await world.until(lambda: not self._link.is_open or world.arm.is_standing)
        if not self._link.is_open:
            world.arm.brake()

    async def _set_tool(self, tool: Tool) -> None:
        self._link.check()
        if self._program is not None:
            raise RejectedError("no new tool while moving", device=self.name, code="busy")
        self._tool = tool
        self._world.arm.set_load(self._load)

    async def _set_load(self, load: Load) -> None:
        self._link.check()
        self._load = load
        self._world.arm.set_load(load)

    async def _stop(self) -> RobotState:
        self._link.check()
        self._is_stopping = True
        self._world.arm.brake()
        await self._link.wait(lambda: self._world.arm.is_standing)
        return self._state()

    def _state(self) -> RobotState:
        safety = self._world.cabinet.safety
        joints = self._world.arm.measured_rad
        T_base_flange = Transform("base", "flange", self._kinematics.forward(joints))
        return RobotState(
            stamp_s=self._link.stamp_s,
            joints_rad=tuple(float(q) for q in joints),
            T_base_tcp=T_base_flange @ self._tool.T_flange_tcp,
            is_moving=not self._world.arm.is_standing,
            mode=safety.mode,
            motors_on=safety.motors_on,
            protective_stop=safety.protective_stop,
            emergency_stop=safety.emergency_stop,
        )
