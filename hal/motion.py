"""A command on its way: awaitable, cancellable."""

import asyncio
from collections.abc import Coroutine, Generator
from typing import Any, Generic, TypeVar

__all__ = ["Motion"]

R = TypeVar("R")


class Motion(Generic[R]):
    """What a device command returns; the command has begun when the caller holds it.

    Awaiting gives the result or raises the device's error. Cancelling stops the device: a
    driver hands in a coroutine that does so when ``asyncio.CancelledError`` reaches it.
    Awaiting twice is harmless, and an await that is cancelled (``asyncio.timeout``) cancels
    the command.
    """

    def __init__(self, command: Coroutine[Any, Any, R], *, name: str = "motion") -> None:
        self._task: asyncio.Task[R] = asyncio.get_running_loop().create_task(command, name=name)

    def done(self) -> bool:
        """Whether the command has ended, well or not."""
        return self._task.done()

    def cancel(self) -> None:
        """Ask the device to stop; await the motion to see it stopped."""
        self._task.cancel()

    def __await__(self) -> Generator[Any, None, R]:
        return self._task.__await__()
