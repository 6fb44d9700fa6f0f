"""The simulated gripper as a ``hal.Gripper``, without a wire between."""

import asyncio
from collections.abc import Callable
from functools import partial

from hal import (
    GraspOutcome,
    GraspResult,
    Gripper,
    GripperCapability,
    GripperEvent,
    GripperLimits,
    GripperMode,
    GripperState,
    HomeResult,
    Identity,
    Motion,
    MoveResult,
)
from hal.errors import FaultError, PreemptedError, RejectedError
from sims.direct.link import DirectLink
from sims.world import World
from sims.world.fingers import FingerAxis, Phase, Window

__all__ = ["DirectGripper"]

MODES = {
    Phase.IDLE: GripperMode.READY,
    Phase.MOVING: GripperMode.MOVING,
    Phase.CLOSING: GripperMode.GRIPPING,
    Phase.LATCHING: GripperMode.GRIPPING,
    Phase.HOLDING: GripperMode.HOLDING,
    Phase.WRONG: GripperMode.WRONG_PART,
    Phase.EMPTY: GripperMode.NO_PART,
    Phase.LOST: GripperMode.PART_LOST,
    Phase.STOPPED: GripperMode.STOPPED,
    Phase.HOMING_OUT: GripperMode.HOMING,
    Phase.HOMING_IN: GripperMode.HOMING,
    Phase.FAULT: GripperMode.FAULT,
}


