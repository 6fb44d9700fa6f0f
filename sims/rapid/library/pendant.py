"""The operator's window: writing and asking."""

import asyncio
from collections.abc import Awaitable, Sequence
from typing import Any, TypeVar

from sims.rapid.builtin import Ref, TaskContext, builtin
from sims.rapid.errors import RapidError
from sims.rapid.formats import value_text
from sims.rapid.host import Signal
from sims.rapid.library.waits import until
from sims.rapid.task import task_of

MAX_LINE = 80
R = TypeVar("R")
_BREAKS = "\\num MaxTime \\signaldi DIBreak \\num DIPassive \\signaldo DOBreak \\num DOPassive "
_BREAKS += "\\PERS bool PersBoolBreak \\VAR errnum BreakFlag"
_BUTTONS: dict[float, tuple[tuple[str, float], ...]] = {
    -1.0: (),
    0.0: (("OK", 1.0),),
    1.0: (("Abort", 2.0), ("Retry", 3.0), ("Ignore", 4.0)),
    2.0: (("OK", 1.0), ("Cancel", 5.0)),
    3.0: (("Retry", 3.0), ("Cancel", 5.0)),
    4.0: (("Yes", 6.0), ("No", 7.0)),
    5.0: (("Yes", 6.0), ("No", 7.0), ("Cancel", 5.0)),
}


@builtin("PROC TPWrite(string String \\num Num | bool Bool | pos Pos | orient Orient | dnum Dnum)")
def tp_write(task: TaskContext, *, string: str, **values: Any) -> None:
    """Write a line, with a value behind it."""
    shown = [
        value_text(value, is_dnum=base == "dnum")
        for base, value in values.items()
        if value is not None
    ]
    task.host.pendant.write("".join([string, *shown])[:MAX_LINE])


@builtin("PROC TPErase()")
def tp_erase(task: TaskContext) -> None:
    """Clear the window."""
    task.host.pendant.erase()


@builtin("PROC TPShow(tpnum Window)")
def tp_show(task: TaskContext, *, window: float) -> None:
    """Choose a window; here there is one."""
    del task, window


@builtin(
    "PROC TPReadFK(INOUT num TPAnswer, string TPText, string TPFK1, string TPFK2, string TPFK3, "
    f"string TPFK4, string TPFK5 {_BREAKS})"
)
async def tp_read_fk(task: TaskContext, **arguments: Any) -> None:
    """Ask; the answer is the number of a key."""
    keys = [arguments[f"tpfk{k}"] for k in range(1, 6)]
    asking = task.host.pendant.ask(arguments["tptext"], keys)
    answer = await _answered(task, asking, arguments)
    if answer is not None:
        arguments["tpanswer"].set(float(answer))


@builtin(f"PROC TPReadNum(INOUT num TPAnswer, string TPText {_BREAKS})")
async def tp_read_num(task: TaskContext, **arguments: Any) -> None:
    """Ask for a number."""
    answer = await _answered(task, task.host.pendant.ask_number(arguments["tptext"]), arguments)
    if answer is not None:
        arguments["tpanswer"].set(float(answer))


@builtin(f"PROC TPReadDnum(INOUT dnum TPAnswer, string TPText {_BREAKS})")
async def tp_read_dnum(task: TaskContext, **arguments: Any) -> None:
    """Ask for a number with all its digits."""
    await tp_read_num(task, **arguments)


@builtin(
    "PROC UIMsgBox(\\string Header, string MsgLine1 \\string MsgLine2 \\string MsgLine3 "
    "\\string MsgLine4 \\string MsgLine5 \\switch Wrap \\buttondata Buttons \\icondata Icon "
    f"\\string Image \\VAR btnres Result {_BREAKS})"
)
async def ui_msg_box(task: TaskContext, **arguments: Any) -> None:
    """Show a message; wait for a button unless there is none."""
    lines = [arguments["header"], *(arguments[f"msgline{k}"] for k in range(1, 6))]
    chosen = arguments["buttons"]
    buttons = _BUTTONS.get(0.0 if chosen is None else chosen, _BUTTONS[0.0])
    answer = await _button(task, [line for line in lines if line], buttons, arguments)
    if answer is not None and arguments["result"] is not None:
        arguments["result"].set(answer)


