"""Where values live: variables, persistents that several tasks share, parts of either."""

from collections.abc import Callable, Sequence
from typing import Any

from sims.rapid.ast import DataKind
from sims.rapid.errors import RapidError
from sims.rapid.types import Shape
from sims.rapid.values import convert, position

__all__ = ["ABSENT", "Cell", "Constant", "Element", "Pers", "Reference"]

Cancel = Callable[[], None]


class Cell:
    """A variable. ``value`` is read and written by compiled code, which has checked it."""

    __slots__ = ("name", "shape", "value")
    kind = DataKind.VAR

    def __init__(self, name: str, shape: Shape, value: Any) -> None:
        self.name = name
        self.shape = shape
        self.value = value

    @property
    def type(self) -> str:
        """The declared type, lower case."""
        return self.shape.declared or self.shape.type.name

    @property
    def base(self) -> str:
        """The type with aliases resolved."""
        return self.shape.type.name

    @property
    def rank(self) -> int:
        """How many dimensions it has."""
        return len(self.shape.dims)

    @property
    def root(self) -> "Cell":
        """Itself."""
        return self

    def get(self) -> Any:
        """The value; a list is the variable's own."""
        return self.value

    def set(self, value: Any) -> None:
        """Store a value from outside the program: checked, rounded, copied."""
        self.store(convert(value, self.shape))

    def store(self, value: Any) -> None:
        """Store a checked value."""
        self.value = value


class Constant(Cell):
    """Data that nobody may write."""

    __slots__ = ()
    kind = DataKind.CONST

    def store(self, value: Any) -> None:  # noqa: ARG002
        """Refuse."""
        raise RapidError("ERR_ARGVALERR", f"{self.name} is a constant and cannot be written")


class Pers(Cell):
    """A persistent; whoever watches it is told of every change."""

    __slots__ = ("_watchers", "has_value")
    kind = DataKind.PERS

    def __init__(self, name: str, shape: Shape, value: Any) -> None:
        super().__init__(name, shape, value)
        self._watchers: list[Callable[[], None]] = []
        self.has_value = True

    def store(self, value: Any) -> None:
        """Store a checked value, and tell if it is another one."""
        changed = value != self.value
        self.value = value
        if changed and self._watchers:
            self.tell()

    def tell(self) -> None:
        """Tell the watchers."""
        for watcher in tuple(self._watchers):
            watcher()

    def watch(self, changed: Callable[[], None]) -> Cancel:
        """Call back at every change, until cancelled."""
        self._watchers.append(changed)

        def cancel() -> None:
            if changed in self._watchers:
                self._watchers.remove(changed)

        return cancel


class Element:
    """An element or a component: ``path`` has component numbers (int) and indices (float)."""

    __slots__ = ("path", "root", "shape")

    def __init__(self, base: "Reference", shape: Shape, path: Sequence[int | float]) -> None:
        self.shape = shape
        self.root: Cell = base.root
        steps = list(base.path) if isinstance(base, Element) else []
        value = base.get()
        for step in path:
            k = step if type(step) is int else position(value, step)
            steps.append(k)
            value = value[k]
        self.path: tuple[int, ...] = tuple(steps)

    @property
    def name(self) -> str:
        """The name of the data it is in."""
        return self.root.name

    @property
    def kind(self) -> DataKind:
        """How the data it is in is stored."""
        return self.root.kind

    @property
    def type(self) -> str:
        """The declared type, lower case."""
        return self.shape.declared or self.shape.type.name

    @property
    def base(self) -> str:
        """The type with aliases resolved."""
        return self.shape.type.name

    @property
    def rank(self) -> int:
        """How many dimensions it has."""
        return len(self.shape.dims)

    def get(self) -> Any:
        """The value; a list is the data's own."""
        value = self.root.value
        for step in self.path:
            value = value[step]
        return value

    def set(self, value: Any) -> None:
        """Store a value from outside the program: checked, rounded, copied."""
        self.store(convert(value, self.shape))

    def store(self, value: Any) -> None:
        """Store a checked value; the watchers of a persistent are told."""
        if self.kind is DataKind.CONST:
            self.root.store(value)
        items = self.root.value
        for step in self.path[:-1]:
            items = items[step]
        changed = items[self.path[-1]] != value
        items[self.path[-1]] = value
        if changed and isinstance(self.root, Pers):
            self.root.tell()

    value = property(get, store)


class _Absent:
    """Stands for an optional argument that was not given; touching it is an error."""

    name = ""

    def __bool__(self) -> bool:
        return False

    def _refuse(self, *_: Any) -> Any:
        raise RapidError(
            "ERR_NORUNUNIT",
            "an optional argument that was not given is used: ask Present() first",
            is_fatal=True,
            number=40_024,
        )

    value = property(_refuse, _refuse)
    store = get = set = _refuse


ABSENT: Any = _Absent()

Reference = Cell | Element
