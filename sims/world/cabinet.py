"""The robot controller's cabinet: mode, motors, stops, and the links to the devices."""

import copy
from dataclasses import dataclass, field

from hal import OperatingMode
from sims.world.arm import ArmServo

__all__ = ["Cabinet", "Links", "SafetyState"]


@dataclass
class SafetyState:
    """What the key switch, the motor relay and the stop chains say."""

    mode: OperatingMode = OperatingMode.AUTO
    motors_on: bool = True
    protective_stop: bool = False
    emergency_stop: bool = False

    @property
    def may_move(self) -> bool:
        """Whether the arm may be driven."""
        return self.motors_on and not self.protective_stop and not self.emergency_stop


@dataclass
class Links:
    """Which devices' links are cut, and how often each was: a driver must reopen."""

    cut: set[str] = field(default_factory=set)
    cuts: dict[str, int] = field(default_factory=dict)

    def is_up(self, device: str) -> bool:
        """Whether the device can be reached."""
        return device not in self.cut

    def count(self, device: str) -> int:
        """How many times this link was cut."""
        return self.cuts.get(device, 0)


class Cabinet:
    """Stops the arm on its path when it may no longer move; holds signals and links."""

    def __init__(self, arm: ArmServo) -> None:
        self._arm = arm
        self.safety = SafetyState()
        self.links = Links()
        self.inputs: dict[str, bool] = {f"di{k}": False for k in range(1, 9)}
        self.outputs: dict[str, bool] = {f"do{k}": False for k in range(1, 9)}

    def press_emergency_stop(self) -> None:
        """Stop category 1: brake on the path, then the motors go off."""
        self.safety.emergency_stop = True
        self.safety.motors_on = False

    def release_emergency_stop(self) -> None:
        """Pull the button out; the motors stay off."""
        self.safety.emergency_stop = False

    def press_protective_stop(self) -> None:
        """A guard opens: brake on the path; the motors stay on."""
        self.safety.protective_stop = True

    def release_protective_stop(self) -> None:
        """The guard is closed."""
        self.safety.protective_stop = False

    def switch_motors(self, is_on: bool) -> None:
        """The button on the cabinet; refused while the emergency stop is pressed."""
        self.safety.motors_on = is_on and not self.safety.emergency_stop

    def apply(self) -> None:
        """Brake when the arm may no longer move."""
        if not self.safety.may_move:
            self._arm.brake()

    def save(self) -> tuple[SafetyState, Links, dict[str, bool], dict[str, bool]]:
        """Everything the next tick depends on."""
        return copy.deepcopy((self.safety, self.links, self.inputs, self.outputs))

    def restore(self, saved: tuple[SafetyState, Links, dict[str, bool], dict[str, bool]]) -> None:
        """Go on from ``save``."""
        self.safety, self.links, self.inputs, self.outputs = copy.deepcopy(saved)
