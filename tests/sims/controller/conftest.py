"""A controller in lock-step, and RAPID to run on it."""

import asyncio
from collections.abc import Callable

import numpy as np
import pytest

from drivers.arms import Kinematics
from sims.controller import Controller, Setup, TaskSetup, cell_signals
from sims.loop import LockstepLoop
from sims.rapid.builtin import TaskKind
from sims.rapid.network import MemoryNetwork
from sims.rapid.parser import parse_text
from sims.world import World

HEAD = r"""
  PERS tooldata tTool := [TRUE, [[0, 0, 160], [1, 0, 0, 0]],
    [1, [0, 0, 50], [1, 0, 0, 0], 0, 0, 0]];
  CONST extjoint NONE := [9E9, 9E9, 9E9, 9E9, 9E9, 9E9];
  CONST jointtarget HOME := [[0, 0, 0, 0, 90, 0], NONE];
  VAR robtarget p0;
  PERS num phase := 0;
  PERS num errno_seen := 0;
"""


class Bench:
    """One controller on one world; ``task`` is the motion task, ``back`` one in the background."""

    def __init__(self, module, background="", **changes):
        self.world = World()
        tasks = [TaskSetup("T_ROB1", self._modules("Main", HEAD + module))]
        if background:
            modules = self._modules("Back", background)
            tasks.append(TaskSetup("T_BACK", modules, TaskKind.STATIC, has_motion=False))
        setup = Setup(tasks=tasks, signals=cell_signals()).changed(**changes)
        self.controller = Controller(self.world, setup, MemoryNetwork())
        self.kinematics = Kinematics(self.world.arm_model)
        self.tool = np.eye(4)
        self.tool[2, 3] = 0.16
        self.path = []
        self.loop = LockstepLoop(self.world)

    @staticmethod
    def _modules(name, text):
        modules, wrong = parse_text(f"MODULE {name}\n{text}\nENDMODULE\n", f"{name}.mod")
        assert not wrong, [str(d) for d in wrong]
        return modules

    def run(self, play: Callable, *, limit_s=60.0):
        """Run ``play(bench)`` with the controller on."""

        async def main():
            async with self.controller, asyncio.timeout(limit_s):
                return await play(self)

        return self.loop.run_until_complete(main())

    async def start(self):
        await self.controller.start()

    async def until(self, condition, limit_s=30.0):
        async with asyncio.timeout(limit_s):
            await self.world.until(condition)

    async def ended(self, limit_s=30.0):
        """Until the program has stopped by itself."""
        await self.until(lambda: not self.controller.is_running, limit_s)

    def value(self, name, task="T_ROB1"):
        return self.controller.system.find(task, name).get()

    def record(self):
        """Note the joints at every tick from now on."""

        def note():
            self.path.append(self.world.arm.measured_rad)
            return False

        self.world.until(note)

    @property
    def places(self):
        """Where the tool was, shape (n, 3)."""
        return (self.kinematics.forward(np.array(self.path)) @ self.tool)[:, :3, 3]

    @property
    def place(self):
        """Where the tool is."""
        return (self.kinematics.forward(self.world.arm.measured_rad) @ self.tool)[:3, 3]

    @property
    def numbers(self):
        return self.controller.log.numbers()

    @property
    def speed(self):
        return float(np.abs(self.world.arm.velocity_radps).max())


@pytest.fixture
def bench():
    """``Bench``, whose loops are closed in the end."""
    made = []

    def make(*args, **changes):
        made.append(Bench(*args, **changes))
        return made[-1]

    yield make
    for one in made:
        one.loop.close()
