"""Where time comes from: the world's (lock-step), the wall's with the world behind it (paced)."""

from sims.loop.lockstep import LockstepLoop
from sims.loop.paced import PacedLoop, PaceReport
from sims.loop.participants import HungParticipantError, LockstepError, SimEvent
from sims.loop.ticker import NoWorld, Ticker

__all__ = [
    "HungParticipantError",
    "LockstepError",
    "LockstepLoop",
    "NoWorld",
    "PaceReport",
    "PacedLoop",
    "SimEvent",
    "Ticker",
]
