"""An ABB arm as a ``hal.Robot``: in terms of messages, without struct or socket."""

import asyncio
import contextlib
from collections.abc import Sequence

import numpy as np

from drivers.abb.checklist import forbidden, refusal
from drivers.abb.messages import (
    Code,
    ControllerState,
    Flag,
    Message,
    Outcome,
    SetAcceleration,
    SetLoad,
    SetTool,
    SetWorkObject,
)
from drivers.abb.motion import MotionLink
from drivers.abb.reach import Reach
from drivers.abb.session import MONITOR_PORT, MOTION_PORT, Session
from drivers.abb.targets import MAX_TARGETS, pose_numbers, triple, wire_targets
from drivers.arms import ARMS, Kinematics
from drivers.transports import Connector
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
from hal.errors import (
    CellError,
    DeviceTimeoutError,
    LinkError,
    RejectedError,
)

__all__ = ["RapidRobot"]

RELEASE_TIMEOUT_S = 3.0


class RapidRobot(Robot):
    """Drives the motion task and the monitor task of the controller package.

    The monitor connection lives as long as the device is open; the motion connection is made
    when a motion is asked for, and anew when it was lost. ``hal.errors`` says what may go wrong,
    ``drivers.abb.checklist`` in which words.
    """

    def __init__(
        self,
        connector: Connector,
        *,
        name: str = "robot",
        arm: str = "irb1200-5-0.9",
        motion_port: int = MOTION_PORT,
        monitor_port: int = MONITOR_PORT,
    ) -> None:
        if arm not in ARMS:
            raise ValueError(f"arm {arm!r} is unknown; known: {', '.join(sorted(ARMS))}")
        self.name = name
        self._connector = connector
        self._ports = motion_port, monitor_port
        self._kinematics = Kinematics(ARMS[arm])
        self._tool = Tool(Transform.identity("flange", "tcp"))
        self._load = Load()
        self._T_base_object = Transform.identity("base", "object")
        self._session: Session | None = None
        self._link: MotionLink | None = None
        self._opening = asyncio.Lock()
        self._setting = asyncio.Lock()
        self._is_busy = False
        self._is_stopping = False

    @property
    def limits(self) -> RobotLimits:
        return self._kinematics.arm.limits

    @property
    def is_open(self) -> bool:
        return self._session is not None and self._session.is_open

    async def open(self) -> None:
        async with self._opening:
            if not self.is_open:
                await self.close()
                await self._join()

    async def _join(self) -> None:
        session = await Session.join(self._connector, self.name, self._ports[1])
        self._session = session
        self._link = MotionLink(session, self.name, self._ports[0])

    async def close(self) -> None:
        session, self._session = self._session, None
        if session is None:
            return
        if session.is_open and self._is_busy:
            with contextlib.suppress(CellError):
                self._is_stopping = True
                await session.stop()
        if self._link is not None:
            await self._link.close()
        await session.leave()

    async def identity(self) -> Identity:
        identity = await self._linked().who()
        model = identity.robot_type or self._kinematics.arm.model
        return Identity("ABB", model, identity.serial, identity.version)

    async def state(self) -> RobotState:
        session = self._linked()
        return self._told(session, await session.fresh_state())

    def move(self, targets: Sequence[Target]) -> Motion[RobotState]:
        if not targets:
            raise ValueError("no targets")
        if len(targets) > MAX_TARGETS:
            raise ValueError(
                f"{len(targets)} targets; the controller queues {MAX_TARGETS} a motion"
            )
        for target in targets:
            self.limits.check_target(target)
        return Motion(self._move(list(targets)), name=f"{self.name} move")

    def set_tool(self, tool: Tool) -> Motion[None]:
        self.limits.check_load(tool.load)
        return Motion(self._set_tool(tool), name=f"{self.name} set_tool")

    def set_load(self, load: Load) -> Motion[None]:
        self.limits.check_load(load)
        return Motion(self._set_load(load), name=f"{self.name} set_load")

    def set_work_object(self, T_base_object: Transform) -> Motion[None]:
        """Tell the controller of targets in this frame from now on (RAPID's ``wobjdata``).

        The targets of ``move`` stay in the base frame; what the pendant and the event log say of
        them, and their rounding to binary32, is in the work object's.
        """
        frames = (T_base_object.parent, T_base_object.child)
        if frames != ("base", "object"):
            raise ValueError(f"a work object relates base and object, not {' and '.join(frames)}")
        return Motion(self._set_work_object(T_base_object), name=f"{self.name} set_work_object")

    def set_acceleration(self, share: float, ramp_share: float = 1.0) -> Motion[None]:
        """Soften all motions from now on (RAPID's ``AccSet``): shares of the normal values.

        Raises
        ------
        ValueError
            ``share`` outside 0.2..1, ``ramp_share`` outside 0.1..1.
        """
        if not (0.2 <= share <= 1 and 0.1 <= ramp_share <= 1):
            raise ValueError(f"acceleration {share:g} and ramp {ramp_share:g} are not in 0.2..1")
        message = SetAcceleration(100 * share, 100 * ramp_share)
        return Motion(self._set(message), name=f"{self.name} set_acceleration")

    def stop(self) -> Motion[RobotState]:
        return Motion(self._stop(), name=f"{self.name} stop")

    # Moving.

    async def _move(self, targets: list[Target]) -> RobotState:
        session = self._linked()
        self._check_idle("the motion")
        self._is_busy, self._is_stopping = True, False
        try:
            async with self._setting:  # a setting that was ordered before is made before
                state = await self._may_move(session)
                link = await self._ready_link()
            outcome = await self._drive(session, link, targets, state)
            await link.judge(outcome, is_stopping=self._is_stopping)
            return self._told(session, await session.fresh_state())
        finally:
            self._is_busy = False

    async def _drive(
        self, session: Session, link: MotionLink, targets: list[Target], state: ControllerState
    ) -> Outcome:
        """Run the targets to their end. Whatever is raised, the arm is not left moving."""
        reach = Reach(self._kinematics, self._tool.T_flange_tcp.inverse())
        joints = reach.follow(state.joints_rad, targets)
        T_object_base = self._T_base_object.inverse()
        messages = wire_targets(targets, joints, T_object_base, self._kinematics.arm)
        try:
            return await link.end(await link.begin(messages, state.tick))
        except BaseException:
            if link.may_be_driving:
                link.may_be_driving = False
                with contextlib.suppress(CellError):
                    await session.stop()
            raise

    async def _may_move(self, session: Session) -> ControllerState:
        """Return the state if motion is allowed; wait until the last stop's path is cleared."""
        state = await session.fresh_state()
        self._check_allowed(state)
        if state.hold is not Code.NONE:
            with contextlib.suppress(DeviceTimeoutError):
                await session.until(
                    lambda s: s.hold is Code.NONE or forbidden(s) is not Code.NONE,
                    timeout_s=RELEASE_TIMEOUT_S,
                )
            state = await session.fresh_state()
            self._check_allowed(state)
            if state.hold is not Code.NONE:
                raise RejectedError(
                    "the controller still holds the path of the last stop; program pointer to "
                    "main, press Start",
                    device=self.name,
                    code="held",
                )
        return state

    async def _stop(self) -> RobotState:
        session = self._linked()
        self._is_stopping = True
        await session.stop()
        return self._told(session, await session.fresh_state())

    # Settings.

    async def _set_tool(self, tool: Tool) -> None:
        self._linked()
        self._check_idle("a new tool")
        before, self._tool = self._tool, tool
        try:
            await self._set(self._tool_message())
        except BaseException:
            self._tool = before
            raise

    async def _set_load(self, load: Load) -> None:
        self._check_idle("a new load")
        before, self._load = self._load, load
        try:
            await self._set(self._load_message())
        except BaseException:
            self._load = before
            raise

    async def _set(self, message: Message) -> None:
        session = self._linked()
        self._check_idle("a setting")
        async with self._setting:
            code = forbidden(await session.fresh_state())
            if code is Code.PROGRAM_STOPPED:
                raise refusal(self.name, code)
            link = await self._ready_link()
            await link.set(message)

    async def _set_work_object(self, T_base_object: Transform) -> None:
        before, self._T_base_object = self._T_base_object, T_base_object
        try:
            await self._set(SetWorkObject(*pose_numbers(T_base_object)))
        except BaseException:
            self._T_base_object = before
            raise

    def _tool_message(self) -> SetTool:
        load = self._tool.load
        return SetTool(*pose_numbers(self._tool.T_flange_tcp), load.mass_kg, load.centre_m)

    def _load_message(self) -> SetLoad:
        centre = self._tool.T_flange_tcp.inverse().apply(np.array(self._load.centre_m))
        return SetLoad(self._load.mass_kg, triple(centre))

    # Connections.

    def _linked(self) -> Session:
        if self._session is None:
            raise LinkError("is not open", device=self.name)
        self._session.check()
        return self._session

    async def _ready_link(self) -> MotionLink:
        """Return the motion connection; made anew, it is told tool, load and work object."""
        assert self._link is not None
        settings = (
            self._tool_message(),
            self._load_message(),
            SetWorkObject(*pose_numbers(self._T_base_object)),
        )
        await self._link.ready(settings)
        return self._link

    # What is allowed, and what is told.

    def _check_idle(self, what: str) -> None:
        if self._is_busy:
            raise RejectedError(f"{what} was refused: busy", device=self.name, code="busy")

    def _check_allowed(self, state: ControllerState) -> None:
        code = forbidden(state)
        if code is not Code.NONE:
            raise refusal(self.name, code)

    def _told(self, session: Session, state: ControllerState) -> RobotState:
        flags = state.flags
        mode = OperatingMode.MANUAL_REDUCED
        if Flag.AUTO in flags:
            mode = OperatingMode.AUTO
        elif Flag.MANUAL_FULL in flags:
            mode = OperatingMode.MANUAL_FULL
        return RobotState(
            stamp_s=session.stamp_s(state),
            joints_rad=state.joints_rad,
            T_base_tcp=Transform.from_quaternion("base", "tcp", state.quaternion, state.position_m),
            is_moving=Flag.MOVING in flags,
            mode=mode,
            motors_on=Flag.MOTORS_ON in flags,
            protective_stop=Flag.PROTECTIVE_STOP in flags,
            emergency_stop=Flag.EMERGENCY_STOP in flags,
        )
