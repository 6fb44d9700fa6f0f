"""``abb.statements_per_s``: how fast the RAPID machine is."""

import asyncio
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hal import Figure
from sims.loop import LockstepLoop, NoWorld
from sims.rapid.builtin import TaskKind
from sims.rapid.host import EventKind, Host
from sims.rapid.network import MemoryNetwork
from sims.rapid.parser import parse_text
from sims.rapid.system import RapidSystem

__all__ = ["run", "statements_per_s"]

ROUNDS = 100_000
REPEATS = 5

PROGRAM = """
MODULE Load
    CONST num rounds := @ROUNDS@;
    VAR num total;
    VAR num odd;
    VAR num list{10};
    VAR pos point;
    PROC main()
        VAR num k;
        FOR i FROM 1 TO rounds DO
            k := i MOD 10 + 1;
            list{k} := list{k} + i / 3;
            IF k > 5 AND i > 10 THEN
                odd := odd + 1;
            ELSE
                point.x := point.x + list{k};
            ENDIF
            total := total + k;
        ENDFOR
    ENDPROC
ENDMODULE
"""


class _Log:
    """An event log that must stay empty."""

    def write(
        self, kind: EventKind, domain: int, number: int, title: str, cause: Sequence[str] = ()
    ) -> None:
        raise AssertionError(f"{kind} {domain} {number}: {title} {cause}")

    def watch(self, written: Any) -> Any:
        del written
        return lambda: None


class _Pendant:
    """Nobody is there."""

    def write(self, text: str) -> None:
        del text

    def erase(self) -> None:
        """Nothing to clear."""

    async def ask(self, question: str, keys: Sequence[str]) -> int:
        del question, keys
        return 1

    async def ask_number(self, question: str) -> float:
        del question
        return 0.0


class _Host:
    """A controller with nothing to it."""

    def __init__(self) -> None:
        self.signals: dict[str, Any] = {}
        self.log = _Log()
        self.pendant = _Pendant()
        self.network = MemoryNetwork()
        self.home: Path | None = None
        self.info: Mapping[str, str] = {}
        self.epoch_s = 0.0
        self.statement_ns = 5_000
        self.op_mode = "OP_AUTO"
        self.run_mode = "RUN_CONT_CYCLE"

    def cfg(self, path: str, attribute: str) -> str | float | bool:
        raise KeyError(path, attribute)


def run() -> list[Figure]:
    """Return the figure: statements of a mixed loop in a second of wall time."""
    rates = [statements_per_s() for _ in range(REPEATS)]
    return [Figure.median("abb.statements_per_s", rates, "1/s")]


def statements_per_s(rounds: int = ROUNDS) -> float:
    """Statements that the machine executes in a second: loop, branch, arithmetic, arrays."""
    modules, _ = parse_text(PROGRAM.replace("@ROUNDS@", str(rounds)), "load.mod")
    host: Host = _Host()
    loop = LockstepLoop(NoWorld())
    try:
        return loop.run_until_complete(_rate(host, modules))
    finally:
        loop.close()


async def _rate(host: Host, modules: Any) -> float:
    system = RapidSystem(host)
    system.add_task("T_ROB1", TaskKind.NORMAL, has_motion=False, modules=modules)
    system.load()
    task = system.tasks["T_ROB1"]
    await asyncio.sleep(0)
    began_s = time.perf_counter()
    task.start(is_cyclic=False)
    await task.stopped()
    wall_s = time.perf_counter() - began_s
    if task.has_failed:
        raise RuntimeError("the bench program has failed")
    return task.statements / wall_s
