"""What signals may tell of a controller, and order it to do."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from sims.controller.state import CtrlState, OpMode
from sims.rapid.task import TaskState

if TYPE_CHECKING:
    from sims.controller.controller import Controller

__all__ = ["actions_of", "states_of"]

STOPPED = (CtrlState.EMERGENCYSTOP, CtrlState.EMERGENCYSTOPRESET)


def states_of(controller: "Controller") -> dict[str, Callable[[str], bool]]:
    """System outputs by word; the argument names a task or a unit."""

    def motors_on(_: str) -> bool:
        return controller.state is CtrlState.MOTORON

    def motors_off(_: str) -> bool:
        return controller.state is not CtrlState.MOTORON

    def executes(task: str) -> bool:
        if not task:
            return controller.is_running
        found = controller.system.tasks.get(task) or controller.system.tasks.get(task.lower())
        return found is not None and found.state is TaskState.STARTED

    def run_chain_closed(_: str) -> bool:
        return controller.state not in (*STOPPED, CtrlState.GUARDSTOP, CtrlState.SYSFAIL)

    return {
        "motoron": motors_on,
        "motoronstate": motors_on,
        "motonstate": motors_on,
        "motoroff": motors_off,
        "motoroffstate": motors_off,
        "motoffstate": motors_off,
        "emstop": lambda _: controller.state in STOPPED,
        "emergencystop": lambda _: controller.state in STOPPED,
        "guardstop": lambda _: controller.state is CtrlState.GUARDSTOP,
        "securitystop": lambda _: controller.state is CtrlState.GUARDSTOP,
        "runchok": run_chain_closed,
        "runchainok": run_chain_closed,
        "autoon": lambda _: controller.mode is OpMode.AUTO,
        "cycleon": lambda _: controller.is_running,
        "taskexecuting": executes,
        "executionerror": lambda _: controller.has_failed,
        "error": lambda _: controller.has_failed,
        "motsupon": lambda _: controller.mechanics.settings.supervises,
        "motsuptrigg": lambda _: controller.has_collided,
        "mechunitnotmoving": lambda _: controller.unit.has_come_to_rest,
        "robotnotmoving": lambda _: controller.unit.has_come_to_rest,
        "mechunitactive": lambda _: True,
        "simmode": lambda _: True,
    }


def actions_of(controller: "Controller") -> dict[str, Callable[[str], None]]:
    """System inputs by word."""

    async def start_at_main() -> None:
        await controller.pp_to_main()
        await controller.start()

    async def motors_on_and_start() -> None:
        controller.motors_on()
        controller.look()
        await controller.start()

    return {
        "start": lambda _: controller.order(controller.start()),
        "startmain": lambda _: controller.order(start_at_main()),
        "startatmain": lambda _: controller.order(start_at_main()),
        "stop": lambda _: controller.order(controller.stop()),
        "softstop": lambda _: controller.order(controller.stop()),
        "quickstop": lambda _: controller.order(controller.stop()),
        "motoron": lambda _: controller.motors_on(),
        "motoronandstart": lambda _: controller.order(motors_on_and_start()),
        "motonstart": lambda _: controller.order(motors_on_and_start()),
        "motoroff": lambda _: controller.motors_off(),
        "ppmain": lambda _: controller.order(controller.pp_to_main()),
        "pptomain": lambda _: controller.order(controller.pp_to_main()),
        "resetestop": lambda _: controller.reset_emergency_stop(),
        "resetemergencystop": lambda _: controller.reset_emergency_stop(),
        "resetexecutionerror": lambda _: controller.reset_error(),
        "resetexecerror": lambda _: controller.reset_error(),
        "systemrestart": lambda _: controller.order(controller.restart()),
    }
