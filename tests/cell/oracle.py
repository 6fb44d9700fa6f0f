"""A cycle whose eyes know the truth: the arm's half of the line, tested without images."""

import asyncio

import numpy as np

from cell.build import Devices, build_line
from cell.config import CellConfig, load_cell
from cell.cycle import empty_the_bin
from cell.demo.score import Score
from cell.journal import Journal
from cell.line import Line
from cell.scene import Scene
from hal import Tool, Transform, rotation_from_rotvec
from perception.parts import Part, load_part
from sims.direct import DirectGripper, DirectRobot
from sims.loop import LockstepLoop
from sims.world import World, cylinders
from sims.world.piles import fill


class OracleEyes:
    """Says where parts truly are, with noise to order."""

    def __init__(
        self, world: World, *, noise_m: float = 0.0, noise_rad: float = 0.0, seed: int = 0
    ):
        self.world = world
        self.noise_m, self.noise_rad = noise_m, noise_rad
        self.rng = np.random.default_rng(seed)
        self.looks = 0

    async def look(self) -> Scene:
        await asyncio.sleep(1.0)
        box = self.world.layout.bin
        half = np.array(box.size_m[:2]) / 2
        inside = []
        for k in range(self.world.parts):
            T = self.world.part_pose(k)
            x, y, z = box.T_base_bin.inverse().apply(T.translation_m)
            if abs(x) < half[0] and abs(y) < half[1] and z > -0.01:
                turn = rotation_from_rotvec(self.rng.normal(size=3) * self.noise_rad)
                shift = self.rng.normal(size=3) * self.noise_m
                inside.append(
                    Transform.from_parts(
                        "base", "object", turn @ T.rotation, T.translation_m + shift
                    )
                )
        self.looks += 1
        return Scene(
            self.looks, tuple(inside), (1.0,) * len(inside), np.zeros((0, 3)), is_empty=not inside
        )


class Run:
    """One bin, emptied with the oracle's eyes."""

    def __init__(
        self,
        part: str | Part = "shaft",
        *,
        count: int,
        seed: int,
        config: CellConfig | None = None,
        has_operator: bool = False,
        **eyes,
    ):
        self.part = load_part(part) if isinstance(part, str) else part
        self.config = config or load_cell()
        profile = self.part.profile
        shape = cylinders(profile.z_edges_m, profile.radii_m, self.part.density_kgpm3)
        self.world = World(shape=shape, parts=count, layout=self.config.layout)
        self.pile = fill(self.world, seed=seed)
        self.seed = seed
        self.has_operator = has_operator
        self.eyes = OracleEyes(self.world, seed=seed, **eyes)
        self.journal = Journal()
        self.line: Line | None = None
        self.score: Score | None = None
        self.outcome = None
        self.extra_listeners = []
        self.on_load = None

    def go(self) -> "Run":
        loop = LockstepLoop(self.world)
        asyncio.set_event_loop(loop)
        try:
            loop.run_until_complete(self._empty())
        finally:
            asyncio.set_event_loop(None)
            loop.close()
        return self

    async def _empty(self) -> None:
        devices = Devices(DirectRobot(self.world), DirectGripper(self.world), None, None)
        self.line = build_line(
            self.config, self.part, devices, self.eyes, self.journal, seed=self.seed
        )
        self.score = Score(self.world, self.part, self.line)
        self.line.listeners.append(self.score)
        self.line.listeners += self.extra_listeners
        if self.on_load is not None:
            tell = devices.robot.set_load
            devices.robot.set_load = lambda load: (self.on_load(load), tell(load))[1]
        if self.has_operator:
            self.line.exchange_tray = self.score.exchange_tray
        async with devices.robot, devices.gripper:
            tcp_m = (0, 0, self.config.fingers.tcp_m)
            await devices.robot.set_tool(Tool(Transform.from_translation("flange", "tcp", tcp_m)))
            self.outcome = await empty_the_bin(self.line)
            await asyncio.sleep(0.5)
        self.score.judge_tray()
