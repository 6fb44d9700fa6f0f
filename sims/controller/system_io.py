"""System outputs tell the controller's state by signals; system inputs order it about."""

from collections.abc import Callable, Iterable, Mapping

from sims.controller.backup import SystemInput, SystemOutput
from sims.controller.signals import ControllerSignal
from sims.rapid.host import SignalKind

__all__ = ["SystemInputs", "SystemOutputs", "word_of"]

State = Callable[[str], bool]


def word_of(text: str) -> str:
    """``Motor On State`` and ``MotorOnState`` are the same."""
    return "".join(ch for ch in text.lower() if ch.isalnum())


class SystemOutputs:
    """Signals that follow states; ``states`` are functions of the first argument, by word.

    ``unknown`` names the outputs whose state is not known; they stay as they are.
    """

    def __init__(
        self,
        outputs: Iterable[SystemOutput],
        signals: Mapping[str, ControllerSignal],
        states: Mapping[str, State],
    ) -> None:
        self._bound: list[tuple[State, str, ControllerSignal]] = []
        self.unknown: list[str] = []
        for output in outputs:
            state = states.get(word_of(output.status))
            signal = signals.get(output.signal.lower())
            if state is None or signal is None or signal.kind is not SignalKind.DO:
                self.unknown.append(f"{output.status} -> {output.signal}")
                continue
            argument = output.arguments[0] if output.arguments else ""
            self._bound.append((state, argument, signal))
        self._levels = [-1] * len(self._bound)

    def poll(self) -> None:
        """Bring the signals up to date."""
        levels = self._levels
        for k, (state, argument, signal) in enumerate(self._bound):
            level = state(argument)
            if level != levels[k]:
                levels[k] = level
                signal.put(float(level))


class SystemInputs:
    """Rising signals call ``actions``, by word, with their first argument."""

    def __init__(
        self,
        inputs: Iterable[SystemInput],
        signals: Mapping[str, ControllerSignal],
        actions: Mapping[str, Callable[[str], None]],
    ) -> None:
        self.unknown: list[str] = []
        self._cancels: list[Callable[[], None]] = []
        for given in inputs:
            action = actions.get(word_of(given.action))
            signal = signals.get(given.signal.lower())
            if action is None or signal is None:
                self.unknown.append(f"{given.signal} -> {given.action}")
                continue
            argument = given.arguments[0] if given.arguments else ""
            self._cancels.append(signal.watch(_rising(action, argument)))

    def close(self) -> None:
        """Listen no more."""
        for cancel in self._cancels:
            cancel()
        self._cancels.clear()


def _rising(action: Callable[[str], None], argument: str) -> Callable[[float], None]:
    def changed(value: float) -> None:
        if value:
            action(argument)

    return changed
