"""The line: devices, planning and memory of one cell, handed from step to step."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cell.attempt import Attempt
from cell.config import CellConfig
from cell.journal import Journal
from cell.planning.collision import Obstacle
from cell.planning.pick import PickPlan, PickPlanner
from cell.scene import Eyes
from cell.slots import NextSlot, Slots
from cell.walltime import WallTimes
from drivers.arms import ArmModel
from hal import Gripper, Robot, Transform
from perception.parts import Part

__all__ = ["Line", "Memory"]

SAME_PLACE_M = 0.015


@dataclass
class Memory:
    """What was tried in vain, so that it is not tried for ever."""

    misses: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    consecutive_misses: int = 0

    def remember(self, plan: PickPlan) -> None:
        """Note a miss: where the part was thought to be, where the tool went."""
        self.misses.append((plan.T_base_object.translation_m, plan.T_base_tcp.matrix))
        self.consecutive_misses += 1

    def tries_at(self, T_base_object: Transform) -> int:
        """How often a part about here was missed."""
        return sum(
            float(np.linalg.norm(where - T_base_object.translation_m)) < SAME_PLACE_M
            for where, _ in self.misses
        )

    def forget(self) -> None:
        """Note a success: the pile has changed."""
        self.consecutive_misses = 0


@dataclass(eq=False)
class Line:
    """All that the cycle needs; made by ``cell.build``.

    ``exchange_tray`` has somebody put an empty tray in place of a full one; without it a full
    tray ends the run.
    """

    config: CellConfig
    part: Part
    arm: ArmModel
    robot: Robot
    gripper: Gripper
    eyes: Eyes
    planner: PickPlanner
    slots: Slots
    journal: Journal
    obstacles: tuple[Obstacle, ...] = ()
    seed: int = 0
    slots_used: int = 0
    laid_down: list[Transform] = field(default_factory=list)
    attempts: list[Attempt] = field(default_factory=list)
    exchange_tray: Callable[[], Awaitable[None]] | None = None
    memory: Memory = field(default_factory=Memory)
    wall: WallTimes = field(default_factory=WallTimes)
    listeners: list[Callable[[str, dict[str, Any]], None]] = field(default_factory=list)

    def note(self, event: str, **fields: Any) -> None:
        """Write to the journal and tell whoever listens (progress bar, referee)."""
        t_ns = round(asyncio.get_running_loop().time() * 1e9)
        self.journal.write(event, t_ns, **fields)
        for listener in self.listeners:
            listener(event, fields)

    @asynccontextmanager
    async def phase(self, name: str, **fields: Any) -> AsyncIterator[None]:
        """Journal when a phase began and ended, and where the arm stood then."""
        loop = asyncio.get_running_loop()
        start_s = loop.time()
        yield
        state = await self.robot.state()
        self.note(
            "phase",
            name=name,
            start_s=start_s,
            end_s=loop.time(),
            joints_rad=np.round(state.joints_rad, 7),
            **fields,
        )

    def next_slot(self) -> NextSlot | None:
        """Return the slot after those in use, ``None`` when the tray is full."""
        if self.slots_used >= len(self.slots):
            return None
        position_m = self.slots.positions_m[self.slots_used]
        return NextSlot(self.slots_used, position_m, self.part, self.config.layout.tray)
