"""The operator in words: typed commands for a controller, and all that the pendant shows."""

from collections.abc import Awaitable, Callable
from typing import Any

from hal import OperatingMode
from hal.errors import CellError
from sims.controller.controller import Controller
from sims.rapid.task import TaskError

__all__ = ["HELP", "Operator", "OperatorError", "describe"]

HELP = (
    "start, stop, pptomain, restart, auto, manr, manf, motors on|off, estop, release, reset, "
    "guard open|close, set SIGNAL VALUE, speed PERCENT, answer NUMBER"
)


class OperatorError(CellError):
    """A command that is not understood, or cannot be done now; says what can."""


class Operator:
    """Obeys one line at a time."""

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        c = controller
        self._plain: dict[str, Callable[[], Awaitable[None] | None]] = {
            "start": c.start,
            "stop": c.stop,
            "pptomain": c.pp_to_main,
            "restart": c.restart,
            "auto": lambda: c.set_mode(OperatingMode.AUTO),
            "manr": lambda: c.set_mode(OperatingMode.MANUAL_REDUCED),
            "manf": lambda: c.set_mode(OperatingMode.MANUAL_FULL),
            "motors on": c.motors_on,
            "motors off": c.motors_off,
            "estop": c.press_emergency_stop,
            "release": c.release_emergency_stop,
            "reset": c.reset_emergency_stop,
            "guard open": lambda: c.set_guard(True),
            "guard close": lambda: c.set_guard(False),
        }

    async def obey(self, line: str) -> None:
        """Do what a line says.

        Raises
        ------
        OperatorError
            The line is not understood or its values make no sense.
        CellError
            The controller refuses, with the reason.
        """
        words = line.lower().split()
        plain = self._plain.get(" ".join(words))
        if plain is not None:
            done = plain()
            if done is not None:
                await done
            self._controller.look()
            return
        try:
            self._with_values(words)
        except (ValueError, TaskError) as error:
            raise OperatorError(f"{line.strip()}: {error}") from error

    def _with_values(self, words: list[str]) -> None:
        match words:
            case ["set", name, value]:
                self._controller.set_input(name, float(value))
            case ["speed", percent]:
                self._controller.set_speed_ratio(float(percent) / 100)
            case ["answer", number]:
                self._controller.pendant.answer(float(number))
            case _:
                raise OperatorError(f"{' '.join(words)!r} is no command; there are: {HELP}")


def describe(controller: Controller) -> dict[str, Any]:
    """All that the pendant shows, as JSON has it; metres, radians, seconds."""
    unit = controller.unit
    joints = unit.measured_rad
    T = unit.kinematics.forward(joints) @ controller.mechanics.active.T_flange_tcp
    question = controller.pendant.question
    return {
        "state": str(controller.state),
        "mode": str(controller.mode),
        "is_running": controller.is_running,
        "has_failed": controller.has_failed,
        "speed_ratio": controller.speed_ratio,
        "robot": unit.arm.model,
        "joints_rad": [float(q) for q in joints],
        "tcp_m": [float(v) for v in T[:3, 3]],
        "is_moving": unit.is_driving,
        "moves_ahead": len(unit.moves),
        "tasks": {name: _task(task) for name, task in controller.system.tasks.items()},
        "signals": {signal.name: signal.value for signal in controller.signals.values()},
        "lines": list(controller.pendant.lines)[-50:],
        "question": None if question is None else question.text,
        "log": [
            {
                "stamp_s": round(entry.stamp_s, 6),
                "kind": str(entry.kind),
                "code": entry.code,
                "title": entry.title,
                "cause": list(entry.cause),
            }
            for entry in list(controller.log)[-200:]
        ],
    }


def _task(task: Any) -> dict[str, Any]:
    pointer = task.pointer
    return {
        "kind": str(task.kind),
        "state": str(task.state),
        "has_motion": task.has_motion,
        "pointer": None if pointer is None else str(pointer),
        "statements": task.statements,
    }
