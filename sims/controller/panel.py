"""Watches the cabinet and keeps the controller's state and mode."""

from collections.abc import Callable

from hal import OperatingMode
from sims.controller.eventlog import ControllerLog
from sims.controller.state import MODES, OP_MODES, CtrlState, OpMode, StateEvent, after
from sims.rapid.host import EventKind
from sims.world.cabinet import Cabinet

__all__ = ["Panel"]

OPERATIONAL = 1
TITLES: dict[CtrlState, tuple[int, EventKind, str]] = {
    CtrlState.MOTOROFF: (10010, EventKind.STATE, "Motors OFF state"),
    CtrlState.MOTORON: (10011, EventKind.STATE, "Motors ON state"),
    CtrlState.GUARDSTOP: (10012, EventKind.ERROR, "Safety guard stop state"),
    CtrlState.EMERGENCYSTOP: (10013, EventKind.ERROR, "Emergency stop state"),
    CtrlState.EMERGENCYSTOPRESET: (10010, EventKind.STATE, "Emergency stop released"),
    CtrlState.SYSFAIL: (10014, EventKind.ERROR, "System failure state"),
}
REFUSALS: dict[CtrlState, str] = {
    CtrlState.INIT: "the controller is starting up",
    CtrlState.MOTOROFF: "the motors are off: switch them on",
    CtrlState.GUARDSTOP: "a guard is open: close it",
    CtrlState.EMERGENCYSTOP: "the emergency stop is pressed: release it, reset, motors on",
    CtrlState.EMERGENCYSTOPRESET: "the emergency stop is not reset: reset, then motors on",
    CtrlState.SYSFAIL: "system failure: restart the controller",
}
MODE_TITLES: dict[OpMode, tuple[int, str]] = {
    OpMode.MANR: (10015, "Manual mode selected"),
    OpMode.MANF: (10018, "Manual full speed mode selected"),
    OpMode.AUTO_CH: (10016, "Automatic mode requested"),
    OpMode.AUTO: (10017, "Automatic mode confirmed"),
}


class Panel:
    """``state`` and ``mode`` follow the cabinet at each ``poll``.

    ``state_changed`` and ``mode_changed`` are called after every change. Turning the key to
    automatic passes through AUTO_CH for one tick: the operator's confirmation.
    """

    def __init__(
        self,
        cabinet: Cabinet,
        log: ControllerLog,
        *,
        state_changed: Callable[[], None],
        mode_changed: Callable[[], None],
    ) -> None:
        self._cabinet = cabinet
        self._log = log
        self._state_changed = state_changed
        self._mode_changed = mode_changed
        self.state = CtrlState.INIT
        self.mode = OpMode.INIT
        self._seen: tuple[OperatingMode, bool, bool, bool] | None = None

    def power_on(self) -> None:
        """Come up: motors off, then whatever the cabinet says; automatic needs no confirmation."""
        self.state, self.mode, self._seen = CtrlState.INIT, OpMode.INIT, None
        self._fire(StateEvent.STARTED_UP)
        self._set_mode(MODES[self._cabinet.safety.mode])
        self.poll()

    def poll(self) -> None:
        """Take over what the cabinet says."""
        safety = self._cabinet.safety
        now = (safety.mode, safety.motors_on, safety.protective_stop, safety.emergency_stop)
        if now == self._seen:
            return
        wanted = MODES[safety.mode]
        if wanted is OpMode.AUTO and self.mode not in (OpMode.AUTO, OpMode.AUTO_CH):
            self._set_mode(OpMode.AUTO_CH)
            return
        self._seen = now
        if wanted is not self.mode:
            self._set_mode(wanted)
        while (event := self._due()) is not None:
            self._fire(event)

    def reset_emergency_stop(self) -> bool:
        """Acknowledge a released emergency stop; the motors stay off."""
        if self.state is not CtrlState.EMERGENCYSTOPRESET:
            return False
        self._fire(StateEvent.RESET)
        return True

    def fail(self) -> None:
        """A system failure: only a restart helps."""
        self._fire(StateEvent.FAILED)

    def refusal(self) -> str | None:
        """Why programs cannot be started in this state and mode; None: they can."""
        if self.state is not CtrlState.MOTORON:
            return REFUSALS[self.state]
        if self.mode not in OP_MODES:
            return "the mode change is not confirmed yet"
        return None

    def _due(self) -> StateEvent | None:
        """What the cabinet says that the state does not know yet."""
        safety = self._cabinet.safety
        if self.state is CtrlState.SYSFAIL:
            return None
        if safety.emergency_stop:
            return None if self.state is CtrlState.EMERGENCYSTOP else StateEvent.STOP_PRESSED
        if self.state is CtrlState.EMERGENCYSTOP:
            return StateEvent.STOP_RELEASED
        if self.state is CtrlState.EMERGENCYSTOPRESET:
            return StateEvent.RESET if safety.motors_on else None
        if safety.protective_stop:
            return None if self.state is CtrlState.GUARDSTOP else StateEvent.GUARD_OPENED
        if self.state is CtrlState.GUARDSTOP:
            return StateEvent.GUARD_CLOSED
        if safety.motors_on != (self.state is CtrlState.MOTORON):
            return StateEvent.MOTORS_ON if safety.motors_on else StateEvent.MOTORS_OFF
        return None

    def _fire(self, event: StateEvent) -> None:
        state = after(self.state, event)
        if state is None or state is self.state:
            return
        self.state = state
        number, kind, title = TITLES[state]
        self._log.write(kind, OPERATIONAL, number, title, [f"cause: {event}"])
        self._state_changed()

    def _set_mode(self, mode: OpMode) -> None:
        self.mode = mode
        number, title = MODE_TITLES[mode]
        self._log.write(EventKind.STATE, OPERATIONAL, number, title)
        self._mode_changed()
