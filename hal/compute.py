"""Heavy work off the loop's thread, at an honest cost in the loop's time."""

import asyncio
from collections.abc import Callable
from typing import Any, Protocol, TypeVar, cast

__all__ = ["compute"]

R = TypeVar("R")


class _ChargingLoop(Protocol):
    def run_charged(
        self, job: Callable[[], Any], *, charge_s: float, name: str
    ) -> "asyncio.Future[Any]": ...


async def compute(job: Callable[[], R], *, charge_s: float = 0.0, name: str = "job") -> R:
    """Run ``job`` in a worker thread and return what it returns.

    On a simulated loop in lock-step the result is there exactly ``charge_s`` of loop time
    later, however long it took on the wall; on any other loop it is there when it is done.
    ``job`` must be pure: it may not touch the loop, a device or the world.
    """
    loop = asyncio.get_running_loop()
    if hasattr(loop, "run_charged"):
        charging = cast("_ChargingLoop", loop)
        return cast("R", await charging.run_charged(job, charge_s=charge_s, name=name))
    return await loop.run_in_executor(None, job)
