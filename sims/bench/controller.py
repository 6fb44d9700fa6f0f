"""``abb.path_error`` and its kin: how exactly the simulated controller drives, and how it stops."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from drivers.arms import Kinematics
from hal import Figure
from sims.controller import Controller, Setup, TaskSetup
from sims.loop import LockstepLoop
from sims.rapid.network import MemoryNetwork
from sims.rapid.parser import parse_text
from sims.world import World

__all__ = ["run"]

Array = NDArray[np.float64]

SPEEDS_MMPS = (100, 500, 1000, 1500)
ZONES_MM = (1, 10, 50)
STOP_SPEEDS_MMPS = (100, 250, 500, 1000, 1500)
TOOL_M = 0.16
WAY_MM = 700
LONGEST_S = 60.0

PROGRAM = """
MODULE Bench
  PERS tooldata tBench := [TRUE, [[0, 0, 160], [1, 0, 0, 0]],
    [1, [0, 0, 50], [1, 0, 0, 0], 0, 0, 0]];
  CONST extjoint NONE := [9E9, 9E9, 9E9, 9E9, 9E9, 9E9];
  CONST robtarget START := [[450, -350, 500], [0, 0, 1, 0], [0, 0, 0, 0], NONE];
  PERS num phase := 0;
  PROC main()
    ConfJ \\Off;
    ConfL \\Off;
    MoveJ START, v1000, fine, tBench;
    phase := 1;
    %s
    phase := 2;
    EXIT;
  ENDPROC
ENDMODULE
"""
START_M = np.array([0.450, -0.350, 0.500])


def run(*, seeds: Sequence[int] = (0,)) -> list[Figure]:
    """Lines at several speeds, corners in several zones, full-speed joint moves, stops.

    Everything is virtual time and repeats to the bit; ``seeds`` choose the joint moves.
    """
    return [
        *(_path_error(speed) for speed in SPEEDS_MMPS),
        *(_corner_error(zone) for zone in ZONES_MM),
        _tracking_peak(seeds),
        *(_stop_distance(speed) for speed in STOP_SPEEDS_MMPS),
    ]


class _Bench:
    def __init__(self, moves: str) -> None:
        modules, wrong = parse_text(PROGRAM % moves, "Bench.mod")
        assert not wrong
        self.world = World()
        self.controller = Controller(
            self.world, Setup(tasks=[TaskSetup("T_ROB1", modules)]), MemoryNetwork()
        )
        self.measured: list[Array] = []
        self.wanted: list[Array] = []

    def places(self, joints: Sequence[Array]) -> Array:
        kinematics = Kinematics(self.world.arm_model)
        T = kinematics.forward(np.array(joints))
        return np.asarray(T[:, :3, 3] + TOOL_M * T[:, :3, 2])

    def phase(self) -> float:
        found = self.controller.system.find("T_ROB1", "phase")
        return 0.0 if found is None else float(found.get())

    def note(self) -> bool:
        if self.phase() >= 1:
            self.measured.append(self.world.arm.measured_rad)
            self.wanted.append(np.array(self.world.arm.target_rad))
        return False

    def play(self, act: Callable[["_Bench"], Awaitable[None]] | None = None) -> None:
        loop = LockstepLoop(self.world)

        async def main() -> None:
            async with self.controller, asyncio.timeout(LONGEST_S):
                await self.controller.start()
                self.world.until(self.note)
                if act is not None:
                    await act(self)
                else:
                    await self.world.until(lambda: not self.controller.is_running)

        try:
            loop.run_until_complete(main())
        finally:
            loop.close()


def _speed(mmps: int) -> str:
    return f"[{mmps}, 500, 5000, 1000]"


def _off_line(places: Array, a: Array, b: Array) -> Array:
    along = (b - a) / np.linalg.norm(b - a)
    away = places - a
    return np.asarray(np.linalg.norm(away - (away @ along)[:, None] * along, axis=1))


def _path_error(speed: int) -> Figure:
    bench = _Bench(f"MoveL Offs(START, 0, {WAY_MM}, 0), {_speed(speed)}, fine, tBench;")
    bench.play()
    goal = START_M + (0, WAY_MM / 1e3, 0)
    away = _off_line(bench.places(bench.measured), START_M, goal)
    return Figure(f"abb.path_error_{speed}mmps", float(away.max()), "m", len(away))


def _corner_error(zone: int) -> Figure:
    """The largest distance from both lines, of what lies outside the zone."""
    bench = _Bench(
        f"MoveL Offs(START, 0, {WAY_MM}, 0), {_speed(500)}, z0 \\Z:={zone}, tBench;"
        f"MoveL Offs(START, 0, {WAY_MM}, 200), {_speed(500)}, fine, tBench;"
    )
    bench.play()
    places = bench.places(bench.measured)
    corner = START_M + (0, WAY_MM / 1e3, 0)
    outside = places[np.linalg.norm(places - corner, axis=1) > zone / 1e3]
    goal = corner + (0, 0, 0.2)
    away = np.minimum(_off_line(outside, START_M, corner), _off_line(outside, corner, goal))
    return Figure(f"abb.path_error_outside_z{zone}", float(away.max()), "m", len(away))


def _tracking_peak(seeds: Sequence[int]) -> Figure:
    """The largest distance of the tool from its set-point, in full-speed joint moves."""
    peaks = []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        low, high = (-90, -30, -60, -150, -100, -300), (90, 20, 10, 150, 100, 300)
        rows = [", ".join(f"{q:.3f}" for q in rng.uniform(low, high)) for _ in range(6)]
        moves = "".join(f"MoveAbsJ [[{row}], NONE], v5000, z100, tBench;" for row in rows)
        bench = _Bench(moves + "MoveJ START, v5000, fine, tBench;")
        bench.play()
        away = bench.places(bench.measured) - bench.places(bench.wanted)
        peaks.append(float(np.linalg.norm(away, axis=1).max()))
    return Figure("abb.tracking_peak", max(peaks), "m", len(peaks), min(peaks), max(peaks))


def _stop_distance(speed: int) -> Figure:
    """From the order to stop, given at full speed, to standstill."""
    bench = _Bench(f"MoveL Offs(START, 0, {WAY_MM}, 0), {_speed(speed)}, fine, tBench;")
    places: list[float] = []

    async def act(bench: _Bench) -> None:
        world = bench.world
        await world.until(lambda: bench.phase() >= 1 and _at(bench) > 0.0)
        places.append(_at(bench))
        await bench.controller.stop()
        await world.until(lambda: bench.controller.unit.is_standing)
        places.append(_at(bench))

    bench.play(act)
    return Figure(f"abb.stop_distance_{speed}mmps", places[1] - places[0], "m")


def _at(bench: _Bench) -> float:
    return float(bench.places([bench.world.arm.measured_rad])[0, 1])