@builtin(
    "FUNC btnres UIMessageBox(\\string Header \\string Message | string MsgArray{*} \\switch Wrap "
    "\\buttondata Buttons | string BtnArray{*} \\btnres DefaultBtn \\icondata Icon \\string Image "
    f"{_BREAKS})"
)
async def ui_message_box(task: TaskContext, **arguments: Any) -> float:
    """Show a message and give the button, by name or by its number in an array."""
    lines = [arguments["header"], arguments["message"], *(arguments["msgarray"] or [])]
    own = arguments["btnarray"]
    if own is not None:
        buttons = tuple((text, float(k)) for k, text in enumerate(own, 1))
    else:
        chosen = arguments["buttons"]
        buttons = _BUTTONS.get(0.0 if chosen is None else chosen, _BUTTONS[0.0])
    answer = await _button(task, [line for line in lines if line], buttons, arguments)
    default = arguments["defaultbtn"]
    return answer if answer is not None else (0.0 if default is None else default)


@builtin(
    "FUNC num UINumEntry(\\string Header \\string Message | string MsgArray{*} \\switch Wrap "
    "\\icondata Icon \\num InitValue \\num MinValue \\num MaxValue \\switch AsInteger "
    f"{_BREAKS})"
)
async def ui_num_entry(task: TaskContext, **arguments: Any) -> float:
    """Ask for a number until it is in range."""
    lines = [arguments["header"], arguments["message"], *(arguments["msgarray"] or [])]
    question = "\n".join(line for line in lines if line)
    while True:
        answer = await _answered(task, task.host.pendant.ask_number(question), arguments)
        if answer is None:
            initial: float | None = arguments["initvalue"]
            return 0.0 if initial is None else initial
        low, high = arguments["minvalue"], arguments["maxvalue"]
        is_whole = not arguments["asinteger"] or answer == int(answer)
        if is_whole and (low is None or answer >= low) and (high is None or answer <= high):
            return float(answer)


async def _button(
    task: TaskContext,
    lines: Sequence[str],
    buttons: Sequence[tuple[str, float]],
    arguments: dict[str, Any],
) -> float | None:
    if not buttons:
        for line in lines:
            task.host.pendant.write(line)
        return 0.0
    keys = [text for text, _ in buttons]
    answer = await _answered(task, task.host.pendant.ask("\n".join(lines), keys), arguments)
    return None if answer is None else buttons[int(answer) - 1][1]


async def _answered(task: TaskContext, asking: Awaitable[R], arguments: dict[str, Any]) -> R | None:
    """The answer, or None when one of the breaks came first and there is a flag for it.

    ERR_TP_MAXTIME, ERR_TP_DIBREAK, ERR_TP_DOBREAK, ERR_TP_PERSBREAK without a flag.
    """
    jobs = {asyncio.ensure_future(asking): ""}
    for name, waiting in _breaks(arguments):
        jobs[asyncio.ensure_future(waiting)] = name
    try:
        done, _ = await asyncio.wait(jobs, return_when=asyncio.FIRST_COMPLETED)
        first = next(job for job in jobs if job in done)
        answer: Any = first.result()
    finally:
        for job in jobs:
            job.cancel()
    if not jobs[first]:
        return answer  # type: ignore[no-any-return]
    flag: Ref | None = arguments["breakflag"]
    if flag is None:
        raise RapidError(jobs[first], "the operator has not answered")
    flag.set(float(task_of(task).program.error_number(jobs[first])))
    return None


def _breaks(arguments: dict[str, Any]) -> list[tuple[str, Awaitable[Any]]]:
    found: list[tuple[str, Awaitable[Any]]] = []
    if arguments["maxtime"] is not None:
        found.append(("ERR_TP_MAXTIME", asyncio.sleep(max(0.0, arguments["maxtime"]))))
    for kind in ("di", "do"):
        signal: Signal | None = arguments[f"{kind}break"]
        if signal is not None:
            passive = 0.0 if arguments[f"{kind}passive"] is None else arguments[f"{kind}passive"]
            active = 0.0 if passive else 1.0
            found.append((f"ERR_TP_{kind.upper()}BREAK", _reaches(signal, active)))
    if arguments["persboolbreak"] is not None:
        found.append(("ERR_TP_PERSBREAK", _is_true(arguments["persboolbreak"])))
    return found


async def _reaches(signal: Signal, value: float) -> None:
    await until(signal, lambda now: now == value, max_time=None, flag=None, what="")


async def _is_true(flag: Any) -> None:
    changed = asyncio.Event()
    cancel = flag.root.watch(changed.set)
    try:
        while not flag.get():
            changed.clear()
            await changed.wait()
    finally:
        cancel()
