"""All tasks of a controller, and the persistents that they share."""

from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any

from sims.rapid import library
from sims.rapid.ast import Module
from sims.rapid.builtin import Ref, TaskKind
from sims.rapid.check import check
from sims.rapid.data import Pers
from sims.rapid.errors import Diagnostic, RapidLoadError, Severity
from sims.rapid.host import Host
from sims.rapid.machine import Halt
from sims.rapid.program import Program, SharedData
from sims.rapid.task import Task
from sims.rapid.types import Shape, Type

__all__ = ["Kept", "RapidSystem", "TaskPlan"]

Kept = dict[tuple[str, str, str], tuple[Shape, Any]]


@dataclass(frozen=True, slots=True)
class TaskPlan:
    """A task as it was added."""

    name: str
    kind: TaskKind
    has_motion: bool
    modules: tuple[Module, ...]
    entry: str
    overrides: Mapping[str, str] = field(default_factory=dict)


class RapidSystem:
    """Tasks over one host. Add them, ``load()``, then operate ``tasks``.

    The program of every task is linked anew at each load. Persistents begin with their initial
    values then, unless ``restore`` brings back what ``persistents`` had.
    """

    def __init__(self, host: Host, *, units: Sequence[str] = ("ROB_1",)) -> None:
        library.register()
        self._units = tuple(units)
        self.host = host
        self.tasks: dict[str, Task] = {}
        self.shared: SharedData = {}
        self._plans: list[TaskPlan] = []
        self._common: dict[type[Any], Any] = {}

    def add_task(
        self,
        name: str,
        kind: TaskKind,
        has_motion: bool,
        modules: Sequence[Module],
        entry: str = "main",
        overrides: Mapping[str, str] | None = None,
    ) -> None:
        """Plan a task that starts with the routine ``entry``.

        ``overrides`` are initial values in RAPID by name (``port`` or ``module:port``), which
        replace those in the modules.
        """
        self._plans.append(TaskPlan(name, kind, has_motion, tuple(modules), entry, overrides or {}))

    def load(self) -> list[Diagnostic]:
        """Link all tasks and set their pointers to main; return the warnings.

        Tasks of a load before have to be closed.

        Raises
        ------
        RapidLoadError
            With all that is wrong in all tasks. No task is there then.
        """
        self.shared.clear()
        self.tasks.clear()
        self._common.clear()
        warnings: list[Diagnostic] = []
        errors: list[Diagnostic] = []
        for plan in self._plans:
            for problem in self._check(plan):
                chosen = errors if problem.severity is Severity.ERROR else warnings
                chosen.append(problem)
        if errors:
            raise RapidLoadError(errors)
        made: dict[str, Task] = {}
        for plan in self._plans:
            made[plan.name], wrong = self._make(plan)
            errors += wrong
        if errors:
            raise RapidLoadError(errors)
        self.tasks.update(made)
        for task in made.values():
            task.halted = self._task_halted
            task.peers = self.tasks
            task.common = self._common
            if task.has_entry:
                task.pp_to_main()
        return warnings

    def find(self, task: str, name: str) -> Ref | None:
        """Data of a task by name; ``module:name`` for local data."""
        return self.tasks[task].find(name)

    def stop(self) -> None:
        """Stop all NORMAL tasks."""
        for task in self.tasks.values():
            if task.kind is TaskKind.NORMAL:
                task.stop()

    async def close(self) -> None:
        """End all tasks."""
        for task in self.tasks.values():
            await task.close()

    def pers(self, name: str) -> Pers | None:
        """A persistent that tasks share, by name."""
        return self.shared.get(name.lower())

    def persistents(self) -> Kept:
        """The values of all persistents of the modules, for ``restore`` after another load."""
        return {key: (pers.shape, deepcopy(pers.value)) for key, pers in self._persistents()}

    def restore(self, kept: Kept) -> None:
        """Give persistents of the same name, type and size their values back."""
        for key, pers in self._persistents():
            shape, value = kept.get(key, (None, None))
            if shape is not None and _is_alike(shape, pers.shape):
                pers.set(value)

    def _persistents(self) -> Iterator[tuple[tuple[str, str, str], Pers]]:
        for task in self.tasks.values():
            for module in task.program.modules.values():
                for name, datum in module.data.items():
                    if isinstance(datum.cell, Pers) and not module.is_predefined:
                        yield (task.name, module.name.lower(), name), datum.cell

    def _check(self, plan: TaskPlan) -> list[Diagnostic]:
        others = {other.name: other.modules for other in self._plans if other.name != plan.name}
        return check(
            plan.modules,
            kind=plan.kind,
            has_motion=plan.has_motion,
            signals=self.host.signals.keys(),
            others=others,
            extra=[name for _, name in self._extra()],
        )

    def _extra(self) -> list[tuple[str, str]]:
        """Data that every task finds: the tasks and the mechanical units."""
        tasks = [("taskid", f"{plan.name}Id") for plan in self._plans if plan.name.isidentifier()]
        return [*tasks, *(("mecunit", unit) for unit in self._units)]

    def _make(self, plan: TaskPlan) -> tuple[Task, list[Diagnostic]]:
        program = Program(
            signals=self.host.signals,
            shared=self.shared,
            overrides=plan.overrides,
            extra=self._extra(),
        )
        task = Task(
            plan.name,
            kind=plan.kind,
            has_motion=plan.has_motion,
            host=self.host,
            program=program,
            entry=plan.entry,
        )
        return task, program.add(plan.modules)

    def _task_halted(self, task: Task, halt: Halt) -> None:
        """A NORMAL task that ends by itself takes the others along."""
        if task.kind is TaskKind.NORMAL and halt is not Halt.EXIT_CYCLE:
            self.stop()


def _is_alike(one: Shape, other: Shape) -> bool:
    """Whether a value of one fits the other: records are compared by their components."""
    return one.dims == other.dims and _layout(one.type) == _layout(other.type)


def _layout(kind: Type) -> Any:
    return [(name, _layout(inner)) for name, inner in kind.fields] or kind.name
