"""Runs one foreign program on a simulated controller and returns what could be seen of it.

A scene is a TOML file beside the program: what is loaded, what a test's hands do meanwhile,
and what must be true afterwards. Expectations come from the language, not from a run.
"""

import asyncio
import tomllib
from collections.abc import Coroutine
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sims.controller import Controller, Setup, TaskSetup, arm_of, cell_signals, modules_of
from sims.controller.backup import SignalConfig, read_backup
from sims.loop import LockstepLoop
from sims.rapid.builtin import TaskKind
from sims.rapid.host import SignalKind
from sims.rapid.network import MemoryNetwork
from sims.world import World

PROGRAMS = Path(__file__).parent / "programs"
ROBOT = "192.168.125.1"
PEER = "192.168.125.50"


@dataclass(frozen=True, slots=True)
class Scene:
    """A program and what is to be done with it."""

    path: Path
    table: dict[str, Any]

    @property
    def name(self) -> str:
        return self.path.stem


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a run left behind."""

    lines: list[str]
    data: dict[str, Any]
    outputs: dict[str, float]
    files: dict[str, str]
    joints_deg: list[float]
    tool0_mm: list[float]
    duration_s: float
    has_failed: bool
    numbers: list[int]
    entries: str


def scenes() -> list[Scene]:
    """Return all scenes, by name."""
    return [
        Scene(path, tomllib.loads(path.read_text())) for path in sorted(PROGRAMS.glob("*.toml"))
    ]


def tool0_mm(joints_rad: np.ndarray) -> np.ndarray:
    """Where the flange of an IRB 1200-5/0.9 is, from its data sheet."""
    about = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}
    links = [(0, 0, 399.1), (0, 0, 0), (0, 0, 448), (0, 0, 42), (451, 0, 0), (0, 0, 0)]
    turned, place = np.eye(3), np.zeros(3)
    for axis, link, angle in zip("zyyxyx", links, joints_rad, strict=True):
        place = place + turned @ np.array(link)
        one, other = about[axis]
        spin = np.eye(3)
        spin[one, one] = spin[other, other] = np.cos(angle)
        spin[other, one] = np.sin(angle)
        spin[one, other] = -np.sin(angle)
        turned = turned @ spin
    return place + turned @ np.array([82.0, 0, 0])


def as_bytes(text: str) -> bytes:
    """``hex:`` before hex digits, otherwise Latin-1."""
    return bytes.fromhex(text[4:]) if text.startswith("hex:") else text.encode("latin-1")


async def _read(stream: Any, count: int) -> bytes:
    heard = b""
    while len(heard) < count:
        piece = await stream.receive(count - len(heard))
        if not piece:
            break
        heard += piece
    return heard


async def _converse(stream: Any, exchange: list[list[str]]) -> None:
    """Each step is ``[verb, text]``: send, expect, wait (seconds), closed, close."""
    for verb, text in exchange:
        if verb == "send":
            await stream.send(as_bytes(text))
        elif verb == "expect":
            wanted = as_bytes(text)
            heard = await _read(stream, len(wanted))
            assert heard == wanted, f"heard {heard!r} where {wanted!r} was due"
        elif verb == "wait":
            await asyncio.sleep(float(text))
        elif verb == "closed":
            assert await stream.receive(1) == b""
        else:
            assert verb == "close"
            stream.close()


class Hands:
    """What a test does to the controller while the program runs."""

    def __init__(self, controller: Controller, network: MemoryNetwork) -> None:
        self._controller = controller
        self._network = network

    async def _moment(self, step: dict[str, Any]) -> None:
        line = step.get("after_line")
        while line is not None and line not in self._controller.pendant.lines:
            await asyncio.sleep(0.01)
        await asyncio.sleep(step.get("at_s", 0.0))

    async def inputs(self, steps: list[dict[str, Any]]) -> None:
        async def one(step: dict[str, Any]) -> None:
            await self._moment(step)
            self._controller.set_input(step["name"], step["value"])

        await asyncio.gather(*(one(step) for step in steps))

    async def clients(self, steps: list[dict[str, Any]]) -> None:
        """One after the other."""
        for step in steps:
            await self._moment(step)
            while True:
                try:
                    stream = await self._network.connect(ROBOT, step["port"], peer=PEER)
                    break
                except ConnectionRefusedError:
                    await asyncio.sleep(0.05)
            await _converse(stream, step["exchange"])
            stream.close()

    async def server(self, step: dict[str, Any]) -> None:
        listener = await self._network.at(PEER).listen(PEER, step["port"])
        for exchange in step["sessions"]:
            stream = await listener.accept()
            await _converse(stream, exchange)
            stream.close()
        listener.close()

    async def keys(self, answers: list[float]) -> None:
        for answer in answers:
            while self._controller.pendant.question is None:
                await asyncio.sleep(0.01)
            await asyncio.sleep(0.2)
            self._controller.pendant.answer(answer)
            await asyncio.sleep(0.05)

    def all(self, table: dict[str, Any]) -> list[Coroutine[Any, Any, None]]:
        return [
            self.inputs(table.get("inputs", [])),
            self.clients(table.get("clients", [])),
            self.keys(table.get("keys", [])),
            *(self.server(step) for step in table.get("servers", [])),
        ]


def _setup(scene: Scene, home: Path) -> Setup:
    table = scene.table
    for name, text in table.get("home", {}).items():
        (home / name).write_bytes(as_bytes(text))
    if "backup" in table:
        backup = read_backup(PROGRAMS / table["backup"])
        return Setup.from_backup(backup, arm_of(backup)).changed(home=home)
    default = [{"name": "T_ROB1", "modules": [f"{scene.name}.mod"]}]
    tasks = [
        TaskSetup(
            task["name"],
            modules_of([PROGRAMS / module for module in task["modules"]]),
            TaskKind[task.get("kind", "NORMAL")],
            task.get("motion", True),
            task.get("entry", "main"),
        )
        for task in table.get("tasks", default)
    ]
    groups = [
        SignalConfig(name=group["name"], kind=SignalKind[group["kind"]], bits=group["bits"])
        for group in table.get("groups", [])
    ]
    return Setup(tasks=tasks, signals=(*cell_signals(), *groups), home=home)


def _found(controller: Controller, path: str) -> Any:
    """``TASK.name``, and the places of components after it: ``T_ROB1.target.0`` is ``trans``."""
    task, name, *places = path.split(".")
    value = controller.system.find(task, name).get()
    for place in places:
        value = value[int(place)]
    return value


async def _play(world: World, scene: Scene, home: Path) -> Outcome:
    network = MemoryNetwork(ROBOT)
    controller = Controller(world, _setup(scene, home), network)
    table = scene.table
    clock = asyncio.get_running_loop()
    async with controller:
        hands = Hands(controller, network)
        await controller.start()
        begun_s = clock.time()
        async with asyncio.timeout(table.get("limit_s", 60.0)):
            busy = asyncio.gather(*hands.all(table))
            ended = asyncio.ensure_future(world.until(lambda: not controller.is_running))
            await asyncio.wait({busy, ended}, return_when=asyncio.FIRST_COMPLETED)
            if busy.done() and not ended.done():
                busy.result()
            await ended
            duration_s = clock.time() - begun_s
            with suppress(TimeoutError):
                await asyncio.wait_for(busy, 2.0)
        names = {**table.get("data", {}), **table.get("near", {})}
        return Outcome(
            lines=list(controller.pendant.lines),
            data={path: _found(controller, path) for path in names},
            outputs={name: controller.signals[name].value for name in table.get("outputs", {})},
            files={
                str(path.relative_to(home)): path.read_bytes().decode("latin-1")
                for path in sorted(home.rglob("*"))
                if path.is_file()
            },
            joints_deg=[float(joint) for joint in np.degrees(world.arm.measured_rad)],
            tool0_mm=[float(part) for part in tool0_mm(world.arm.measured_rad)],
            duration_s=duration_s,
            has_failed=controller.has_failed,
            numbers=controller.log.numbers(),
            entries="\n".join(f"{e.number} {e.title} {e.cause}" for e in controller.log),
        )


def run(scene: Scene, home: Path) -> Outcome:
    """Run a scene to its end, in virtual time."""
    backup = scene.table.get("backup")
    world = World(arm=arm_of(read_backup(PROGRAMS / backup))) if backup else World()
    loop = LockstepLoop(world)
    try:
        return loop.run_until_complete(_play(world, scene, home))
    finally:
        loop.close()


def _is_near(value: Any, wanted: Any, tolerance: float) -> bool:
    if isinstance(wanted, list):
        return (
            isinstance(value, list | tuple)
            and len(value) == len(wanted)
            and all(
                _is_near(one, other, tolerance) for one, other in zip(value, wanted, strict=True)
            )
        )
    if isinstance(wanted, bool | str):
        return bool(value == wanted)
    return abs(value - wanted) <= tolerance


class _Verdict:
    """Collects what is not as it should be."""

    def __init__(self) -> None:
        self.wrong: list[str] = []

    def check(self, what: str, value: Any, wanted: Any, tolerance: float = 0.0) -> None:
        if not _is_near(value, wanted, tolerance):
            self.wrong.append(f"{what}: {value!r} where {wanted!r} was due (within {tolerance})")

    def check_near(self, path: str, value: Any, near: dict[str, Any]) -> None:
        wanted, within = near["value"], near["within"]
        if near.get("either_sign") and _is_near(value, [-part for part in wanted], within):
            return
        self.check(path, value, wanted, within)

    def check_lines(self, table: dict[str, Any], lines: list[str]) -> None:
        if "lines" in table:
            self.check("pendant", lines, table["lines"])
        rest = iter(lines)
        among = table.get("lines_among", [])
        self.wrong += [f"no line {line!r}" for line in among if line not in rest]

    def check_files(self, table: dict[str, str], files: dict[str, str]) -> None:
        self.check("files", sorted(files), sorted(table))
        for name, wanted in table.items():
            self.check(name, files.get(name), wanted)


def complaints(scene: Scene, seen: Outcome) -> list[str]:
    """Return everything that is not as the scene says."""
    table = scene.table
    verdict = _Verdict()
    verdict.check("stopped with an error", seen.has_failed, table.get("ends") == "error")
    verdict.check_lines(table, seen.lines)
    for path, wanted in table.get("data", {}).items():
        verdict.check(path, seen.data[path], wanted)
    for path, near in table.get("near", {}).items():
        verdict.check_near(path, seen.data[path], near)
    for name, wanted in table.get("outputs", {}).items():
        verdict.check(name, seen.outputs[name], wanted)
    if "files" in table:
        verdict.check_files(table["files"], seen.files)
    if "joints_deg" in table:
        verdict.check("joints", seen.joints_deg, table["joints_deg"], 0.05)
    if "tool0_mm" in table:
        verdict.check("tool0", seen.tool0_mm, table["tool0_mm"], 0.5)
    missing = sorted(set(table.get("numbers", [])) - set(seen.numbers))
    verdict.check("events that are missing", missing, [])
    low, high = table.get("duration_s", (0.0, table.get("limit_s", 60.0)))
    verdict.check("duration", seen.duration_s, (low + high) / 2, (high - low) / 2)
    if verdict.wrong:
        verdict.wrong += ["event log:", seen.entries, "pendant:", *seen.lines]
    return verdict.wrong
