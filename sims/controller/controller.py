"""The simulated controller: RAPID tasks, one arm, signals, state, event log, pendant."""

import asyncio
from collections.abc import Coroutine, Iterable, Mapping
from typing import Any, Self

import numpy as np

from hal import Load, OperatingMode
from hal.errors import CellError
from sims.controller import instructions
from sims.controller.backup import Event
from sims.controller.bindings import actions_of, states_of
from sims.controller.cfg import lookup
from sims.controller.confdata import wide
from sims.controller.eventlog import ControllerLog
from sims.controller.execution import Execution, StartRefusedError
from sims.controller.instructions.common import STOP_MOVE, STOP_MOVE_OTHER, Mechanics
from sims.controller.panel import Panel
from sims.controller.pendant import TeachPendant
from sims.controller.settings import MotionSettings
from sims.controller.setup import Setup
from sims.controller.signals import SignalBoard
from sims.controller.state import OP_MODES, CtrlState, OpMode
from sims.controller.supervision import Supervision
from sims.controller.system_io import SystemInputs, SystemOutputs
from sims.controller.unit import MechanicalUnit
from sims.rapid.errors import RapidError
from sims.rapid.host import EventKind, Network
from sims.rapid.system import Kept, RapidSystem
from sims.world import World

__all__ = ["Controller"]

MANUAL_REDUCED_MPS = 0.25
MOTION = 5
STATE_HOLD = "no motors"


