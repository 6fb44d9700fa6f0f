"""A host without a robot, and one call to run RAPID on it in lock-step."""

import asyncio
import textwrap
from dataclasses import dataclass, field

from sims.loop import LockstepLoop, NoWorld
from sims.rapid.builtin import TaskKind
from sims.rapid.errors import RapidLoadError, Severity
from sims.rapid.host import EventKind, SignalKind
from sims.rapid.network import MemoryNetwork
from sims.rapid.parser import parse_text
from sims.rapid.system import RapidSystem


@dataclass
class Entry:
    kind: EventKind
    domain: int
    number: int
    title: str
    cause: tuple[str, ...] = ()
    at_s: float = 0.0


class Log:
    def __init__(self):
        self.entries = []
        self._watchers = []

    def write(self, kind, domain, number, title, cause=()):
        at_s = asyncio.get_running_loop().time()
        entry = Entry(kind, domain, number, title, tuple(cause), at_s)
        self.entries.append(entry)
        for watcher in tuple(self._watchers):
            watcher(entry)

    def watch(self, written):
        self._watchers.append(written)
        return lambda: self._watchers.remove(written)

    @property
    def titles(self):
        return [entry.title for entry in self.entries]


class Pendant:
    def __init__(self):
        self.lines = []
        self.questions = []
        self.answers = []

    def write(self, text):
        self.lines.append(text)

    def erase(self):
        self.lines.clear()

    async def ask(self, question, keys):
        self.questions.append((question, tuple(keys)))
        if not self.answers:
            await asyncio.Event().wait()
        return self.answers.pop(0)

    async def ask_number(self, question):
        return await self.ask(question, ())


class Signal:
    def __init__(self, name, kind):
        self.name = name
        self.kind = kind
        self.value = 0.0
        self._watchers = []

    def set(self, value):
        if value != self.value:
            self.value = float(value)
            for watcher in tuple(self._watchers):
                watcher(self.value)

    def watch(self, changed):
        self._watchers.append(changed)
        return lambda: self._watchers.remove(changed)


SIGNALS = [
    ("di1", "DI"), ("di2", "DI"), ("do1", "DO"), ("do2", "DO"), ("ai1", "AI"), ("ao1", "AO"),
    ("gi1", "GI"), ("go1", "GO"),
]  # fmt: skip


@dataclass
class Host:
    signals: dict = field(
        default_factory=lambda: {name: Signal(name, SignalKind(kind)) for name, kind in SIGNALS}
    )
    log: Log = field(default_factory=Log)
    pendant: Pendant = field(default_factory=Pendant)
    network: MemoryNetwork = field(default_factory=MemoryNetwork)
    home: object = None
    info: dict = field(default_factory=lambda: {"serialno": "1200-1", "lanip": "192.168.125.1"})
    epoch_s: float = 0.0
    statement_ns: int = 5_000
    op_mode: str = "OP_AUTO"
    run_mode: str = "RUN_CONT_CYCLE"

    def cfg(self, path, attribute):
        return {("MOC/ARM_TYPE/robot_1", "x"): 4.5}[path, attribute]


def modules(text):
    """The modules of a text; a text without MODULE is the inside of one."""
    text = textwrap.dedent(text)
    if "MODULE" not in text:
        text = f"MODULE Bench\n{text}\nENDMODULE"
    found, diagnostics = parse_text(text, "test.mod")
    wrong = [str(one) for one in diagnostics if one.severity is Severity.ERROR]
    assert not wrong, wrong
    return found


def make(*texts, host=None, kinds=None, overrides=None):
    """A loaded system with one task for each text, T_ROB1, T_2, ..."""
    system = RapidSystem(host or Host())
    for k, text in enumerate(texts):
        name = "T_ROB1" if k == 0 else f"T_{k + 1}"
        kind = (kinds or [TaskKind.NORMAL] * len(texts))[k]
        system.add_task(name, kind, k == 0, modules(text), overrides=overrides)
    system.load()
    return system


def play(script, *texts, **options):
    """Load, then run ``script(system)`` in lock-step."""

    async def main():
        system = make(*texts, **options)
        try:
            return await script(system)
        finally:
            await system.close()

    loop = LockstepLoop(NoWorld())
    try:
        return loop.run_until_complete(main())
    finally:
        loop.close()


def run(*texts, **options):
    """Run all tasks through main once and return the system."""

    async def script(system):
        for task in system.tasks.values():
            task.start(is_cyclic=False)
        for task in system.tasks.values():
            await task.stopped()
        return system

    return play(script, *texts, **options)


def value(system, name, task="T_ROB1"):
    return system.find(task, name).get()


def result(text, name="result", **options):
    """What a program leaves in a variable; the program must not fail."""
    system = run(text, **options)
    assert not system.tasks["T_ROB1"].has_failed, system.host.log.entries
    return value(system, name)


def load_errors(*texts, **options):
    """What is wrong with programs."""
    loop = LockstepLoop(NoWorld())
    try:
        make(*texts, **options)
    except RapidLoadError as error:
        return [str(one) for one in error.diagnostics]
    finally:
        loop.close()
    return []
