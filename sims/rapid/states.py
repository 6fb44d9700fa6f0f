"""Whether a task executes, and why it cannot do what was asked of it."""

from enum import StrEnum

from hal.errors import CellError

__all__ = ["NoRoutineError", "TaskError", "TaskState"]


class TaskError(CellError):
    """A task cannot do what was asked of it now; says why and what to do."""


class NoRoutineError(TaskError, KeyError):
    """The task's program has no such routine."""

    __str__ = TaskError.__str__


class TaskState(StrEnum):
    """Whether a task executes."""

    STOPPED = "stopped"
    STARTED = "started"
