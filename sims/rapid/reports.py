"""What goes into the event log when a program or the machine fails."""

from sims.rapid.errors import RapidError
from sims.rapid.frames import Pointer
from sims.rapid.host import EventKind, Host

__all__ = ["log_crash", "log_fault", "log_warning"]

PROGRAM_DOMAIN = 4
EXECUTION_ERROR = 40_000
WARNING = 40_001
INTERNAL_ERROR = 40_099


def log_fault(
    host: Host, task: str, error: RapidError, number: int, pointer: Pointer | None
) -> None:
    """An error that no handler takes."""
    cause = [f"Task {task}"]
    if pointer is not None:
        cause.append(f"Program ref. {pointer}")
    if error.message:
        cause.append(error.message)
    title = error.name if error.is_fatal else f"Unhandled error {error.name}"
    host.log.write(EventKind.ERROR, PROGRAM_DOMAIN, number or EXECUTION_ERROR, title, cause)


def log_warning(host: Host, task: str, number: int, message: str) -> None:
    """Something is lost, and the program goes on."""
    host.log.write(EventKind.WARNING, PROGRAM_DOMAIN, number or WARNING, message, [f"Task {task}"])


def log_crash(host: Host, task: str, error: Exception, pointer: Pointer | None) -> None:
    """A bug of ours: said where users look first."""
    cause = [f"Task {task}", f"Program ref. {pointer}", repr(error)[:200]]
    host.log.write(EventKind.ERROR, PROGRAM_DOMAIN, INTERNAL_ERROR, "Internal error", cause)
