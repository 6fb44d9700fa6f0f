"""What must be arranged around a device to try a promise: by hand, or in a simulated world."""

# ruff: noqa: ARG002

from hal.robot import OperatingMode

__all__ = ["Stage", "StageCannotError"]


class StageCannotError(Exception):
    """The stage has no such ability; the backend must have said so in ``lacks``."""

    def __init__(self, ability: str) -> None:
        super().__init__(ability)
        self.ability = ability


class Stage:
    """Hands around a device, never through it. A backend's stage overrides what it can."""

    # Any device.

    async def cut_link(self) -> None:
        """Pull the plug of the device's link."""
        raise StageCannotError("cut_link")

    async def restore_link(self) -> None:
        """Plug it in again."""
        raise StageCannotError("restore_link")

    # Robot.

    async def press_emergency_stop(self) -> None:
        """Press the button."""
        raise StageCannotError("press_emergency_stop")

    async def release_emergency_stop(self) -> None:
        """Pull the button out and switch the motors on."""
        raise StageCannotError("release_emergency_stop")

    async def press_protective_stop(self) -> None:
        """Open the guard."""
        raise StageCannotError("press_protective_stop")

    async def release_protective_stop(self) -> None:
        """Close the guard and acknowledge."""
        raise StageCannotError("release_protective_stop")

    async def switch_motors(self, is_on: bool) -> None:
        """The motor button."""
        raise StageCannotError("switch_motors")

    async def turn_key(self, mode: OperatingMode) -> None:
        """The key switch."""
        raise StageCannotError("turn_key")

    async def true_joints_rad(self) -> tuple[float, ...]:
        """Where the arm is, measured past the driver."""
        raise StageCannotError("true_joints_rad")

    # Gripper.

    async def place_part(self, size_m: float) -> None:
        """Put a part of this size between the open fingers."""
        raise StageCannotError("place_part")

    async def pull_part(self) -> None:
        """Make the held part slip out of the fingers."""
        raise StageCannotError("pull_part")

    async def block_fingers(self, width_m: float) -> None:
        """Put something hard in the way, so that the fingers stop at this width."""
        raise StageCannotError("block_fingers")

    async def unblock_fingers(self) -> None:
        """Take it away."""
        raise StageCannotError("unblock_fingers")

    async def true_width_m(self) -> float:
        """The distance of the finger pads, measured past the driver."""
        raise StageCannotError("true_width_m")

    # Camera and projector.

    async def stop_frames(self) -> None:
        """Make the next capture's images not arrive."""
        raise StageCannotError("stop_frames")

    async def is_lit(self) -> bool:
        """Whether the projector shines, seen past the driver."""
        raise StageCannotError("is_lit")

    # Digital I/O.

    async def set_input(self, name: str, value: bool) -> None:
        """Put a level on an input."""
        raise StageCannotError("set_input")

    async def true_output(self, name: str) -> bool:
        """The level of an output, measured past the driver."""
        raise StageCannotError("true_output")
