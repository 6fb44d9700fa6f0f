"""Worker threads that are kept and used again."""

import threading
from collections.abc import Callable
from queue import SimpleQueue

__all__ = ["Workers"]


class Workers:
    """As many threads as there are jobs at once; daemons, so that a hung one ends with us.

    Kept threads matter: numeric libraries hold state and thread teams per calling thread.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._lock = threading.Lock()
        self._idle: list[SimpleQueue[Callable[[], None] | None]] = []
        self._count = 0
        self._is_closed = False

    def start(self, job: Callable[[], None]) -> None:
        """Run ``job`` in a thread at once; it must not raise."""
        with self._lock:
            if self._is_closed:
                raise RuntimeError("the workers have gone home")
            inbox = self._idle.pop() if self._idle else self._hire()
        inbox.put(job)

    def close(self) -> None:
        """Send the idle threads home; busy ones follow when they are done."""
        with self._lock:
            self._is_closed = True
            idle, self._idle = self._idle, []
        for inbox in idle:
            inbox.put(None)

    def _hire(self) -> "SimpleQueue[Callable[[], None] | None]":
        inbox: SimpleQueue[Callable[[], None] | None] = SimpleQueue()
        self._count += 1
        name = f"{self._name}-{self._count}"
        threading.Thread(target=self._work, args=(inbox,), name=name, daemon=True).start()
        return inbox

    def _work(self, inbox: "SimpleQueue[Callable[[], None] | None]") -> None:
        while (job := inbox.get()) is not None:
            job()
            with self._lock:
                if self._is_closed:
                    return
                self._idle.append(inbox)
