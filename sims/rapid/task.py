"""A task: a program, its machine, and the waiting between the machine's slices."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from typing import Any, TypeVar, cast

from sims.rapid.ast import DataKind
from sims.rapid.builtin import Ref, TaskContext, TaskKind
from sims.rapid.data import Cell, Pers
from sims.rapid.errors import RapidError
from sims.rapid.frames import Frame, Pointer
from sims.rapid.host import Host
from sims.rapid.machine import Halt, Machine, Outcome
from sims.rapid.program import Program
from sims.rapid.reports import log_crash, log_fault, log_warning
from sims.rapid.states import NoRoutineError, TaskError, TaskState
from sims.rapid.symbols import Routine

__all__ = ["NoRoutineError", "Task", "TaskError", "TaskState", "task_of"]

SLICE_S = 1e-3
SLICE_STATEMENTS = 200

S = TypeVar("S")


class Task:
    r"""One RAPID task; what built-ins know as their ``TaskContext``.

    It belongs to one event loop, whose time is its time: every statement costs
    ``host.statement_ns``, paid in slices of a millisecond.

    ``has_begun`` tells whether it was started since PP to main. ``halted`` is called with the
    reason when the program itself, not the operator, ends execution. ``settled`` waits for the
    robot to stand still (``WaitTime \InPos``); None: there is none. ``peers`` are the tasks of
    the system, this one among them; ``common`` what they share.
    """

    def __init__(
        self,
        name: str,
        *,
        kind: TaskKind,
        has_motion: bool,
        host: Host,
        program: Program,
        entry: str = "main",
    ) -> None:
        self.name = name
        self.kind = kind
        self.has_motion = has_motion
        self.host = host
        self.program = program
        self.entry = entry
        self.state = TaskState.STOPPED
        self._stops_at_main = False
        self.is_cyclic = True
        self.has_begun = False
        self.event = 0.0
        self.services: dict[type[Any], Any] = {}
        self.common: dict[type[Any], Any] = {}
        self.peers: Mapping[str, Task] = {name: self}
        self.settled: Callable[[], Awaitable[None]] | None = None
        self.halted: Callable[[Task, Halt], None] = lambda task, halt: None  # noqa: ARG005
        self.machine = Machine(program, self._warn)
        self.machine.noticed = self._wake
        self.statements = 0
        self._statement_s = host.statement_ns * 1e-9
        self._debt_s = 0.0
        self._runner: asyncio.Task[None] | None = None
        self._sleeper: asyncio.Future[None] | None = None
        self._awaited: Frame | None = None
        program.common["C"] = self

    # Operation.

    @property
    def pointer(self) -> Pointer | None:
        """The program pointer: module, routine, line; None: not set, PP to main is needed."""
        return self.machine.pointer

    @property
    def stack(self) -> tuple[Pointer, ...]:
        """Where each routine stands, the outermost first."""
        return tuple(frame.pointer for frame in self.machine.frames)

    @property
    def is_running(self) -> bool:
        """Whether it executes."""
        return self.state is TaskState.STARTED

    @property
    def has_failed(self) -> bool:
        """Whether an error of the program has stopped it; a start forgets that."""
        return self.machine.fault is not None and self.state is TaskState.STOPPED

    @property
    def has_entry(self) -> bool:
        """Whether the entry routine is there."""
        return any(self.entry.lower() in scope.routines for scope in self.program.modules.values())

    @property
    def is_waiting(self) -> bool:
        """Whether an instruction waits."""
        frames = self.machine.frames
        return bool(frames) and frames[-1].wait is not None

    def pp_to_main(self) -> None:
        """Leave everything (UNDO), give VARs their first values, and go to the entry routine.

        Raises
        ------
        TaskError
            The task executes, or has no entry routine.
        """
        self._check_stopped("PP to main")
        self.machine.clear()
        self._forget_services()
        self.program.reset()
        self.machine.begin(self._routine(self.entry))
        self.has_begun = False

    def start(self, *, is_cyclic: bool | None = None) -> None:
        """Execute from the pointer on; harmless when started.

        Parameters
        ----------
        is_cyclic
            Whether the end of the entry routine leads to its beginning; None: as before.

        Raises
        ------
        TaskError
            The pointer is not set.
        """
        if is_cyclic is not None:
            self.is_cyclic = is_cyclic
        if self.state is TaskState.STARTED:
            return
        if not self.machine.frames:
            raise TaskError(f"{self.name}: the program pointer is not set: PP to main first")
        self.state = TaskState.STARTED
        self.has_begun = True
        self.machine.halt = self.machine.fault = None
        self._runner = asyncio.get_running_loop().create_task(self._execute(), name=self.name)

    def stop(self) -> None:
        """Stop between statements. What waits goes on waiting; its result is kept for a start."""
        if self.state is not TaskState.STARTED:
            return
        if self.machine.halt is None:
            self.machine.request(Halt.STOP)
        elif self.machine.halt is Halt.EXIT_CYCLE:
            self._stops_at_main = True

    async def stopped(self) -> None:
        """Until it does not execute."""
        if self._runner is not None:
            await asyncio.wait({self._runner})

    async def step(self) -> None:
        """Execute one statement, to its end. Raises ``TaskError``."""
        self._check_stopped("step")
        if not self.machine.frames:
            raise TaskError(f"{self.name}: the program pointer is not set: PP to main first")
        self.machine.halt = self.machine.fault = None
        self.state = TaskState.STARTED
        try:
            await self._step()
        finally:
            self.state = TaskState.STOPPED

    async def call_routine(self, name: str, *, event: float = 0.0) -> None:
        """Execute a routine without parameters to its end, on top of what is stopped.

        ``event`` is what ``EventType()`` says meanwhile.

        Raises
        ------
        TaskError
            The task executes; ``NoRoutineError``: there is no such routine.
        """
        self._check_stopped(f"call {name}")
        routine = self._routine(name)
        floor = len(self.machine.frames)
        self.machine.halt = self.machine.fault = None
        self.machine.begin(routine)
        self.state = TaskState.STARTED
        self.event = event
        try:
            while len(self.machine.frames) > floor:
                if await self._slice() is Outcome.HALTED:
                    break
        finally:
            self.state = TaskState.STOPPED
            self.event = 0.0
            self.machine.leave_above(floor)
        if self.machine.halt is not None:
            self._report(self.machine.halt)

    async def close(self) -> None:
        """End it: waits are given up, sockets closed, interrupts forgotten."""
        if self._runner is not None:
            self._runner.cancel()
            await asyncio.wait({self._runner})
        self.state = TaskState.STOPPED
        waits = [frame.wait.future for frame in self.machine.frames if frame.wait is not None]
        for frame in self.machine.frames:
            frame.drop_wait()
        self.machine.frames.clear()
        if pending := [future for future in waits if future is not None]:
            await asyncio.wait(pending)
        self.machine.interrupts.clear()
        self._forget_services()

    # For built-ins.

    def find(self, name: str) -> Ref | None:
        """Data by name, as the task's program sees it; ``module:name`` for local data."""
        return cast("Ref | None", self.program.find_cell(name))

    def fire(self, intnum: int) -> None:
        """Let an interrupt happen; it is served between statements, or while one waits."""
        self.machine.interrupts.fire(intnum)

    def fatal(self, number: int, message: str) -> None:
        """Stop the task with an entry in the event log."""
        self.machine.fault = RapidError(message, is_fatal=True, number=number)
        self.machine.request(Halt.ERROR)

    def service(self, kind: type[S]) -> S:
        """Return the task's object of a class, made at its first use.

        When the program starts from main again it is dropped; if it has ``close()``, that is
        called first.
        """
        if kind not in self.services:
            self.services[kind] = kind()
        return cast("S", self.services[kind])

    def common_service(self, kind: type[S]) -> S:
        """Return the object of a class that all tasks of the system share."""
        if kind not in self.common:
            self.common[kind] = kind()
        return cast("S", self.common[kind])

    def take_debt_s(self) -> float:
        """Return the time that executed statements still owe, and consider it paid."""
        debt, self._debt_s = self._debt_s, 0.0
        return debt

    def now_s(self) -> float:
        """The task's time: the loop's, and what its statements owe."""
        return asyncio.get_running_loop().time() + self._debt_s

    def watch(self, name: str, changed: Callable[[], None]) -> Callable[[], None]:
        """Call back when a persistent changes; returns what ends it. Raises ``KeyError``."""
        cell = self.program.find_cell(name)
        if not isinstance(cell, Pers):
            raise KeyError(name)
        return cell.watch(changed)

    # Execution.

    async def _execute(self) -> None:
        try:
            while True:
                outcome = await self._slice()
                if outcome is Outcome.HALTED:
                    break
                if outcome is Outcome.DONE:
                    self.machine.begin(self._routine(self.entry))
                    if not self.is_cyclic:
                        break
        except Exception as error:
            self._crash(error)
            raise
        finally:
            self.state = TaskState.STOPPED
        halt = self.machine.halt
        if halt is Halt.EXIT_CYCLE:
            self._next_cycle()
        elif halt is not None:
            self._report(halt)

    async def _slice(self) -> Outcome:
        """Let the machine run, pay for it, and wait if an instruction waits."""
        outcome, used = self.machine.run(self._budget())
        self.statements += used
        self._debt_s += used * self._statement_s
        if outcome is Outcome.WAIT:
            await self._wait()
        if self._debt_s >= SLICE_S or (used and not self._statement_s):
            await asyncio.sleep(self.take_debt_s())
        return outcome

    def _budget(self) -> int:
        if self._statement_s * SLICE_STATEMENTS <= SLICE_S:
            return SLICE_STATEMENTS
        return max(1, int(SLICE_S / self._statement_s))

    async def _wait(self) -> None:
        """Until the instruction has ended, or the machine must look up."""
        machine, frame = self.machine, self.machine.frame
        assert frame.wait is not None
        loop = asyncio.get_running_loop()
        began_s = loop.time()
        is_new = frame.wait.future is None
        future = frame.wait.start()
        if is_new:
            future.add_done_callback(self._wake)
        while not future.done() and not machine.attention:
            self._sleeper = loop.create_future()
            try:
                await self._sleeper
            finally:
                self._sleeper = None
        self._debt_s = max(0.0, self._debt_s - (loop.time() - began_s))
        if not machine.attention:
            machine.complete(frame)

    def _wake(self, _: object = None) -> None:
        if self._sleeper is not None and not self._sleeper.done():
            self._sleeper.set_result(None)

    async def _step(self) -> None:
        machine = self.machine
        frame, depth = machine.frame, len(machine.frames)
        start = frame.code.starts[frame.pc]
        while True:
            outcome, used = machine.run(1)
            self.statements += used
            if outcome is Outcome.WAIT:
                await self._wait()
                continue
            if outcome is Outcome.HALTED:
                self._report(machine.halt or Halt.STOP)
                return
            if outcome is Outcome.DONE:
                machine.begin(self._routine(self.entry))
                return
            top = machine.frame
            if len(machine.frames) != depth or top.code.starts[top.pc] != start:
                return

    def _next_cycle(self) -> None:
        self.machine.halt = None
        self.machine.begin(self._routine(self.entry))
        stops, self._stops_at_main = self._stops_at_main, False
        if stops:
            self._report(Halt.STOP)
        elif self.is_cyclic:
            self.start()

    # Reports.

    def _report(self, halt: Halt) -> None:
        fault = self.machine.fault
        if halt is Halt.ERROR and fault is not None:
            number = fault.number or self.machine.errno(fault)
            log_fault(self.host, self.name, fault, number, self.pointer)
        self.halted(self, halt)

    def _warn(self, number: int, message: str) -> None:
        log_warning(self.host, self.name, number, message)

    def _crash(self, error: Exception) -> None:
        log_crash(self.host, self.name, error, self.pointer)
        self.halted(self, Halt.ERROR)

    def _routine(self, name: str) -> Routine:
        for scope in self.program.modules.values():
            routine = scope.routines.get(name.lower())
            if routine is not None and not routine.params:
                return routine
        raise NoRoutineError(f"{self.name}: there is no routine {name} without parameters")

    def _check_stopped(self, action: str) -> None:
        if self.state is TaskState.STARTED:
            raise TaskError(f"{self.name}: {action} is for a stopped task: stop it first")

    def _forget_services(self) -> None:
        services, self.services = self.services, {}
        for service in services.values():
            if (close := getattr(service, "close", None)) is not None:
                close()

    def persistents(self) -> dict[str, Cell]:
        """Return the task's persistents by lower-case name."""
        return {
            name: datum.cell
            for name, datum in self.program.data.items()
            if datum.decl.kind is DataKind.PERS and not datum.module.is_predefined
        }


def task_of(context: TaskContext) -> Task:
    """Return the task behind the context that built-ins get."""
    assert isinstance(context, Task)
    return context
