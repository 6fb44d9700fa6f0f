"""Which handler takes an error."""

from collections.abc import Sequence
from dataclasses import dataclass

from sims.rapid.data import Cell
from sims.rapid.frames import Frame, FrameKind

__all__ = ["Landing", "find_handler"]


@dataclass(frozen=True, slots=True)
class Landing:
    """Where an error is handled: in which frame, by the handler that begins at ``target``."""

    depth: int
    target: int
    is_long_jump: bool = False


def find_handler(frames: Sequence[Frame], number: int) -> Landing | None:
    """Return the handler of an error that happens in the last frame.

    The routine in which it happens comes first, then long jumps from the innermost caller
    outwards, then the callers one by one. A routine whose handler runs handles nothing more; an
    event routine passes nothing on to what it stands on.
    """
    open_depths = []
    for depth in range(len(frames) - 1, -1, -1):
        if frames[depth].error is None:
            open_depths.append(depth)
        if frames[depth].kind in {FrameKind.BASE, FrameKind.UNDO}:
            break
    own = [depth for depth in open_depths[:1] if depth == len(frames) - 1]
    for depths, is_long in ((own, False), (open_depths, True), (open_depths, False)):
        for depth in depths:
            target = _clause(frames[depth], number, long_only=is_long)
            if target is not None:
                return Landing(depth, target, is_long)
    return None


def _clause(frame: Frame, number: int, *, long_only: bool) -> int | None:
    for numbers, is_long, target in frame.code.handlers:
        if (is_long or not long_only) and (not numbers or _lists(numbers, number)):
            return target
    return None


def _lists(numbers: Sequence[int | Cell], number: int) -> bool:
    return any((one.value if isinstance(one, Cell) else one) == number for one in numbers)
