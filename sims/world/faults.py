"""Faults made to order, from outside: the devices only see what follows from them."""

from hal import OperatingMode
from sims.world.world import World

__all__ = ["Faults"]


class Faults:
    """Hands that reach into a world."""

    def __init__(self, world: World) -> None:
        self._world = world

    def drop_part(self) -> None:
        """Let the held part slip out now; the pads grip again once the fingers have opened."""
        self._world.lock.make_slippery()

    def set_pad_friction(self, friction: float) -> None:
        """Worn or oily pads, until set again."""
        self._world.lock.set_pad_friction(friction)

    def block_fingers(self, width_m: float) -> None:
        """Put a hard stop at this width, between the fingers and where they want to go."""
        self._world.fingers.block(width_m)

    def unblock_fingers(self) -> None:
        """Take the stop away."""
        self._world.fingers.unblock()

    def cut_link(self, device: str) -> None:
        """Pull a direct device's plug; ``device`` is its name."""
        links = self._world.cabinet.links
        if links.is_up(device):
            links.cut.add(device)
            links.cuts[device] = links.count(device) + 1

    def restore_link(self, device: str) -> None:
        """Plug it in again; the device must be reopened."""
        self._world.cabinet.links.cut.discard(device)

    def press_emergency_stop(self) -> None:
        """Press the button."""
        self._world.cabinet.press_emergency_stop()

    def release_emergency_stop(self) -> None:
        """Pull the button out and switch the motors on again."""
        self._world.cabinet.release_emergency_stop()
        self._world.cabinet.switch_motors(True)

    def press_protective_stop(self) -> None:
        """Open the guard."""
        self._world.cabinet.press_protective_stop()

    def release_protective_stop(self) -> None:
        """Close the guard."""
        self._world.cabinet.release_protective_stop()

    def switch_motors(self, is_on: bool) -> None:
        """The motor button on the cabinet."""
        self._world.cabinet.switch_motors(is_on)

    def turn_key(self, mode: OperatingMode) -> None:
        """The key switch on the cabinet."""
        self._world.cabinet.safety.mode = mode

    def set_input(self, name: str, value: bool) -> None:
        """Put a level on a digital input."""
        if name not in self._world.cabinet.inputs:
            raise ValueError(f"no input {name!r}")
        self._world.cabinet.inputs[name] = value
