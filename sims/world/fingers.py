"""The stepper gripper's own controller: encoder, set-point ramp, stall, hold.

It knows its encoder and its motor current, and nothing else of the world.
"""

import copy
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from hal import GripperLimits
from sims.world.settings import Physics

__all__ = ["FingerAxis", "Phase", "Window"]

COUNT_M = 1e-5
ACCELERATION_MPS2 = 1.0
STALL_SHARE = 0.9
STALL_SPEED_MPS = 1.5e-3
STALL_S = 0.010
REACHED_S = 0.010
LATCH_S = 0.150
SPEED_FILTER_S = 0.004
LOST_M = 5e-4
EMPTY_M = 5e-5
COMPLIANCE_N_PER_M = 2.85e5  # pads, contact and axis together: see decision 0002
HOMING_SPEED_MPS = 0.025
HOMING_FORCE_N = 70.0
HOMING_TOLERANCE_M = 1e-3
OVERDRIVE = 1.2


class Phase(StrEnum):
    """What the axis is doing."""

    IDLE = "idle"
    MOVING = "moving"
    CLOSING = "closing"
    LATCHING = "latching"
    HOLDING = "holding"
    WRONG = "wrong part"
    EMPTY = "no part"
    LOST = "part lost"
    STOPPED = "stopped"
    HOMING_OUT = "homing out"
    HOMING_IN = "homing in"
    FAULT = "fault"


BUSY = {Phase.MOVING, Phase.CLOSING, Phase.LATCHING, Phase.HOMING_OUT, Phase.HOMING_IN}
GRIPPING = {Phase.CLOSING, Phase.LATCHING, Phase.HOLDING, Phase.WRONG}


@dataclass(frozen=True)
class Window:
    """The sizes that count as the expected part."""

    least_m: float
    most_m: float

    def holds(self, size_m: float) -> bool:
        """Whether this size is inside."""
        return self.least_m <= size_m <= self.most_m


@dataclass
class _State:
    phase: Phase = Phase.IDLE
    setpoint_m: float = 0.0
    speed_mps: float = 0.0
    target_m: float = 0.0
    top_speed_mps: float = 0.05
    force_n: float = 80.0
    window: Window | None = None
    encoder_m: float = 0.0
    filtered_mps: float = 0.0
    quiet_ticks: int = 0
    phase_ticks: int = 0
    size_m: float | None = None
    gripped_m: float = 0.0  # the encoder when the part was gripped
    is_blocked: bool = False
    is_homed: bool = False
    zero_m: float = 2e-4  # where the encoder believes closed to be, before homing
    outer_m: float = 0.0
    stroke_m: float = 0.0
    correction_m: float = 0.0
    fault: str = ""
    command: int = 0


