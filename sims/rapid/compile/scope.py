"""What names mean inside one routine, and where its data stands in a frame."""

from dataclasses import dataclass, field

from sims.rapid.ast import Mode
from sims.rapid.symbols import Datum, ModuleScope
from sims.rapid.types import Shape

__all__ = ["Local", "RoutineScope"]


@dataclass(frozen=True, slots=True)
class Local:
    """Data of a routine. A boxed one is a ``Cell`` in its slot, so that it can be referred to.

    ``mode`` is that of a parameter, IN for all else.
    """

    name: str
    slot: int
    shape: Shape
    is_boxed: bool = False
    mode: Mode = Mode.IN
    is_optional: bool = False
    is_constant: bool = False

    @property
    def is_reference(self) -> bool:
        """Whether the caller's data stands in the slot."""
        return self.mode is not Mode.IN


@dataclass(slots=True)
class RoutineScope:
    """Names of a routine over those of its module; FOR variables come and go."""

    module: ModuleScope
    locals: dict[str, Local] = field(default_factory=dict)

    def find_local(self, name: str) -> Local | None:
        """A local by lower-case name."""
        return self.locals.get(name)

    def find_data(self, name: str) -> Datum | None:
        """Data of the module or the task, by lower-case name."""
        return self.module.find_data(name)
