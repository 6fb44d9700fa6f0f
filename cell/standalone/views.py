"""How a stand-alone controller is seen: plain lines, or a pendant in the terminal."""

import asyncio
import math
import os
import sys
from collections import deque
from typing import Any

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from sims.controller import Controller, Entry
from sims.controller.operator import HELP, describe

__all__ = ["PendantView", "PlainView", "is_in_front"]

SHOWN_LINES = 8
MOST_TYPED = 200
BACKSPACES = ("\x7f", "\b")
KIND_STYLES = {"error": "red", "warning": "yellow", "state": "default"}


def is_in_front() -> bool:
    """Whether the keyboard is ours; a job in the background that reads it would be stopped."""
    try:
        return os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp()
    except (OSError, ValueError):
        return False


class PlainView:
    """A line for each event; commands come from standard input, a line each."""

    def __init__(self, screen: Console) -> None:
        self._screen = screen
        self._rest = b""

    def begin(self, controller: Controller, typed: "asyncio.Queue[str]") -> None:
        """Listen to standard input, where it can be listened to."""
        self._screen.print(f"{controller.unit.arm.model}: controller is on", markup=False)
        if sys.stdin.isatty() and not is_in_front():
            return
        try:
            asyncio.get_running_loop().add_reader(sys.stdin.fileno(), self._read, typed)
        except (OSError, ValueError):  # a file or nothing: only --command
            return

    def _read(self, typed: "asyncio.Queue[str]") -> None:
        data = os.read(sys.stdin.fileno(), 4096)
        if not data:
            asyncio.get_running_loop().remove_reader(sys.stdin.fileno())
            return
        *lines, self._rest = (self._rest + data).split(b"\n")
        self._rest = self._rest[:MOST_TYPED]
        for line in lines:
            if not typed.full():
                typed.put_nowait(line.decode("utf-8", "replace"))

    def entry(self, entry: Entry) -> None:
        """Show it."""
        self._screen.print(f"{entry.stamp_s:9.3f} {entry}", markup=False)

    def line(self, text: str) -> None:
        """Show it."""
        self._screen.print(text, markup=False)

    def refresh(self) -> None:
        """Nothing moves here."""

    def end(self) -> None:
        """Listen no more."""
        try:
            asyncio.get_running_loop().remove_reader(sys.stdin.fileno())
        except (OSError, ValueError):
            return


class PendantView:
    """Tasks, state, joints, signals, event log and pendant lines, redrawn; a command line below."""

    def __init__(self, screen: Console) -> None:
        self._live = Live(console=screen, screen=True, auto_refresh=False)
        self._controller: Controller | None = None
        self._typing = ""
        self._lines: deque[str] = deque(maxlen=SHOWN_LINES)
        self._terminal: list[Any] | None = None

    def begin(self, controller: Controller, typed: "asyncio.Queue[str]") -> None:
        """Take the terminal over."""
        import termios
        import tty

        self._controller = controller
        self._terminal = termios.tcgetattr(sys.stdin.fileno())
        tty.setcbreak(sys.stdin.fileno())
        asyncio.get_running_loop().add_reader(sys.stdin.fileno(), self._read, typed)
        self._live.start()

    def _read(self, typed: "asyncio.Queue[str]") -> None:
        for letter in os.read(sys.stdin.fileno(), 1024).decode("utf-8", "replace"):
            if letter in "\r\n":
                if not typed.full():
                    typed.put_nowait(self._typing)
                self._typing = ""
            elif letter in BACKSPACES:
                self._typing = self._typing[:-1]
            elif letter.isprintable() and len(self._typing) < MOST_TYPED:
                self._typing += letter

    def entry(self, entry: Entry) -> None:
        """It is in the log that is drawn."""

    def line(self, text: str) -> None:
        """Keep it for the next drawing."""
        self._lines.append(text)

    def refresh(self) -> None:
        """Draw."""
        if self._controller is not None:
            self._live.update(self._drawn(describe(self._controller)), refresh=True)

    def end(self) -> None:
        """Give the terminal back."""
        if self._terminal is None:
            return
        import termios

        asyncio.get_running_loop().remove_reader(sys.stdin.fileno())
        self._live.stop()
        termios.tcsetattr(sys.stdin.fileno(), termios.TCSADRAIN, self._terminal)

    def _drawn(self, state: dict[str, Any]) -> RenderableType:
        running = "running" if state["is_running"] else "stopped"
        head = (
            f"{state['robot']}  {state['mode']}  {state['state']}  {running}  "
            f"speed {state['speed_ratio']:.0%}"
        )
        return Group(
            Panel(Group(_tasks(state), _place(state), _signals(state)), title=head),
            Panel(_log(state), title="event log"),
            Panel(Text("\n".join(self._lines)), title="operator window"),
            Text(f"> {self._typing}"),
            Text(f"{HELP}, quit", style="dim"),
        )


def _tasks(state: dict[str, Any]) -> Table:
    table = Table.grid(padding=(0, 2))
    for name, task in state["tasks"].items():
        table.add_row(name, task["kind"], task["state"], task["pointer"] or "no pointer")
    return table


def _place(state: dict[str, Any]) -> Text:
    # Adding 0 takes the sign from a zero.
    joints = "  ".join(f"{round(math.degrees(q), 2) + 0.0:8.2f}" for q in state["joints_rad"])
    x, y, z = (round(v * 1e3, 2) + 0.0 for v in state["tcp_m"])
    return Text(f"axes {joints} deg\ntool {x:8.2f} {y:8.2f} {z:8.2f} mm")


def _signals(state: dict[str, Any]) -> Text:
    text = Text()
    for name, value in state["signals"].items():
        text.append(f"{name}={value:g} ", style="bold green" if value else "dim")
    return text


def _log(state: dict[str, Any]) -> Text:
    text = Text()
    for entry in state["log"][-SHOWN_LINES:]:
        cause = "; ".join(entry["cause"])
        text.append(
            f"{entry['stamp_s']:9.2f} {entry['code']} {entry['title']}  {cause}\n",
            style=KIND_STYLES.get(entry["kind"], "default"),
        )
    return text
