"""A simulated ABB controller on this machine's network, in wall time, until it is told to end."""

import asyncio
import shutil
import signal
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol

from drivers.arms import ARMS, ArmModel
from hal.errors import CellError, ConfigError
from sims.controller import Controller, Entry, Setup, arm_of, package_setup
from sims.controller.backup import read_backup
from sims.controller.operator import Operator, describe
from sims.loop import PacedLoop
from sims.rapid.network import TcpNetwork
from sims.world import World

__all__ = ["AbbOptions", "View", "run_abb"]

VIEW_PERIOD_S = 0.1
LOOPBACK = "127."


@dataclass(frozen=True)
class AbbOptions:
    """What to run and how; without ``backup`` and ``modules``: our own package.

    ``ports`` map a program's port to this machine's, 0 choosing a free one.
    """

    backup: Path | None = None
    modules: Sequence[Path] = ()
    overrides: Mapping[str, str] = field(default_factory=dict)
    arm: str | None = None
    bind: str = "127.0.0.1"
    ports: Mapping[int, int] = field(default_factory=dict)
    home: Path | None = None
    starts: bool = True
    commands: Sequence[str] = ()
    duration_s: float | None = None


class View(Protocol):
    """What the user sees and types."""

    def begin(self, controller: Controller, typed: "asyncio.Queue[str]") -> None:
        """The controller is on; typed lines go into the queue, ``quit`` ends."""

    def entry(self, entry: Entry) -> None:
        """A line of the event log."""

    def line(self, text: str) -> None:
        """A line on the pendant, or an answer to a command."""

    def refresh(self) -> None:
        """Some time has passed."""

    def end(self) -> None:
        """Give the terminal back."""


def run_abb(options: AbbOptions, view: View) -> dict[str, Any]:
    """Run until ``quit``, Ctrl-C or the end of ``duration_s``; return the last state.

    Raises
    ------
    CellError
        The configuration or the programs were refused.
    """
    setup, arm = _setup(options)
    world = World(arm=arm)
    loop = PacedLoop(world)
    with TemporaryDirectory(prefix="binpick-home-") as folder:
        if options.home is None and options.backup is not None:
            setup = setup.changed(home=_disk(options.backup, Path(folder)))
        try:
            return loop.run_until_complete(_run(options, setup, world, view))
        finally:
            loop.close()


def _disk(backup: Path, folder: Path) -> Path:
    """A copy of the backup's HOME: programs may write there, a backup stays as it is."""
    home = read_backup(backup).home
    if home is not None:
        shutil.copytree(home, folder, dirs_exist_ok=True)
    return folder


def _setup(options: AbbOptions) -> tuple[Setup, ArmModel]:
    if options.arm is not None and options.arm not in ARMS:
        raise ConfigError(f"{options.arm!r} is unknown; there are {', '.join(ARMS)}", key="--arm")
    arm = ARMS[options.arm or next(iter(ARMS))]
    overrides = dict(options.overrides)
    if options.backup is not None:
        backup = read_backup(options.backup)
        arm = arm if options.arm else arm_of(backup)
        setup = Setup.from_backup(backup, arm)
    elif options.modules:
        setup = Setup.from_files(options.modules)
    else:
        if options.bind.startswith(LOOPBACK) and not _names(overrides, "bp_peers"):
            overrides["BP_PEERS"] = f'["{LOOPBACK}", "", "", ""]'
        setup = package_setup()
    home = {} if options.home is None else {"home": options.home}
    return setup.changed(arm=arm, overrides=overrides, **home), arm


def _names(overrides: Mapping[str, str], name: str) -> bool:
    return any(key.lower().rpartition(":")[2] == name for key in overrides)


async def _run(options: AbbOptions, setup: Setup, world: World, view: View) -> dict[str, Any]:
    network = TcpNetwork(options.bind, options.ports)
    controller = Controller(world, setup, network)
    controller.log.watch(view.entry)
    controller.pendant.shown = view.line
    typed: asyncio.Queue[str] = asyncio.Queue(maxsize=100)
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, _quit, typed)
    try:
        async with controller:
            view.begin(controller, typed)
            showing = asyncio.ensure_future(_show(view, network))
            try:
                async with asyncio.timeout(options.duration_s):
                    await _operate(options, controller, typed, view)
            except TimeoutError:
                pass
            finally:
                showing.cancel()
            state = describe(controller)
            return {**state, "ports": {str(k): v for k, v in network.chosen.items()}}
    finally:
        view.end()
        for number in (signal.SIGINT, signal.SIGTERM):
            loop.remove_signal_handler(number)


def _quit(typed: "asyncio.Queue[str]") -> None:
    while not typed.empty():
        typed.get_nowait()
    typed.put_nowait("quit")


async def _show(view: View, network: TcpNetwork) -> None:
    told: dict[int, int | str] = {}
    while True:
        for port, why in network.refused.items():
            if told.get(port) != why:
                told[port] = why
                view.line(f"the program's port {port} cannot be opened: {why}; see --port-map")
        for port, real in network.chosen.items():
            if port not in network.refused and told.get(port) != real:
                told[port] = real
                view.line(f"the program's port {port} is {network.bind}:{real}")
        view.refresh()
        await asyncio.sleep(VIEW_PERIOD_S)


async def _operate(
    options: AbbOptions, controller: Controller, typed: "asyncio.Queue[str]", view: View
) -> None:
    operator = Operator(controller)
    given = (["start"] if options.starts else []) + list(options.commands)
    for line in given:
        typed.put_nowait(line)
    while True:
        line = (await typed.get()).strip()
        if line.lower() in ("quit", "exit"):
            return
        try:
            if line.lower().startswith("wait "):
                await asyncio.sleep(float(line.split()[1]))
            elif line:
                await operator.obey(line)
        except (CellError, ValueError) as error:
            view.line(f"refused: {error}")
