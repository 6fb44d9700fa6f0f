"""Stop watches. They follow the loop's time."""

import math

from sims.rapid.builtin import Ref, TaskContext, builtin, opaque
from sims.rapid.errors import RapidError
from sims.rapid.task import task_of

LIMIT_S = 4_294_967.0


class Clock:
    """Time gone by, and since when it runs; None: it stands."""

    def __init__(self) -> None:
        self.elapsed_s = 0.0
        self.began_s: float | None = None

    def read_s(self, now_s: float) -> float:
        """What it shows."""
        return self.elapsed_s + (0.0 if self.began_s is None else now_s - self.began_s)


opaque("clock", Clock)


def _clock(ref: Ref) -> Clock:
    clock: Clock = ref.get()
    return clock


@builtin("PROC ClkStart(VAR clock Clock)")
def clk_start(task: TaskContext, *, clock: Ref) -> None:
    """Let it run on; harmless when it runs."""
    watch = _clock(clock)
    if watch.began_s is None:
        watch.began_s = task_of(task).now_s()


@builtin("PROC ClkStop(VAR clock Clock)")
def clk_stop(task: TaskContext, *, clock: Ref) -> None:
    """Let it stand; harmless when it stands."""
    watch = _clock(clock)
    watch.elapsed_s = watch.read_s(task_of(task).now_s())
    watch.began_s = None


@builtin("PROC ClkReset(VAR clock Clock)")
def clk_reset(task: TaskContext, *, clock: Ref) -> None:
    """Stop it and set it to 0."""
    del task
    watch = _clock(clock)
    watch.elapsed_s, watch.began_s = 0.0, None


@builtin("FUNC num ClkRead(VAR clock Clock \\switch HighRes)")
def clk_read(task: TaskContext, *, clock: Ref, highres: bool) -> float:
    r"""Seconds, in steps of 10 ms, or of 1 us with ``\\HighRes``. ERR_OVERFLOW: 49 days."""
    shown_s = _clock(clock).read_s(task_of(task).now_s())
    if shown_s > LIMIT_S:
        raise RapidError("ERR_OVERFLOW", "the clock has run for more than 49 days")
    steps = 1e6 if highres else 100.0
    return math.floor(shown_s * steps + 1e-6) / steps
