"""The simulated pattern projector as a ``hal.Projector``."""

from collections.abc import Sequence

from hal import Identity, Motion, Projector
from sims.camera.stand import Lamp, rig_over
from sims.direct.link import DirectLink
from sims.world import World

__all__ = ["DirectProjector"]


class DirectProjector(Projector):
    """Shows cyclic shifts of one random dot pattern, a step at each exposure of the cameras."""

    def __init__(self, world: World, *, name: str = "projector", patterns: int = 16) -> None:
        if patterns < 1:
            raise ValueError(f"a projector has at least one pattern, not {patterns}")
        self.name = name
        self._world = world
        self._patterns = patterns
        self._link = DirectLink(world, name, Identity("binpick", "dot projector", "simulated"))

    @property
    def pattern_count(self) -> int:
        return self._patterns

    @property
    def is_open(self) -> bool:
        return self._link.is_open

    async def open(self) -> None:
        self._link.open()

    async def close(self) -> None:
        self._link.close()

    async def identity(self) -> Identity:
        self._link.check()
        return self._link.identity

    def set_light(self, is_on: bool) -> Motion[None]:
        return Motion(self._set_light(is_on), name=f"{self.name} set_light")

    def load_sequence(self, patterns: Sequence[int]) -> Motion[None]:
        sequence = tuple(patterns)
        if not sequence or not all(0 <= p < self._patterns for p in sequence):
            raise ValueError(f"patterns are 0 to {self._patterns - 1}, not {list(sequence)}")
        return Motion(self._load(sequence), name=f"{self.name} load_sequence")

    @property
    def _lamp(self) -> Lamp:
        return rig_over(self._world).lamp

    async def _set_light(self, is_on: bool) -> None:
        self._link.check()
        self._lamp.is_on = is_on

    async def _load(self, sequence: tuple[int, ...]) -> None:
        self._link.check()
        self._lamp.sequence = sequence
        self._lamp.step = 0
