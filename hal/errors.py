"""Every error binpick raises on purpose, as one tree.

An error says who, what and with which numbers, and keeps them as attributes. The message is
one line that names the cause; where there is an obvious next step it names that too.
"""

__all__ = [
    "AmbiguousPoseError",
    "CellError",
    "CollisionError",
    "ConfigError",
    "DeviceError",
    "DeviceTimeoutError",
    "FaultError",
    "FrameMismatchError",
    "LinkError",
    "LocalProtocolError",
    "NoDepthError",
    "NoPartError",
    "PerceptionError",
    "PlanningError",
    "PreemptedError",
    "ProtocolError",
    "RejectedError",
    "RemoteProtocolError",
    "SafetyError",
    "UnreachableError",
]


class CellError(Exception):
    """The root: catching this catches everything that is not a bug."""

    retryable = False


class ConfigError(CellError, ValueError):
    """A file or an option says something that cannot be; names the file and the key."""

    def __init__(self, message: str, *, source: str = "", key: str = "") -> None:
        where = ": ".join(part for part in (source, key) if part)
        super().__init__(f"{where}: {message}" if where else message)
        self.source = source
        self.key = key


class FrameMismatchError(CellError, ValueError):
    """Two transforms met whose neighbouring frames differ."""


class DeviceError(CellError):
    """Something about one device; ``device`` says which."""

    def __init__(self, message: str, *, device: str) -> None:
        super().__init__(f"{device}: {message}")
        self.device = device


class LinkError(DeviceError, ConnectionError):
    """The wire is gone: refused, closed, unplugged. Reopen the device."""

    retryable = True


class DeviceTimeoutError(DeviceError, TimeoutError):
    """The device stayed silent past the deadline."""

    retryable = True

    def __init__(self, *, device: str, action: str, timeout_s: float) -> None:
        super().__init__(f"no reply to {action} in {timeout_s:g} s", device=device)
        self.action = action
        self.timeout_s = timeout_s


class ProtocolError(DeviceError):
    """What was said on the wire makes no sense."""


class LocalProtocolError(ProtocolError):
    """We were about to send nonsense: a bug of ours."""


class RemoteProtocolError(ProtocolError):
    """The peer sent nonsense; reopen the link before going on."""

    def __init__(self, message: str, *, device: str, raw: bytes = b"") -> None:
        super().__init__(message, device=device)
        self.raw = raw


class RejectedError(DeviceError):
    """The peer said no, in good order."""

    def __init__(self, message: str, *, device: str, code: int | str = "") -> None:
        super().__init__(message, device=device)
        self.code = code


class PreemptedError(DeviceError):
    """A newer command or a stop took this one's place before it was done."""


class FaultError(DeviceError):
    """Somebody must come, or reset; ``state`` is what the device says of itself."""

    def __init__(self, message: str, *, device: str, state: str = "") -> None:
        super().__init__(message, device=device)
        self.state = state


class PerceptionError(CellError):
    """The images do not show what was asked for."""


class NoDepthError(PerceptionError):
    """Too little of the view has depth: dark, saturated, swapped or unlit images."""


class NoPartError(PerceptionError):
    """There is depth, and no part in it."""


class AmbiguousPoseError(PerceptionError):
    """Several poses explain the points equally well."""


class PlanningError(CellError):
    """No motion does what was asked."""


class UnreachableError(PlanningError):
    """The target lies outside the arm's reach or its joint limits."""


class CollisionError(PlanningError):
    """Every way there hits something."""


class SafetyError(CellError):
    """A safety state forbids going on. Never retried, and not a DeviceError on purpose."""