class DirectGripper(Gripper):
    """Moves the world's fingers; knows their encoder and motor current only."""

    def __init__(self, world: World, *, name: str = "gripper") -> None:
        self.name = name
        self._world = world
        self._link = DirectLink(world, name, Identity("binpick", "stepper gripper", "simulated"))
        self._callbacks: list[Callable[[GripperEvent], None]] = []
        self._watch: asyncio.Task[None] | None = None

    @property
    def limits(self) -> GripperLimits:
        return self._axis.limits

    @property
    def capabilities(self) -> frozenset[GripperCapability]:
        return frozenset(GripperCapability)

    @property
    def is_open(self) -> bool:
        return self._link.is_open

    async def open(self) -> None:
        if self.is_open:
            return
        self._link.open()
        self._stop_watching()
        self._watch = asyncio.get_running_loop().create_task(
            self._watch_events(), name=f"{self.name} events"
        )

    async def close(self) -> None:
        if self._link.is_open and self._axis.is_busy:
            await self.stop()
        self._stop_watching()
        self._link.close()

    async def identity(self) -> Identity:
        self._link.check()
        return self._link.identity

    async def state(self) -> GripperState:
        self._link.check()
        axis = self._axis
        return GripperState(
            stamp_s=self._link.stamp_s,
            mode=MODES[axis.phase],
            is_homed=axis.is_homed,
            width_m=axis.width_m,
            force_n=axis.force_n,
            size_m=axis.size_m,
            fault=axis.fault,
        )

    def home(self, *, force_if_holding: bool = False) -> Motion[HomeResult]:
        return Motion(self._home(force_if_holding), name=f"{self.name} home")

    def move_to(
        self, width_m: float, *, speed_mps: float | None = None, force_n: float | None = None
    ) -> Motion[MoveResult]:
        self.limits.check(width_m=width_m, force_n=force_n, speed_mps=speed_mps)
        return Motion(self._move_to(width_m, speed_mps, force_n), name=f"{self.name} move_to")

    def grasp(
        self,
        *,
        expected_m: float | None = None,
        inner_tolerance_m: float = 5e-4,
        outer_tolerance_m: float = 5e-4,
        speed_mps: float | None = None,
        force_n: float | None = None,
    ) -> Motion[GraspResult]:
        self.limits.check(width_m=expected_m, force_n=force_n, speed_mps=speed_mps)
        if not (inner_tolerance_m >= 0 and outer_tolerance_m >= 0):
            raise ValueError(f"tolerances {inner_tolerance_m:g}, {outer_tolerance_m:g} m")
        window = None
        if expected_m is not None:
            window = Window(expected_m - inner_tolerance_m, expected_m + outer_tolerance_m)
        return Motion(self._grasp(window, speed_mps, force_n), name=f"{self.name} grasp")

    def release(self, *, width_m: float | None = None) -> Motion[MoveResult]:
        self.limits.check(width_m=width_m)
        wanted = self.limits.stroke_m if width_m is None else width_m
        return Motion(self._move_to(wanted, None, None), name=f"{self.name} release")

    def stop(self) -> Motion[None]:
        return Motion(self._stop(), name=f"{self.name} stop")

    def clear_fault(self) -> Motion[None]:
        return Motion(self._clear_fault(), name=f"{self.name} clear_fault")

    def on_event(self, callback: Callable[[GripperEvent], None]) -> Callable[[], None]:
        self._callbacks.append(callback)

        def end() -> None:
            if callback in self._callbacks:
                self._callbacks.remove(callback)

        return end

    @property
    def _axis(self) -> FingerAxis:
        return self._world.fingers

    def _check_ready(self) -> None:
        self._link.check()
        axis = self._axis
        if axis.phase is Phase.FAULT:
            raise FaultError(axis.fault, device=self.name, state=axis.phase)
        if not axis.is_homed:
            raise RejectedError("home the gripper first", device=self.name, code="not homed")

    async def _home(self, force_if_holding: bool) -> HomeResult:
        self._link.check()
        if self._axis.is_holding and not force_if_holding:
            raise RejectedError(
                "homing would drop the part that is held", device=self.name, code="holding"
            )
        self._axis.home()
        await self._finished()
        if self._axis.phase is Phase.FAULT:
            raise FaultError(self._axis.fault, device=self.name, state=self._axis.phase)
        stroke_m, correction_m = self._axis.homing
        return HomeResult(stroke_m, correction_m)

    async def _move_to(
        self, width_m: float, speed_mps: float | None, force_n: float | None
    ) -> MoveResult:
        self._check_ready()
        self._axis.move(width_m, **self._with_defaults(speed_mps, force_n))
        await self._finished()
        return MoveResult(self._axis.width_m, self._axis.is_blocked)

    async def _grasp(
        self, window: Window | None, speed_mps: float | None, force_n: float | None
    ) -> GraspResult:
        self._check_ready()
        self._axis.close(window=window, **self._with_defaults(speed_mps, force_n))
        await self._finished()
        axis = self._axis
        outcome = {
            Phase.EMPTY: GraspOutcome.NO_PART,
            Phase.WRONG: GraspOutcome.WRONG_PART,
        }.get(axis.phase, GraspOutcome.HELD)
        return GraspResult(outcome, axis.size_m, axis.force_n)

    def _with_defaults(self, speed_mps: float | None, force_n: float | None) -> dict[str, float]:
        return {
            "speed_mps": self.limits.max_speed_mps if speed_mps is None else speed_mps,
            "force_n": 80.0 if force_n is None else force_n,
        }

    async def _finished(self) -> None:
        """Wait for the command just given; a newer one takes its place."""
        axis, mine = self._axis, self._axis.command
        try:
            await self._link.wait(lambda: axis.command != mine or not axis.is_busy)
        except asyncio.CancelledError:
            if axis.command == mine:
                axis.halt()
            raise
        if axis.command != mine:
            raise PreemptedError("a newer command came", device=self.name)

    async def _stop(self) -> None:
        self._link.check()
        self._axis.halt()
        # The set-point stands at once, the fingers a moment later.
        await asyncio.sleep(0.010)

    async def _clear_fault(self) -> None:
        self._link.check()
        self._axis.clear_fault()

    async def _watch_events(self) -> None:
        """Tell of losses as they happen, until the link is gone."""
        while True:
            before = self._axis.phase
            await self._world.until(partial(self._has_changed, before))
            if not self._link.is_open:
                self._tell(GripperEvent.LINK_LOST)
                return
            if self._axis.phase is Phase.LOST:
                self._tell(GripperEvent.PART_LOST)
            elif self._axis.phase is Phase.FAULT:
                self._tell(GripperEvent.FAULT)

    def _has_changed(self, before: Phase) -> bool:
        return not self._link.is_open or self._axis.phase is not before

    def _stop_watching(self) -> None:
        if self._watch is not None:
            self._watch.cancel()
            self._watch = None

    def _tell(self, event: GripperEvent) -> None:
        for callback in list(self._callbacks):
            callback(event)
