"""What to look at when the controller does not do as asked: one sentence for each code."""

from drivers.abb.messages import Code, ControllerState, Flag
from hal.errors import (
    CellError,
    CollisionError,
    FaultError,
    LinkError,
    PreemptedError,
    RejectedError,
    SafetyError,
    UnreachableError,
)

__all__ = ["connection_advice", "forbidden", "refusal"]

SENTENCES: dict[Code, str] = {
    Code.BAD_FRAME: "the controller could not read a frame; reopen the device",
    Code.BAD_LENGTH: "the controller expected another length; driver and RAPID modules must match",
    Code.UNKNOWN: "the controller does not know this request; update the RAPID modules",
    Code.BAD_VERSION: "the RAPID modules speak another version; load the ones of this release",
    Code.NOT_PAIRED: "the motion connection does not belong to the monitor's; reopen the device",
    Code.BUSY: "a motion is under way",
    Code.QUEUE_FULL: "the controller's queue is full; send fewer targets in one motion",
    Code.BAD_ARGUMENT: "a value is out of range",
    Code.OUT_OF_REACH: "the target is out of reach",
    Code.JOINT_LIMIT: "the target is beyond a joint's range",
    Code.SINGULARITY: "the path cannot be followed: a singularity, or no circle through its points",
    Code.CONFIGURATION: "the target cannot be reached in its configuration",
    Code.COLLISION: "motion supervision stopped the arm: it hit something, or its load is wrong",
    Code.OUTSIDE_BOX: "the target is outside the workspace box (BP_BOX_MIN, BP_BOX_MAX)",
    Code.TOO_FAST: "faster than the controller allows (BP_MAX_SPEED, BP_MAX_JOINT_SHARE)",
    Code.TOO_HEAVY: "heavier than the controller allows (BP_MAX_PAYLOAD)",
    Code.MOTORS_OFF: "the motors are off; switch them on at the cabinet and press Start",
    Code.NOT_IN_AUTO: "the key switch is not on AUTO; turn it, confirm, motors on, Start",
    Code.EMERGENCY_STOP: "the emergency stop is pressed; release it, reset, motors on, Start",
    Code.PROTECTIVE_STOP: "a protective stop is active; close the guard, motors on, Start",
    Code.PROGRAM_STOPPED: "the RAPID program does not run; program pointer to main, press Start",
    Code.STOP_ORDERED: "a stop was ordered",
    Code.CLIENT_SILENT: "the controller heard nothing from this client for too long",
    Code.CLIENT_GONE: "the controller lost this client's connection",
    Code.NO_SIGNAL: "the controller has no such signal",
    Code.TIMED_OUT: "it did not come in time",
    Code.INTERNAL: "an error in the RAPID program; look at the event log",
}

STOPS = (Code.EMERGENCY_STOP, Code.PROTECTIVE_STOP)
UNREACHABLE = (
    Code.OUT_OF_REACH,
    Code.JOINT_LIMIT,
    Code.SINGULARITY,
    Code.CONFIGURATION,
    Code.OUTSIDE_BOX,
)
NAMES = {
    Code.MOTORS_OFF: "motors off",
    Code.NOT_IN_AUTO: "not in auto",
    Code.PROGRAM_STOPPED: "program stopped",
}


def forbidden(state: ControllerState) -> Code:
    """Return what forbids motion now, by the state's flags; ``Code.NONE`` if nothing does."""
    flags = state.flags
    for is_so, code in (
        (Flag.EMERGENCY_STOP in flags, Code.EMERGENCY_STOP),
        (Flag.PROTECTIVE_STOP in flags, Code.PROTECTIVE_STOP),
        (Flag.AUTO not in flags, Code.NOT_IN_AUTO),
        (Flag.MOTORS_ON not in flags, Code.MOTORS_OFF),
        (Flag.EXECUTING not in flags, Code.PROGRAM_STOPPED),
    ):
        if is_so:
            return code
    return Code.NONE


def refusal(device: str, code: Code, *, at: int = 0) -> CellError:
    """Return the error that a code means; ``at`` is the target it was about, or 0."""
    where = f"target {at}: " if at else ""
    text = f"{where}{SENTENCES.get(code, 'refused')}"
    if code in STOPS:
        return SafetyError(f"{device}: {text}")
    if code in UNREACHABLE:
        return UnreachableError(f"{device}: {text}")
    if code is Code.COLLISION:
        return CollisionError(f"{device}: {text}")
    if code is Code.STOP_ORDERED:
        return PreemptedError(text, device=device)
    if code in (Code.CLIENT_SILENT, Code.CLIENT_GONE):
        return LinkError(text, device=device)
    if code is Code.INTERNAL:
        return FaultError(text, device=device, state="RAPID error")
    return RejectedError(text, device=device, code=NAMES.get(code, code.name.lower()))


def connection_advice(port: int, *, was_refused: bool) -> str:
    """Return what to check when a port does not answer, in the order of likelihood."""
    if was_refused:
        return (
            f"check: the RAPID program runs (AUTO, motors on, program pointer at main, Start); "
            f"no other client is connected; BP_ADDRESS and port {port} are right; option 616-1 "
            "PC Interface is installed"
        )
    return (
        f"check: the controller's IP address and cable; a firewall on port {port}; this "
        "computer's address is in BP_PEERS; option 616-1 PC Interface is installed"
    )
