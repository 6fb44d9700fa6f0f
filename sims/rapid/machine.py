"""The machine of one task: it carries out compiled operations, one after the other.

Nothing here waits. ``run`` goes on until its budget is used, an instruction waits, the program
ends or somebody halts it; ``sims.rapid.task`` waits for what is to be waited for.
"""

from collections.abc import Callable, Coroutine, Sequence
from enum import Enum, auto
from itertools import repeat
from operator import length_hint
from typing import Any

from sims.rapid.ast import RoutineKind
from sims.rapid.errors import RapidError
from sims.rapid.frames import Frame, FrameKind, Pointer, UserError, Wait
from sims.rapid.interrupts import Interrupts
from sims.rapid.late import late_builtin, late_routine
from sims.rapid.program import Program
from sims.rapid.recovery import find_handler
from sims.rapid.symbols import ModuleScope, Routine
from sims.rapid.types import Shape

__all__ = ["Halt", "Machine", "Outcome"]

MAX_DEPTH = 500
MAX_STACK_VALUES = 2_000_000
MAX_RETRIES = 4
MAX_UNDO_STEPS = 10_000
LOOK_UP = -1


class Outcome(Enum):
    """Why ``run`` came back."""

    BUDGET = auto()
    WAIT = auto()
    DONE = auto()
    HALTED = auto()


class Halt(Enum):
    """Why execution ended before its time."""

    STOP = auto()  # goes on where it was
    EXIT = auto()  # the pointer is lost
    EXIT_CYCLE = auto()  # on from main
    ERROR = auto()


