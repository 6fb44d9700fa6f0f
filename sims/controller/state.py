"""The controller's state as a table; names as Robot Web Services has them."""

from enum import StrEnum

from hal import OperatingMode

__all__ = ["MODES", "OP_MODES", "TRANSITIONS", "CtrlState", "OpMode", "StateEvent", "after"]


class CtrlState(StrEnum):
    """``ctrlstate``."""

    INIT = "init"
    MOTOROFF = "motoroff"
    MOTORON = "motoron"
    GUARDSTOP = "guardstop"
    EMERGENCYSTOP = "emergencystop"
    EMERGENCYSTOPRESET = "emergencystopreset"
    SYSFAIL = "sysfail"


class StateEvent(StrEnum):
    """What changes it."""

    STARTED_UP = "started up"
    MOTORS_ON = "motors on"
    MOTORS_OFF = "motors off"
    GUARD_OPENED = "guard opened"
    GUARD_CLOSED = "guard closed"
    STOP_PRESSED = "emergency stop pressed"
    STOP_RELEASED = "emergency stop released"
    RESET = "emergency stop reset"
    FAILED = "system failure"


class OpMode(StrEnum):
    """``opmode``."""

    INIT = "INIT"
    AUTO_CH = "AUTO_CH"
    MANF_CH = "MANF_CH"
    MANR = "MANR"
    MANF = "MANF"
    AUTO = "AUTO"
    UNDEF = "UNDEF"


S, E = CtrlState, StateEvent

TRANSITIONS: dict[tuple[CtrlState, StateEvent], CtrlState] = {
    (S.INIT, E.STARTED_UP): S.MOTOROFF,
    (S.MOTOROFF, E.MOTORS_ON): S.MOTORON,
    (S.MOTOROFF, E.GUARD_OPENED): S.GUARDSTOP,
    (S.MOTORON, E.MOTORS_OFF): S.MOTOROFF,
    (S.MOTORON, E.GUARD_OPENED): S.GUARDSTOP,
    (S.GUARDSTOP, E.GUARD_CLOSED): S.MOTOROFF,
    (S.EMERGENCYSTOP, E.STOP_RELEASED): S.EMERGENCYSTOPRESET,
    (S.EMERGENCYSTOPRESET, E.RESET): S.MOTOROFF,
    **{
        (state, E.STOP_PRESSED): S.EMERGENCYSTOP
        for state in (S.MOTOROFF, S.MOTORON, S.GUARDSTOP, S.EMERGENCYSTOPRESET)
    },
    **{(state, E.FAILED): S.SYSFAIL for state in S},
}

MODES: dict[OperatingMode, OpMode] = {
    OperatingMode.AUTO: OpMode.AUTO,
    OperatingMode.MANUAL_REDUCED: OpMode.MANR,
    OperatingMode.MANUAL_FULL: OpMode.MANF,
}

# What OpMode() answers to a program.
OP_MODES: dict[OpMode, str] = {
    OpMode.AUTO: "OP_AUTO",
    OpMode.MANR: "OP_MAN_PROG",
    OpMode.MANF: "OP_MAN_TEST",
}


def after(state: CtrlState, event: StateEvent) -> CtrlState | None:
    """The state an event leads to; None where it changes nothing."""
    return TRANSITIONS.get((state, event))
