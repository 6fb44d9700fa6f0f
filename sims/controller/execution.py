"""Running programs: start, stop, PP to main, and the event routines around them."""

from collections.abc import Sequence

from hal.errors import CellError
from sims.controller.backup import Event, EventRoutine
from sims.controller.eventlog import ControllerLog
from sims.controller.unit import MechanicalUnit
from sims.rapid.builtin import TaskKind
from sims.rapid.host import EventKind
from sims.rapid.machine import Halt
from sims.rapid.system import RapidSystem
from sims.rapid.task import Task, TaskError, TaskState

__all__ = ["PROGRAM_HOLD", "Execution", "StartRefusedError"]

PROGRAM_HOLD = "program stopped"
OPERATIONAL = 1


class StartRefusedError(CellError):
    """The programs were not started; the message says why and what to do."""


class Execution:
    """The NORMAL tasks as one: they run together, and so does the arm.

    Event routines named in the configuration run in their tasks, in sequence; an unknown one is
    logged and passed over.
    """

    def __init__(
        self,
        system: RapidSystem,
        unit: MechanicalUnit,
        log: ControllerLog,
        routines: Sequence[EventRoutine],
    ) -> None:
        self._system = system
        self._unit = unit
        self._log = log
        self._routines = routines
        self._has_begun = False
        self._has_started = False
        self._normal: list[Task] = []
        self.is_running = False
        self.has_failed = False
        unit.hold(PROGRAM_HOLD)

    @property
    def normal_tasks(self) -> list[Task]:
        """Those that the operator starts and stops; a task without its entry routine is none."""
        tasks = self._system.tasks.values()
        return [task for task in tasks if task.kind is TaskKind.NORMAL and task.has_entry]

    async def power_on(self) -> None:
        """Start the tasks in the background; all stand at their beginnings."""
        await self._call(Event.POWER_ON)
        for task in self._system.tasks.values():
            if task.kind is not TaskKind.NORMAL and task.has_entry:
                await self._call(Event.START, task)
                task.start()

    async def start(self) -> None:
        """Run from where the program pointers stand. The caller has checked that it may."""
        if self.is_running:
            return
        self.is_running, self.has_failed = True, False
        event = Event.RESTART if self._has_begun else Event.START
        self._has_begun = True
        for task in self.normal_tasks:
            await task.stopped()
            await self._call(event, task)
        if not self.is_running:  # stopped meanwhile
            return
        self._normal = self.normal_tasks
        for task in self._normal:
            task.start()
        self._has_started = True
        self._unit.release(PROGRAM_HOLD)
        self._log.write(EventKind.STATE, OPERATIONAL, 10150, "Program started")

    def stop(self, cause: str) -> bool:
        """Brake on the path and hold the programs; whether they ran."""
        self._unit.hold(PROGRAM_HOLD)
        if not self.is_running:
            return False
        self.is_running = self._has_started = False
        for task in self.normal_tasks:
            task.stop()
        self._log.write(EventKind.STATE, OPERATIONAL, 10125, "Program stopped", [cause])
        return True

    async def stopped(self, event: Event) -> None:
        """Run the event routines of a stop."""
        for task in self.normal_tasks:
            await task.stopped()
        for task in self.normal_tasks:
            if not self.is_running:
                await self._call(event, task)

    def poll(self) -> None:
        """See whether the programs have stopped by themselves."""
        if not self._has_started:
            return
        if any(task.state is TaskState.STARTED for task in self._normal):
            return
        self.has_failed = any(task.machine.halt is Halt.ERROR for task in self._normal)
        self.stop("a task has an error" if self.has_failed else "the program has ended or stopped")

    async def pp_to_main(self) -> None:
        """Begin anew; the path is forgotten."""
        self._has_begun, self.has_failed = False, False
        self._unit.drop()
        self._unit.stored.clear()
        for task in self.normal_tasks:
            await task.stopped()
            task.pp_to_main()
        await self._call(Event.RESET)
        self._log.write(
            EventKind.STATE, OPERATIONAL, 10002, "Program pointer has been reset to main"
        )

    async def _call(self, event: Event, task: Task | None = None) -> None:
        tasks = self._system.tasks.values() if task is None else [task]
        for routine in self._routines:
            for one in tasks:
                if routine.event is event and routine.task.lower() in ("", one.name.lower()):
                    await self._call_in(one, routine)

    async def _call_in(self, task: Task, routine: EventRoutine) -> None:
        try:
            await task.call_routine(routine.routine)
        except TaskError as error:
            self._log.write(
                EventKind.WARNING,
                OPERATIONAL,
                20192,
                "Event routine not run",
                [str(error)],
            )