class FingerAxis:
    """Both fingers as one axis; widths are between the pads."""

    def __init__(self, model: Any, data: Any, physics: Physics) -> None:
        self.limits = GripperLimits()
        self._model, self._data = model, data
        self._tick_s = physics.tick_s
        self._gain = physics.fingers.gain
        self._joints = [model.joint(name).id for name in ("finger_left", "finger_right")]
        self._qpos = [model.jnt_qposadr[joint] for joint in self._joints]
        self._dof = [model.jnt_dofadr[joint] for joint in self._joints]
        actuator = model.actuator("fingers").id
        first = int(model.actuator_ctrladr[actuator])
        self._ctrl = data.ctrl[first : first + 1]
        self._force_range = model.actuator_forcerange[actuator]
        self._slides = data.qpos
        self._s = _State()
        self.jump_to(self.limits.stroke_m)

    # What the controller can be told.

    def jump_to(self, width_m: float) -> None:
        """Put the fingers somewhere at once; for setting a scene, not for a device."""
        for qpos, dof in zip(self._qpos, self._dof, strict=True):
            self._data.qpos[qpos] = width_m / 2
            self._data.qvel[dof] = 0.0
        self._read()
        self._s.setpoint_m = self._s.target_m = self._s.encoder_m
        self._s.filtered_mps = 0.0

    def block(self, width_m: float) -> None:
        """Put a hard stop at this width, on the side the fingers are not; a fault."""
        is_wider = self.true_width_m >= width_m
        column = 0 if is_wider else 1
        self._model.jnt_range[self._joints, column] = width_m / 2

    def unblock(self) -> None:
        """Take the stop away."""
        self._model.jnt_range[self._joints] = (0.0, self.limits.stroke_m / 2)

    def move(self, width_m: float, *, speed_mps: float, force_n: float) -> None:
        """Go to a width; something in the way stops the fingers."""
        self._begin(Phase.MOVING, width_m, speed_mps, force_n)

    def close(self, *, window: Window | None, speed_mps: float, force_n: float) -> None:
        """Close until something stalls the fingers, then hold it with force."""
        self._begin(Phase.CLOSING, -1e-3, speed_mps, force_n)
        self._s.window = window

    def home(self) -> None:
        """Find the outer stop, then the inner one, which is zero."""
        self._s.is_homed = False
        self._s.fault = ""
        self._begin(Phase.HOMING_OUT, 1.0, HOMING_SPEED_MPS, HOMING_FORCE_N)

    def halt(self) -> None:
        """Stop where the fingers are; a held part stays held."""
        self._s.command += 1
        if self.is_holding:
            return
        if self._s.phase is Phase.LATCHING:
            self._latch()
            return
        self._rest(Phase.STOPPED)

    def clear_fault(self) -> bool:
        """Acknowledge; whether that was enough."""
        if self._s.phase is Phase.FAULT:
            self._s.fault = ""
            self._rest(Phase.IDLE)
        return self._s.phase is not Phase.FAULT

    # What the controller can say.

    @property
    def phase(self) -> Phase:
        """What the axis is doing."""
        return self._s.phase

    @property
    def command(self) -> int:
        """Counts commands: a device sees by it that a newer one came."""
        return self._s.command

    @property
    def is_busy(self) -> bool:
        """Whether a command is under way."""
        return self._s.phase in BUSY

    @property
    def is_gripping(self) -> bool:
        """Whether the motor pushes the fingers together on purpose."""
        return self._s.phase in GRIPPING

    @property
    def is_holding(self) -> bool:
        """Whether something is held with force."""
        return self._s.phase in {Phase.HOLDING, Phase.WRONG}

    @property
    def is_homed(self) -> bool:
        """Whether the encoder's zero is known."""
        return self._s.is_homed

    @property
    def width_m(self) -> float:
        """The encoder, quantised."""
        return self._s.encoder_m

    @property
    def force_n(self) -> float:
        """Force per finger from the motor current, positive when closing."""
        lag_n = self._gain * (self._s.encoder_m - self._s.setpoint_m)
        return round(min(max(lag_n, -self._s.force_n), self._s.force_n), 1)

    @property
    def size_m(self) -> float | None:
        """The size of what is held, latched when it was gripped."""
        return self._s.size_m

    @property
    def is_blocked(self) -> bool:
        """Whether the last move ended before its width."""
        return self._s.is_blocked

    @property
    def fault(self) -> str:
        """What is wrong; empty if nothing."""
        return self._s.fault

    @property
    def homing(self) -> tuple[float, float]:
        """Stroke and zero correction of the last homing, metres."""
        return self._s.stroke_m, self._s.correction_m

    @property
    def true_width_m(self) -> float:
        """The distance of the pads, which the controller does not know to the micrometre."""
        left, right = self._qpos
        return float(self._slides[left]) + float(self._slides[right])

    # One tick.

    def apply(self) -> None:
        """Read the encoder, decide, write the controls of the tick that begins now."""
        self._read()
        s = self._s
        s.phase_ticks += 1
        if s.phase in BUSY and s.phase is not Phase.LATCHING:
            self._ramp()
            self._watch_motion()
        elif s.phase is Phase.LATCHING:
            self._press()
            if s.phase_ticks * self._tick_s >= LATCH_S:
                self._latch()
        elif self.is_holding:
            self._press()
            if s.encoder_m < s.gripped_m - LOST_M:
                self._rest(Phase.LOST)
        self._ctrl[0] = s.setpoint_m + s.zero_m
        self._force_range[:] = (-s.force_n, s.force_n)

    def save(self) -> _State:
        """Everything the next tick depends on."""
        return copy.copy(self._s)

    def restore(self, saved: _State) -> None:
        """Go on from ``save``."""
        self._s = copy.copy(saved)

    def _begin(self, phase: Phase, target_m: float, speed_mps: float, force_n: float) -> None:
        s = self._s
        s.command += 1
        s.target_m, s.top_speed_mps, s.force_n = target_m, speed_mps, force_n
        s.size_m, s.window, s.is_blocked = None, None, False
        if not self.is_busy:
            s.speed_mps = 0.0
            s.setpoint_m = s.encoder_m
        self._enter(phase)

    def _enter(self, phase: Phase) -> None:
        self._s.phase = phase
        self._s.phase_ticks = self._s.quiet_ticks = 0

    def _rest(self, phase: Phase) -> None:
        self._s.setpoint_m = self._s.encoder_m
        self._s.speed_mps = 0.0
        self._enter(phase)

    def _read(self) -> None:
        width_m = self.true_width_m - self._s.zero_m
        encoder_m = round(width_m / COUNT_M) * COUNT_M
        step_mps = (encoder_m - self._s.encoder_m) / self._tick_s
        share = self._tick_s / (self._tick_s + SPEED_FILTER_S)
        self._s.filtered_mps += share * (step_mps - self._s.filtered_mps)
        self._s.encoder_m = encoder_m

    def _pull_out_n(self) -> float:
        return self._s.force_n * max(0.3, 1 - 0.5 * abs(self._s.speed_mps) / 0.050)

    def _ramp(self) -> None:
        """Move the set-point towards the target, never further ahead than the force allows."""
        s = self._s
        away_m = s.target_m - s.setpoint_m
        braking = (2 * ACCELERATION_MPS2 * abs(away_m)) ** 0.5
        wanted = min(abs(s.speed_mps) + ACCELERATION_MPS2 * self._tick_s, s.top_speed_mps, braking)
        step_m = min(wanted * self._tick_s, abs(away_m))
        s.speed_mps = wanted if step_m < abs(away_m) else 0.0
        s.setpoint_m += step_m if away_m > 0 else -step_m
        reach_m = self._pull_out_n() / self._gain + 2 * COUNT_M
        s.setpoint_m = min(max(s.setpoint_m, s.encoder_m - reach_m), s.encoder_m + reach_m)

    def _press(self) -> None:
        """Saturate the motor at the set force."""
        self._s.setpoint_m = self._s.encoder_m - OVERDRIVE * self._s.force_n / self._gain

    def _watch_motion(self) -> None:
        s = self._s
        lag_m = s.setpoint_m - s.encoder_m
        is_slow = abs(s.filtered_mps) < STALL_SPEED_MPS
        is_pushing = abs(lag_m) >= STALL_SHARE * self._pull_out_n() / self._gain
        is_there = s.setpoint_m == s.target_m and abs(lag_m) <= 2 * COUNT_M and is_slow
        s.quiet_ticks = s.quiet_ticks + 1 if (is_slow and is_pushing) or is_there else 0
        if is_there and s.quiet_ticks * self._tick_s >= REACHED_S:
            s.speed_mps = 0.0
            self._enter(Phase.IDLE)
        elif s.quiet_ticks * self._tick_s >= STALL_S:
            self._stalled()

    def _stalled(self) -> None:
        s = self._s
        match s.phase:
            case Phase.CLOSING:
                if s.encoder_m > EMPTY_M:
                    self._enter(Phase.LATCHING)
                else:
                    s.size_m = max(0.0, s.encoder_m)
                    self._rest(Phase.EMPTY)
            case Phase.HOMING_OUT:
                s.outer_m = s.encoder_m
                s.target_m, s.speed_mps = -1.0, 0.0
                self._enter(Phase.HOMING_IN)
            case Phase.HOMING_IN:
                self._homed()
            case _:
                s.is_blocked = True
                self._rest(Phase.IDLE)

    def _homed(self) -> None:
        s = self._s
        s.stroke_m = s.outer_m - s.encoder_m
        if abs(s.stroke_m - self.limits.stroke_m) > HOMING_TOLERANCE_M:
            s.fault = f"homing found a stroke of {s.stroke_m:.5f} m"
            self._rest(Phase.FAULT)
            return
        s.correction_m = s.encoder_m
        s.zero_m += s.encoder_m
        s.encoder_m = 0.0
        s.is_homed = True
        self._rest(Phase.IDLE)

    def _latch(self) -> None:
        s = self._s
        size_m = s.encoder_m + s.force_n / COMPLIANCE_N_PER_M
        s.gripped_m = s.encoder_m
        s.size_m = round(size_m / COUNT_M) * COUNT_M
        is_right = s.window is None or s.window.holds(s.size_m)
        self._enter(Phase.HOLDING if is_right else Phase.WRONG)