class Controller:
    """A controller in front of a world's arm and cabinet; also the host of its programs.

    ``power_on`` and ``power_off``, or ``async with``, on the loop that drives the world.
    """

    def __init__(self, world: World, setup: Setup, network: Network) -> None:
        instructions.register()
        self.world = world
        self.setup = setup
        self.network = network
        self.log = ControllerLog()
        self.pendant = TeachPendant()
        self.home = setup.home
        self.epoch_s = setup.epoch_s
        self.statement_ns = setup.statement_ns
        arm = setup.arm or world.arm_model
        self.info: Mapping[str, str] = setup.info_of(arm)
        self._panel = Panel(
            world.cabinet,
            self.log,
            state_changed=self._state_changed,
            mode_changed=self._mode_changed,
        )
        self._arm = arm
        self._supervision = Supervision(world, arm)
        self._is_on = False
        self._watch: asyncio.Future[None] | None = None
        self._jobs: set[asyncio.Task[None]] = set()
        self._kept: Kept = {}
        self._build()

    def _build(self) -> None:
        """Everything that a restart makes anew."""
        unit = MechanicalUnit(self.world, self._arm, failed_corner=self._note_corner)
        self.mechanics = Mechanics(unit, wide(self._arm), set_load=self._set_load)
        self.board = SignalBoard(self.setup.signals, self.world.cabinet, self.setup.crosses)
        self.signals = self.board.by_name
        self.system = RapidSystem(self)
        self._execution = Execution(self.system, unit, self.log, self.setup.event_routines)
        self._outputs = SystemOutputs(self.setup.system_outputs, self.signals, states_of(self))
        self._inputs: SystemInputs | None = None
        self.has_collided = False

    # What it says.

    @property
    def unit(self) -> MechanicalUnit:
        """The arm."""
        return self.mechanics.unit

    @property
    def state(self) -> CtrlState:
        """``ctrlstate``."""
        return self._panel.state

    @property
    def mode(self) -> OpMode:
        """``opmode``."""
        return self._panel.mode

    @property
    def is_running(self) -> bool:
        """Whether NORMAL tasks execute: ``ctrlexecstate``."""
        return self._execution.is_running

    @property
    def has_failed(self) -> bool:
        """Whether a program stopped with an error."""
        return self._execution.has_failed

    @property
    def speed_ratio(self) -> float:
        """The operator's, 0 to 1."""
        return self.mechanics.operator_share

    @property
    def op_mode(self) -> str:
        """As programs see the mode."""
        return OP_MODES.get(self.mode, "OP_UNDEF")

    @property
    def run_mode(self) -> str:
        """As programs see the way they run."""
        return "RUN_CONT_CYCLE" if self.is_running else "RUN_UNDEF"

    def cfg(self, path: str, attribute: str) -> str | float | bool:
        """Read a configuration value. Raises ``KeyError``."""
        value = lookup(self.setup.cfgs, path, attribute)
        if isinstance(value, tuple):
            raise KeyError(f"{path} {attribute} has several values")
        return value

    # Life.

    async def power_on(self) -> None:
        """Load the programs, set them to main, start those in the background.

        Raises
        ------
        RapidLoadError
            The modules were refused; the controller stays off.
        """
        if self._is_on:
            return
        for task in self.setup.tasks:
            self.system.add_task(
                task.name,
                kind=task.kind,
                has_motion=task.has_motion,
                modules=task.modules,
                entry=task.entry,
                overrides=self.setup.overrides_of(task),
            )
        for warning in self.system.load():
            self.log.write(EventKind.WARNING, 4, 225, "Load warning", [str(warning)])
        self.system.restore(self._kept)
        for loaded in self.system.tasks.values():
            loaded.settled = self._in_position if loaded.has_motion else None
        self._is_on = True
        self._panel.power_on()
        self._inputs = SystemInputs(self.setup.system_inputs, self.signals, actions_of(self))
        self._note_unknown(self._outputs.unknown, "system output")
        self._note_unknown(self._inputs.unknown, "system input")
        self._watch = self.world.until(self._is_over)
        await self._execution.power_on()

    async def power_off(self) -> None:
        """End all tasks and close their sockets; the arm brakes."""
        if not self._is_on:
            return
        self._is_on = False
        if self._watch is not None:
            self._watch.cancel()
        if self._inputs is not None:
            self._inputs.close()
        self._execution.stop("power off")
        self.unit.drop()
        await self.system.close()
        # A restart may have been ordered by a signal: then it is one of the jobs itself.
        others = self._jobs - {asyncio.current_task()}
        for job in others:
            job.cancel()
        await asyncio.gather(*others, return_exceptions=True)

    async def restart(self) -> None:
        """Warm start: everything is loaded anew, sockets are closed, nothing runs by itself.

        Persistents keep their values.
        """
        kept = self.system.persistents()
        await self.power_off()
        self._build()
        self._kept = kept
        await self.power_on()

    async def _in_position(self) -> None:
        """Until the arm stands at the end of its path."""
        if self.unit.moves:
            await self.unit.ended(self.unit.moves[-1])
        await self.unit.standing()

    async def __aenter__(self) -> Self:
        await self.power_on()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.power_off()

    # The operator.

    def refusal(self) -> str | None:
        """Why the programs cannot be started now; None: they can."""
        if not self._is_on:
            return "the controller is off"
        if not self._execution.normal_tasks:
            return "there is no NORMAL task"
        return self._panel.refusal()

    async def start(self) -> None:
        """Run the NORMAL tasks from where they stand.

        Raises
        ------
        StartRefusedError
            The state does not allow it.
        """
        why = self.refusal()
        if why is not None:
            self.log.write(EventKind.ERROR, 1, 20010, "Start refused", [why])
            raise StartRefusedError(f"the programs were not started: {why}")
        await self._execution.start()

    async def stop(self) -> None:
        """Hold the NORMAL tasks; the arm brakes on its path and keeps it."""
        if self._execution.stop("stopped by the operator"):
            await self._execution.stopped(Event.STOP)

    async def pp_to_main(self) -> None:
        """Set the program pointers to main; motion settings go back to normal.

        Raises
        ------
        StartRefusedError
            The programs run.
        """
        if self.is_running:
            raise StartRefusedError("the program pointer cannot be moved while programs run: stop")
        self.mechanics.settings = MotionSettings()
        self.mechanics.refresh(1.0)
        for hold in (STOP_MOVE, STOP_MOVE_OTHER):
            self.unit.release(hold)
        await self._execution.pp_to_main()

    def motors_on(self) -> None:
        """Press the button on the cabinet; it also resets a released emergency stop."""
        self.world.cabinet.switch_motors(True)

    def motors_off(self) -> None:
        """Switch the motors off."""
        self.world.cabinet.switch_motors(False)

    def press_emergency_stop(self) -> None:
        """Press the button."""
        self.world.cabinet.press_emergency_stop()

    def release_emergency_stop(self) -> None:
        """Pull the button out."""
        self.world.cabinet.release_emergency_stop()

    def reset_emergency_stop(self) -> None:
        """Acknowledge a released emergency stop; the motors stay off."""
        self._panel.poll()
        self._panel.reset_emergency_stop()

    def set_guard(self, is_open: bool) -> None:
        """Open or close the guard."""
        self.world.cabinet.safety.protective_stop = is_open

    def set_mode(self, mode: OperatingMode) -> None:
        """Turn the key."""
        self.world.cabinet.safety.mode = mode

    def set_speed_ratio(self, share: float) -> None:
        """Scale all speeds, 0 to 1; 0 holds the arm.

        Raises
        ------
        ValueError
            Outside 0 to 1.
        """
        if not 0 <= share <= 1:
            raise ValueError(f"the speed ratio is 0 to 100 %, not {share * 100:g} %")
        self.mechanics.set_operator_share(share)
        self.log.write(EventKind.STATE, 1, 10140, "Speed adjusted", [f"{share * 100:g} %"])

    def set_input(self, name: str, value: float) -> None:
        """Bring an input to a value. Raises ``ValueError``."""
        self.board.set_input(name, value)

    def reset_error(self) -> None:
        """Take the execution error and the collision back."""
        self._execution.has_failed = False
        self.has_collided = False

    def look(self) -> None:
        """Take over at once what was done at the cabinet, without waiting for the next tick."""
        self._panel.poll()

    # Each tick.

    def _is_over(self) -> bool:
        """Look at everything once a tick; whether the controller was switched off."""
        if not self._is_on:
            return True
        self._panel.poll()
        self.board.poll()
        self.unit.tick()
        if self.unit.is_driving:
            self._supervise()
        self._execution.poll()
        self._outputs.poll()
        return False

    def _supervise(self) -> None:
        settings = self.mechanics.settings
        if not settings.supervises:
            return
        axis = self._supervision.collided_axis(settings.supervision_share)
        if axis is not None:
            self.collide(axis)

    def collide(self, axis: int = 1) -> None:
        """Motion supervision: an axis is held back; the arm brakes and forgets its path."""
        self.has_collided = True
        cause = f"axis {axis} of {self.unit.name} is held back: the arm has run into something"
        self.log.write(EventKind.ERROR, MOTION, 50204, "Motion supervision", [cause])
        self.unit.fail(RapidError("ERR_MOTIONSUP", cause, number=50204))

    def _state_changed(self) -> None:
        if self.state is CtrlState.MOTORON:
            self.unit.release(STATE_HOLD)
            return
        self.unit.hold(STATE_HOLD)
        if self._execution.stop(f"controller state {self.state}"):
            self.order(self._execution.stopped(Event.QSTOP))

    def _mode_changed(self) -> None:
        self.unit.most_mps = MANUAL_REDUCED_MPS if self.mode is OpMode.MANR else np.inf
        if self._execution.stop(f"mode changed to {self.mode}"):
            self.order(self._execution.stopped(Event.STOP))

    def _note_corner(self) -> None:
        if not self.mechanics.settings.warns_of_corners:
            return
        self.log.write(
            EventKind.WARNING,
            MOTION,
            50024,
            "Corner path failure",
            ["the next move came too late: the arm stopped at the corner"],
        )

    def _note_unknown(self, names: Iterable[str], what: str) -> None:
        for name in names:
            self.log.write(EventKind.WARNING, 7, 71001, f"{what} not supported", [name])

    def _set_load(self, load: Load) -> None:
        self.world.arm.set_load(load)

    def order(self, job: Coroutine[Any, Any, None]) -> None:
        """Do something in this loop; what it refuses goes to the event log."""
        task = asyncio.get_running_loop().create_task(job)
        self._jobs.add(task)
        task.add_done_callback(self._has_ended)

    def _has_ended(self, job: "asyncio.Task[None]") -> None:
        """What is ordered by a signal has nobody to raise at."""
        self._jobs.discard(job)
        error = None if job.cancelled() else job.exception()
        if isinstance(error, CellError):
            self.log.write(EventKind.ERROR, 1, 20010, "Order refused", [str(error)])
        elif error is not None:
            raise error
