"""What motion instructions share: the arm behind a task, tool and object, errors by name."""

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from drivers.arms import Kinematics
from hal import Load
from hal.errors import UnreachableError
from sims.controller.confdata import solution_in
from sims.controller.frames import tool_frame, wobj_frame
from sims.controller.settings import MotionSettings
from sims.controller.unit import MechanicalUnit
from sims.motion import CircleError, SingularityError
from sims.rapid.builtin import Legal, Ref, TaskContext, builtin
from sims.rapid.errors import RapidError
from sims.rapid.parser import parse_routine_head
from sims.rapid.values import copy

__all__ = [
    "STOP_MOVE",
    "STOP_MOVE_OTHER",
    "Mechanics",
    "Setup",
    "instruction",
    "joints_for",
    "mechanics_of",
    "not_supported",
    "refusal",
    "value_of",
]

Array = NDArray[np.float64]
F = TypeVar("F", bound=Callable[..., Any])

STOP_MOVE = "StopMove"
STOP_MOVE_OTHER = "StopMove of a task without motion"
RATIO = "speed ratio 0"
EDGE_NUMBER = 50027
REACH_NUMBER = 50050
SINGULAR_NUMBER = 50026
CONF_NUMBER = 50080
CIRCLE_NUMBER = 50112


@dataclass
class Mechanics:
    """The arm of a controller and what programs have set about it.

    ``wide`` are kinematics without joint bounds; ``active`` is the setup of the last move, and
    ``named`` the data it was made of: name and value by ``tooldata``, ``wobjdata``, ``loaddata``.
    """

    unit: MechanicalUnit
    wide: Kinematics
    settings: MotionSettings = field(default_factory=MotionSettings)
    active: "Setup" = field(default_factory=lambda: Setup(np.eye(4), np.eye(4)))

    operator_share: float = 1.0
    refresh_share: float = 1.0
    set_load: Callable[[Load], None] = lambda _: None
    named: "dict[str, tuple[str, Any]]" = field(default_factory=dict)

    def refresh(self, share: float) -> None:
        """Scale the speed by the program's share; the operator's stays."""
        self.refresh_share = share
        self._apply_shares()

    def set_operator_share(self, share: float) -> None:
        """Scale the speed by the pendant's speed ratio."""
        self.operator_share = share
        self._apply_shares()

    def _apply_shares(self) -> None:
        ratio = self.operator_share * self.refresh_share
        if ratio <= 0:
            self.unit.hold(RATIO)
            return
        self.unit.ratio = ratio
        self.unit.release(RATIO)

    def name(self, kind: str, given: Ref | None) -> None:
        """Note the tool, object or load that is the active one from now on."""
        if given is None:
            self.named.pop(kind, None)
        else:
            self.named[kind] = (given.name, copy(given.get()))

    def setup(self, tool: Any, wobj: Any) -> "Setup":
        """A tooldata and a wobjdata (None: tool0, wobj0), with the program displacement.

        Raises
        ------
        RapidError
            As ``Setup.of``.
        """
        return self.displaced(Setup.of(tool, wobj))

    def displaced(self, setup: "Setup") -> "Setup":
        """A setup in whose object programmed places are what the displacement makes of them."""
        T_base_object = setup.T_base_object @ self.settings.T_object_shown
        return Setup(setup.T_flange_tcp, np.asarray(T_base_object))


class HasMechanics(Protocol):
    """A controller."""

    mechanics: Mechanics


def mechanics_of(task: TaskContext) -> Mechanics:
    """The arm of the controller that runs a task."""
    return cast(HasMechanics, task.host).mechanics


def value_of(given: Ref | None) -> Any:
    """The value behind an optional reference."""
    return None if given is None else given.get()


