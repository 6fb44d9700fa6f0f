"""A simulated ABB robot controller: motion, state, signals, event log around RAPID tasks."""

from sims.controller.controller import Controller
from sims.controller.eventlog import ControllerLog, Entry
from sims.controller.execution import StartRefusedError
from sims.controller.package import package_setup
from sims.controller.setup import Setup, TaskSetup, arm_of, cell_signals, modules_of
from sims.controller.state import CtrlState, OpMode

__all__ = [
    "Controller",
    "ControllerLog",
    "CtrlState",
    "Entry",
    "OpMode",
    "Setup",
    "StartRefusedError",
    "TaskSetup",
    "arm_of",
    "cell_signals",
    "modules_of",
    "package_setup",
]
