"""The date and the time of day, on the loop's clock from the host's epoch (UTC)."""

import asyncio
from datetime import UTC, datetime, timedelta

from sims.rapid.builtin import TaskContext, builtin
from sims.rapid.errors import RapidError

__all__: list[str] = []

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def _now(task: TaskContext) -> datetime:
    return _EPOCH + timedelta(seconds=task.host.epoch_s + asyncio.get_running_loop().time())


@builtin("FUNC string CDate()")
def c_date(task: TaskContext) -> str:
    """``2016-10-23``."""
    return f"{_now(task):%Y-%m-%d}"


@builtin("FUNC string CTime()")
def c_time(task: TaskContext) -> str:
    """``12:53:18``."""
    return f"{_now(task):%H:%M:%S}"


@builtin(
    "FUNC num GetTime(\\switch WDay | switch Hour | switch Min | switch Sec | switch MDay "
    "| switch Month | switch Year)"
)
def get_time(
    task: TaskContext,
    *,
    wday: bool = False,
    hour: bool = False,
    min_: bool = False,
    sec: bool = False,
    mday: bool = False,
    month: bool = False,
    year: bool = False,
) -> float:
    """One part of date or time; Monday is 1."""
    now = _now(task)
    parts = (
        (wday, now.isoweekday()),
        (hour, now.hour),
        (min_, now.minute),
        (sec, now.second),
        (mday, now.day),
        (month, now.month),
        (year, now.year),
    )
    for is_asked, part in parts:
        if is_asked:
            return float(part)
    raise RapidError("ERR_ARGVALERR", "GetTime: say which part with \\WDay, \\Hour ... or \\Year")
