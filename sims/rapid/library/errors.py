"""Errors that programs make, write down or pass over."""

from sims.rapid.builtin import Legal, Ref, TaskContext, builtin
from sims.rapid.errors import RapidError
from sims.rapid.frames import UserError
from sims.rapid.host import EventKind
from sims.rapid.task import task_of

RAPID_DOMAIN = 8
WRITTEN = 80_001
FIRST_BOOKED, LAST_BOOKED = 5000, 9999
MAX_LINE = 46


class Booked:
    """Error numbers that programs have booked."""

    def __init__(self) -> None:
        self.last = FIRST_BOOKED - 1


@builtin("PROC BookErrNo(VAR errnum ErrorName)")
def book_err_no(task: TaskContext, *, errorname: Ref) -> None:
    """Give a free error number; a booked one is kept."""
    if errorname.get() >= FIRST_BOOKED:
        return
    booked = task_of(task).service(Booked)
    if booked.last >= LAST_BOOKED:
        raise RapidError("ERR_ARGVALERR", "no error number is free")
    booked.last += 1
    errorname.set(float(booked.last))


@builtin(
    "PROC ErrWrite(\\switch W | switch I, string Header, string Reason \\string RL2 \\string RL3 "
    "\\string RL4)"
)
def err_write(
    task: TaskContext,
    *,
    w: bool,
    i: bool,
    header: str,
    reason: str,
    rl2: str | None,
    rl3: str | None,
    rl4: str | None,
) -> None:
    """Write an error (warning, information) of the program into the event log."""
    kind = EventKind.WARNING if w else EventKind.STATE if i else EventKind.ERROR
    cause = [text for text in (reason, rl2, rl3, rl4) if text is not None]
    task.host.log.write(kind, RAPID_DOMAIN, WRITTEN, header[:MAX_LINE], cause)


@builtin(
    "PROC ErrLog(errnum ErrorID \\switch W | switch I, errstr Argument1, errstr Argument2, "
    "errstr Argument3, errstr Argument4, errstr Argument5)"
)
def err_log(
    task: TaskContext,
    *,
    errorid: float,
    w: bool,
    i: bool,
    argument1: str,
    argument2: str,
    argument3: str,
    argument4: str,
    argument5: str,
) -> None:
    """Write an event whose text is in an XML file on a controller; its arguments here."""
    kind = EventKind.WARNING if w else EventKind.STATE if i else EventKind.ERROR
    texts = [argument1, argument2, argument3, argument4, argument5]
    number = 80_000 + int(errorid) % 10_000
    task.host.log.write(kind, RAPID_DOMAIN, number, f"Event {number}", [t for t in texts if t])


@builtin(
    "PROC ErrRaise(string ErrorName, num ErrorId, errstr Argument1, errstr Argument2, "
    "errstr Argument3, errstr Argument4, errstr Argument5)"
)
def err_raise(
    task: TaskContext,
    *,
    errorname: str,
    errorid: float,
    argument1: str,
    argument2: str,
    argument3: str,
    argument4: str,
    argument5: str,
) -> None:
    """Write a warning and raise the booked error of that name."""
    texts = [argument1, argument2, argument3, argument4, argument5]
    number = 80_000 + int(errorid) % 10_000
    task.host.log.write(EventKind.WARNING, RAPID_DOMAIN, number, errorname, [t for t in texts if t])
    booked = task.find(errorname)
    if booked is None:
        raise RapidError("ERR_ARGVALERR", f"ErrRaise: there is no error number {errorname}")
    raise UserError(int(booked.get()), errorname)


@builtin("PROC SkipWarn()")
def skip_warn(task: TaskContext) -> None:
    """Keep the last warning of the task out of the log; logs here keep everything."""
    del task


@builtin(
    "PROC ProcerrRecovery(\\switch SyncOrgMoveInst | switch SyncLastMoveInst \\switch ProcSignal)"
)
def procerr_recovery(
    task: TaskContext, *, syncorgmoveinst: bool, synclastmoveinst: bool, procsignal: bool
) -> None:
    """Raise ERR_PATH_STOP in the routine with the move."""
    del task, syncorgmoveinst, synclastmoveinst, procsignal
    raise RapidError("ERR_PATH_STOP", "ProcerrRecovery has stopped the path")


@builtin("PROC ResetRetryCount()", Legal.HANDLER)
def reset_retry_count(task: TaskContext) -> None:
    """Let RETRY be tried as often again."""
    task_of(task).machine.reset_retries()


@builtin("FUNC num RemainingRetries()", Legal.HANDLER)
def remaining_retries(task: TaskContext) -> float:
    """How often RETRY can still be tried."""
    return float(task_of(task).machine.remaining_retries)
