"""RAPID message queues: one for each task of a controller.

A queue is bounded, and so is a message; a full queue refuses and nothing is dropped.
"""

import asyncio
import weakref
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

__all__ = ["MAX_MESSAGES", "MAX_VALUES", "Message", "Queue", "Queues", "queues_of"]

MAX_MESSAGES = 10
MAX_VALUES = 1000

Cancel = Callable[[], None]


@dataclass(frozen=True, slots=True)
class Message:
    """``data`` is a value of the type ``datatype`` (its declared name) with these dimensions."""

    datatype: str
    dims: tuple[int, ...]
    data: Any
    sender: str
    user_def: float = -1.0


@dataclass(slots=True)
class Queue:
    """What waits for one task, oldest first, and who wants to hear of it."""

    name: str
    messages: deque[Message] = field(default_factory=deque)
    _watchers: list[tuple[str, Callable[[], None]]] = field(default_factory=list)
    _arrived: asyncio.Event | None = None

    def put(self, message: Message) -> bool:
        """Add a message and tell those who watch its type; False when the queue is full."""
        if len(self.messages) >= MAX_MESSAGES:
            return False
        self.messages.append(message)
        if self._arrived is not None:
            self._arrived.set()
        for datatype, call in list(self._watchers):
            if datatype == message.datatype.lower():
                call()
        return True

    def take(self) -> Message | None:
        """Remove the oldest message; None when there is none."""
        return self.messages.popleft() if self.messages else None

    async def wait(self, timeout_s: float | None) -> Message | None:
        """Remove the oldest message, or wait for one; None when the time is up."""
        try:
            async with asyncio.timeout(timeout_s):
                while not self.messages:
                    self._arrived = asyncio.Event()
                    await self._arrived.wait()
        except TimeoutError:
            return None
        return self.take()

    def watch(self, datatype: str, arrived: Callable[[], None]) -> Cancel:
        """Call back at each message of a type (IRMQMessage), until cancelled."""
        entry = (datatype.lower(), arrived)
        self._watchers.append(entry)

        def cancel() -> None:
            if entry in self._watchers:
                self._watchers.remove(entry)

        return cancel


class Queues:
    """The queues of one controller, by task."""

    def __init__(self) -> None:
        self._queues: dict[str, Queue] = {}

    def of(self, task_name: str) -> Queue:
        """Return the queue of a task; it is made when first asked for."""
        return self._queues.setdefault(task_name.lower(), Queue(task_name))

    def find(self, slot_name: str) -> Queue | None:
        """Return the queue ``RMQ_<task>`` of a task that has one; None otherwise."""
        low = slot_name.lower()
        return self._queues.get(low.removeprefix("rmq_")) if low.startswith("rmq_") else None


_ALL: dict[int, tuple[weakref.ref[Any], Queues]] = {}


def queues_of(host: object) -> Queues:
    """Return the queues of the controller behind a host; they live as long as it does."""
    key = id(host)
    known = _ALL.get(key)
    if known is None:
        known = weakref.ref(host, lambda _: _ALL.pop(key, None)), Queues()
        _ALL[key] = known
    return known[1]