@dataclass(frozen=True, eq=False)
class Setup:
    """Tool and object of a move, as matrices."""

    T_flange_tcp: Array
    T_base_object: Array

    @classmethod
    def of(cls, tool: Any, wobj: Any) -> "Setup":
        """From a tooldata and a wobjdata, which may be None: tool0 and wobj0.

        Raises
        ------
        RapidError
            A quaternion is none, or tool or object are of a kind that is not supported.
        """
        T_tool = np.eye(4) if tool is None else tool_frame(tool)
        return cls(T_tool, wobj_frame(wobj))

    def tcp_in_base(self, T_object_tcp: Array) -> Array:
        """``T_base_tcp`` of a target in the work object."""
        return np.asarray(self.T_base_object @ T_object_tcp)

    def flange_in_base(self, T_object_tcp: Array) -> Array:
        """``T_base_flange`` of a target in the work object."""
        return np.asarray(self.T_base_object @ T_object_tcp @ np.linalg.inv(self.T_flange_tcp))

    def tcp_in_object(self, T_base_flange: Array) -> Array:
        """``T_object_tcp`` of a flange pose."""
        return np.asarray(np.linalg.inv(self.T_base_object) @ T_base_flange @ self.T_flange_tcp)


def instruction(declaration: str, legal: Legal = Legal.ANYWHERE) -> Callable[[F], F]:
    """Add a built-in that takes its arguments as ``**given``, by lower-case name."""
    names = ["task", *(param.name.lower() for param in parse_routine_head(declaration).params)]
    keyword = inspect.Parameter.KEYWORD_ONLY

    def add(call: F) -> F:
        signature = inspect.Signature([inspect.Parameter(name, keyword) for name in names])
        call.__signature__ = signature  # type: ignore[attr-defined]
        return builtin(declaration, legal)(call)

    return add


def not_supported(what: str) -> RapidError:
    """For what this controller refuses by name."""
    return RapidError("ERR_ARGVALERR", f"{what} is not supported by this controller", is_fatal=True)


def refusal(mechanics: Mechanics, T_base_flange: Array, error: UnreachableError) -> RapidError:
    """Why a move cannot be driven, as the program gets it."""
    if isinstance(error, CircleError):
        return RapidError("ERR_PATH_STOP", f"circle: {error}", number=CIRCLE_NUMBER)
    if isinstance(error, SingularityError):
        return RapidError("ERR_PATH_STOP", str(error), number=SINGULAR_NUMBER)
    if np.isnan(mechanics.wide.inverse_all(T_base_flange).joints_rad[0]).any(axis=1).all():
        return RapidError("ERR_OUTSIDE_REACH", str(error), number=REACH_NUMBER)
    return RapidError("ERR_ROBLIMIT", str(error), number=EDGE_NUMBER)


def joints_for(
    mechanics: Mechanics, T_base_flange: Array, conf: list[float], near_rad: Array, *, is_free: bool
) -> Array:
    """The joints of a pose: with the confdata, or (``is_free``) nearest to ``near_rad``.

    Raises
    ------
    RapidError
        ERR_OUTSIDE_REACH, ERR_ROBLIMIT; ERR_PATH_STOP: there is no posture with the confdata.
    """
    unit = mechanics.unit
    solutions = unit.kinematics.inverse_all(T_base_flange).joints_rad[0]
    if np.isnan(solutions).any(axis=1).all():
        raise refusal(mechanics, T_base_flange, UnreachableError(_where(T_base_flange)))
    if is_free:
        return unit.kinematics.nearest(T_base_flange, near_rad)
    joints = solution_in(unit.kinematics, T_base_flange, conf, near_rad)
    if joints is None:
        raise RapidError(
            "ERR_PATH_STOP",
            f"the target cannot be reached with the configuration {_printed(conf)}: "
            "teach it again, or use ConfJ \\Off",
            number=CONF_NUMBER,
        )
    return joints


def _printed(conf: Sequence[float]) -> str:
    return f"[{', '.join(f'{c:g}' for c in conf)}]"


def _where(T_base_flange: Array) -> str:
    x, y, z = (float(v) * 1e3 for v in T_base_flange[:3, 3])
    return f"the flange cannot be at [{x:.1f}, {y:.1f}, {z:.1f}] mm in the base frame"