class Machine:
    """Frames, interrupts and errors of one task.

    ``attention`` is looked at after every operation that may have caused something: an
    interrupt, a halt, the end. ``warn`` writes (number, message) to the event log.
    """

    def __init__(self, program: Program, warn: Callable[[int, str], None]) -> None:
        self.program = program
        self.frames: list[Frame] = []
        self.attention = False
        self.halt: Halt | None = None
        self.fault: RapidError | None = None
        self.interrupts = Interrupts(self._notice, self._queue_is_full)
        self.noticed: Callable[[], None] = lambda: None
        self._weight = 0
        self._is_done = False
        self._is_undoing = False
        self._warn = warn
        program.common["T"] = self

    # For the task.

    @property
    def frame(self) -> Frame:
        """The routine that is being executed."""
        return self.frames[-1]

    @property
    def pointer(self) -> Pointer | None:
        """Where the program stands; None: nowhere."""
        return self.frames[-1].pointer if self.frames else None

    def begin(self, routine: Routine) -> None:
        """Put a routine on the stack; ``run`` carries it out."""
        self._push(routine, [], FrameKind.BASE)

    def clear(self) -> None:
        """Leave everything, with the UNDO clauses, and forget the interrupts."""
        self._unwind(0, with_undo=True)
        self.interrupts.clear()
        self.halt = self.fault = None
        self.attention = self._is_done = False

    def leave_above(self, depth: int) -> None:
        """Leave what is left of a routine that was begun on top of ``depth`` others."""
        self._unwind(min(depth, len(self.frames)), with_undo=False)

    def request(self, halt: Halt) -> None:
        """Halt before the next operation."""
        self.halt = halt
        self._notice()

    def run(self, budget: int) -> tuple[Outcome, int]:
        """Carry out at most ``budget`` operations; return why it ended and how many they were."""
        left = budget
        while True:
            if self.attention:
                outcome = self._attend()
                if outcome is not None:
                    return outcome, budget - left
            if left <= 0:
                return Outcome.BUDGET, budget
            frame = self.frames[-1]
            if frame.wait is not None:
                return Outcome.WAIT, budget - left
            alone = frame.retried is not None and self._still_retries(frame)
            turns = repeat(None, 1 if alone else left)
            left -= length_hint(turns)
            steps, f, pc = frame.steps, frame.f, frame.pc
            try:
                for _ in turns:
                    pc = steps[pc](f)
                    if pc < 0:
                        break
                else:
                    frame.pc = pc
            except RapidError as error:
                frame.pc = pc
                self.recover(error)
            except ZeroDivisionError:
                frame.pc = pc
                self.recover(RapidError("ERR_DIVZERO", "division by zero"))
            left += length_hint(turns)

    def complete(self, frame: Frame) -> None:
        """The instruction that a frame waits for has ended: take its result."""
        wait, frame.wait = frame.wait, None
        assert wait is not None
        try:
            value = wait.result()
        except RapidError as error:
            self.recover(error)
            return
        frame.pc = frame.resume
        if frame.dest is not None:
            frame.f[frame.dest] = value

    # For compiled code. Each returns the operation to go on with, or LOOK_UP.

    def call(
        self, routine: Routine, arguments: list[Any], own: int, resume: int, dest: int | None
    ) -> int:
        """Call a routine of the program."""
        frame = self.frames[-1]
        frame.pc, frame.resume, frame.dest = own, resume, dest
        self._push(routine, arguments, FrameKind.CALL)
        return LOOK_UP

    def wait(
        self,
        call: Coroutine[Any, Any, Any],
        own: int,
        resume: int,
        dest: int | None,
        shape: Shape | None,
    ) -> int:
        """Wait for an instruction."""
        frame = self.frames[-1]
        frame.pc, frame.resume, frame.dest = own, resume, dest
        frame.wait = Wait(call, shape)
        return LOOK_UP

    def pause(self, resume: int) -> int:
        """Look up, and go on with ``resume``."""
        self.frames[-1].pc = resume
        return LOOK_UP

    def late(
        self, name: str, arguments: Sequence[Any], module: ModuleScope, own: int, resume: int
    ) -> int:
        """Call what has this name by now. ERR_REFUNKPRC."""
        routine = module.find_routine(name.lower())
        if routine is None or routine.decl.kind is not RoutineKind.PROC:
            raise RapidError("ERR_REFUNKPRC", f"there is no procedure {name}: load its module")
        at = self.frames[-1].code.places[own]
        if isinstance(routine, Routine):
            return self.call(routine, late_routine(routine, arguments, at), own, resume, None)
        keywords = late_builtin(routine, arguments, at)
        result = routine.builtin.call(self.program.common["C"], **keywords)
        return (
            self.wait(result, own, resume, None, None) if routine.is_async else self.pause(resume)
        )

    def leave(self, value: Any = None) -> int:
        """Return from a routine."""
        frame = self._pop()
        if frame.kind is FrameKind.CALL:
            below = self.frames[-1]
            below.pc = below.resume
            if below.dest is not None:
                below.f[below.dest] = value
        elif frame.kind is FrameKind.TRAP:
            self.interrupts.end_trap()
        else:
            self._is_done = True
            self.attention = True
        return LOOK_UP

    def no_value(self) -> int:
        """A function ends without RETURN."""
        name = self.frames[-1].routine.name
        raise RapidError(
            "no RETURN", f"the function {name} ended without a value", is_fatal=True, number=40_023
        )

    def missing(self, message: str) -> int:
        """A function that is not there is called. ERR_REFUNKPRC."""
        raise RapidError("ERR_REFUNKPRC", message)

    def unfinished(self, text: str) -> int:
        """A placeholder is reached."""
        raise RapidError(
            "placeholder",
            f"{text} is not filled in: complete the program",
            is_fatal=True,
            number=40_025,
        )

    def throw(self, number: float | None) -> int:
        """``RAISE``."""
        frame = self.frames[-1]
        if number is not None:
            raise UserError(int(number), self.program.error_name(int(number)))
        if frame.error is None:
            raise RapidError(
                "RAISE", "without a number it is for error handlers", is_fatal=True, number=40_026
            )
        raise frame.error

    def retry(self) -> int:
        """``RETRY``: the failed statement again, from its start. ERR_EXCRTYMAX."""
        frame = self._handling("RETRY")
        start = frame.code.starts[frame.failed]
        frame.retries = frame.retries + 1 if frame.retried == start else 1
        if frame.retries > MAX_RETRIES:
            frame.retries = 0
            raise RapidError(
                "ERR_EXCRTYMAX",
                f"RETRY was tried {MAX_RETRIES} times: use ResetRetryCount for more",
            )
        frame.retried, frame.error = start, None
        frame.pc = start
        return LOOK_UP

    def try_next(self) -> int:
        """``TRYNEXT``: on behind the failed statement."""
        frame = self._handling("TRYNEXT")
        frame.error = None
        return frame.code.afters[frame.failed]

    def exit(self) -> int:
        """``EXIT``."""
        self.request(Halt.EXIT)
        return LOOK_UP

    def reset_retries(self) -> None:
        """``ResetRetryCount``."""
        self.frames[-1].retries = 0

    @property
    def remaining_retries(self) -> int:
        """How often RETRY can be tried in the running handler."""
        return max(0, MAX_RETRIES - self.frames[-1].retries)

    # Errors.

    def recover(self, error: RapidError) -> None:
        """Find the handler of an error and go there; without one, execution ends."""
        number = self.errno(error)
        errno = self.program.find_cell("ERRNO")
        assert errno is not None
        errno.value = float(number)
        found = None if error.is_fatal else find_handler(self.frames, number)
        if found is None:
            self.fault = error
            self.request(Halt.ERROR)
            return
        self._unwind(found.depth + 1, with_undo=found.is_long_jump)
        frame = self.frames[-1]
        frame.drop_wait()
        frame.error, frame.failed, frame.pc = error, frame.pc, found.target

    def errno(self, error: RapidError) -> int:
        """The number of an error."""
        if isinstance(error, UserError):
            return error.errno
        return self.program.error_number(error.name)

    def _handling(self, word: str) -> Frame:
        frame = self.frames[-1]
        if frame.error is None:
            raise RapidError(word, "is for error handlers", is_fatal=True, number=40_026)
        return frame

    def _still_retries(self, frame: Frame) -> bool:
        if frame.error is not None:
            return False
        if frame.code.starts[frame.pc] != frame.retried:
            frame.retried, frame.retries = None, 0
            return False
        return True

    # The stack.

    def _push(self, routine: Routine, arguments: list[Any], kind: FrameKind) -> None:
        if len(self.frames) >= MAX_DEPTH or self._weight > MAX_STACK_VALUES:
            raise RapidError(
                "stack",
                f"{routine.name} is called too deeply ({len(self.frames)} routines)",
                is_fatal=True,
                number=40_027,
            )
        self._weight += routine.code.weight
        self.frames.append(Frame(routine, arguments, kind))

    def _pop(self) -> Frame:
        frame = self.frames.pop()
        self._weight -= frame.code.weight
        frame.drop_wait()
        return frame

    def _unwind(self, depth: int, *, with_undo: bool) -> None:
        """Leave the frames above a depth."""
        while len(self.frames) > depth:
            if with_undo and self.frames[-1].code.undo is not None:
                self._undo()
            frame = self._pop()
            if frame.kind is FrameKind.TRAP:
                self.interrupts.end_trap()

    def _undo(self) -> None:
        """Carry out the UNDO clause of the last frame; it may not wait."""
        left = self.frames[-1]
        assert left.code.undo is not None
        left.drop_wait()
        frame = Frame(left.routine, left.f, FrameKind.UNDO)
        frame.pc = left.code.undo
        floor = len(self.frames)
        kept = (self.attention, self.halt, self.fault)
        self.attention, self.halt, self._is_undoing = False, None, True
        self.frames.append(frame)
        self._weight += left.code.weight
        outcome, _ = self.run(MAX_UNDO_STEPS)
        if outcome is not Outcome.DONE:
            self._warn(40_028, f"UNDO of {left.routine.name} did not end: it may not wait")
        while len(self.frames) > floor:
            self._pop()
        self._is_undoing = self._is_done = False
        self.attention, self.halt, self.fault = kept

    # Attention.

    def _attend(self) -> Outcome | None:
        self.attention = False
        if self._is_done:
            self._is_done = False
            self.attention = self.halt is not None or self.interrupts.is_due
            return Outcome.DONE
        if self.halt is not None:
            if self.halt in {Halt.EXIT, Halt.EXIT_CYCLE} and not self._is_undoing:
                halt = self.halt
                self._unwind(0, with_undo=True)
                self.interrupts.clear()
                self.halt = halt
            return Outcome.HALTED
        if self.interrupts.is_due and not self._is_undoing:
            interrupt = self.interrupts.take()
            number = self.program.find_cell("INTNO")
            assert number is not None
            number.value = float(interrupt.number)
            self._push(interrupt.trap, [], FrameKind.TRAP)
        return None

    def _notice(self) -> None:
        self.attention = True
        self.noticed()

    def _queue_is_full(self, number: int) -> None:
        self._warn(40_029, f"interrupt {number} is lost: too many wait to be served")
