"""The world's judgement of a run: what was really there, held and placed.

Only the demo, benches and tests score; the cell never sees any of this. Listening to the
line's notes, the score asks the world at the moment things happen.
"""

import asyncio
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cell.demo.errors import PoseError, pose_error, summary
from cell.line import Line
from hal import Transform
from perception.parts import Part
from sims.world import World

__all__ = ["PickScore", "Score"]

SAME_PART_M = 0.002
SAME_PART_RAD = np.radians(2.0)
HELD_WITHIN_M = 0.005
PLACED_WITHIN_M = 0.002
PLACED_WITHIN_RAD = np.radians(3.0)
RESTING_SPEED_MPS = 0.05
EXCHANGE_S = 5.0


@dataclass
class PickScore:
    """One attempt as the world saw it.

    ``part`` is the true part nearest to the chosen pose, -1 where there is none at all.
    """

    number: int
    part: int
    seen: PoseError | None
    T_base_target: Transform | None = None
    is_held: bool = False
    is_placed: bool = False
    placed: PoseError | None = None

    @property
    def is_found(self) -> bool:
        """Whether the pose was right: < 2 deg, < 2 mm, not flipped."""
        return (
            self.seen is not None
            and self.seen.axis_rad < SAME_PART_RAD
            and self.seen.position_m < SAME_PART_M
            and not self.seen.is_flipped
        )

    def as_json(self) -> dict[str, Any]:
        """Goes into ``picks``."""
        return {
            "part": self.part,
            "is_held": self.is_held,
            "is_placed": self.is_placed,
            "pose_error": self.seen.as_json() if self.seen else None,
            "place_error": self.placed.as_json() if self.placed else None,
        }


@dataclass(eq=False)
class Score:
    """Listens to a line and judges by the world's truth."""

    world: World
    part: Part
    line: Line
    picks: list[PickScore] = field(default_factory=list)
    _next: PickScore | None = None
    _relative: Transform | None = None
    _judged: int = 0
    _taken: set[int] = field(default_factory=set)

    def __call__(self, event: str, fields: dict[str, Any]) -> None:
        """Take a note of the line."""
        if event == "pick":
            self._begin(fields["number"], fields["T_base_object"], fields["T_base_target"])
        elif event == "phase":
            self._phase(fields["name"])
            self.line.journal.write(
                "truth", round(fields["end_s"] * 1e9), parts=self._part_states()
            )

    def _begin(self, number: int, seen: Transform, target: Transform) -> None:
        poses = {k: self.world.part_pose(k) for k in self._in_cell()}
        self._relative = None
        self._next = PickScore(number, -1, None, target)
        self.picks.append(self._next)
        if not poses:
            return
        part = min(
            poses,
            key=lambda k: float(np.linalg.norm(poses[k].translation_m - seen.translation_m)),
        )
        self._next.part = part
        self._next.seen = pose_error(seen, poses[part], self.part)

    def _phase(self, name: str) -> None:
        pick = self._next
        if pick is None or pick.part < 0:
            return
        if name == "grip":
            self._relative = self._T_hand_part(pick.part)
        elif name == "transfer" and self._relative is not None:
            now = self._T_hand_part(pick.part)
            moved_m = np.linalg.norm(now.translation_m - self._relative.translation_m)
            pick.is_held = bool(moved_m < HELD_WITHIN_M)

    def judge_tray(self) -> None:
        """Judge what lies on the tray, once everything is at rest; call before it goes."""
        for pick in self.picks[self._judged :]:
            if pick.T_base_target is None or not pick.is_held:
                continue
            error = pose_error(self.world.part_pose(pick.part), pick.T_base_target, self.part)
            speed_mps, _ = self.world.part_speed(pick.part)
            pick.placed = error
            pick.is_placed = (
                error.position_m < PLACED_WITHIN_M
                and error.axis_rad < PLACED_WITHIN_RAD
                and not error.is_flipped
                and speed_mps < RESTING_SPEED_MPS
            )
        self._judged = len(self.picks)

    async def exchange_tray(self) -> None:
        """Play the operator: wait for rest, judge, take the parts of this tray away."""
        await asyncio.sleep(EXCHANGE_S)
        first = self._judged
        self.judge_tray()
        for part in {pick.part for pick in self.picks[first:] if pick.is_held}:
            self.world.park(part)
            self._taken.add(part)

    @property
    def left(self) -> int:
        """Parts that lie in the bin."""
        return sum(self._is_in_bin(k) for k in self._in_cell())

    @property
    def lost(self) -> int:
        """Parts that lie neither in the bin nor where one was laid down."""
        placed = {pick.part for pick in self.picks if pick.is_placed}
        return sum(not self._is_in_bin(k) for k in self._in_cell() if k not in placed)

    def _is_in_bin(self, part: int) -> bool:
        box = self.world.layout.bin
        x, y, z = box.T_base_bin.inverse().apply(self.world.part_pose(part).translation_m)
        return bool(abs(x) < box.size_m[0] / 2 and abs(y) < box.size_m[1] / 2 and z > -0.01)

    def pose_summary(self) -> dict[str, Any]:
        """Errors of the poses that were picked by."""
        right = [pick.seen for pick in self.picks if pick.is_found and pick.seen]
        return summary(right, misses=len(self.picks) - len(right))

    def place_summary(self) -> dict[str, Any]:
        """Errors of what was laid down."""
        placed = [pick.placed for pick in self.picks if pick.placed and pick.is_placed]
        return summary(placed, misses=len(self.picks) - len(placed))

    def _in_cell(self) -> list[int]:
        return [k for k in range(self.world.parts) if not self.world.is_parked(k)]

    def _T_hand_part(self, part: int) -> Transform:
        rotation = self.world.data.body("grip").xmat.reshape(3, 3)
        T_base_hand = Transform.from_parts(
            "base", "hand", rotation, self.world.data.body("grip").xpos
        )
        return T_base_hand.inverse() @ self.world.part_pose(part)

    def _part_states(self) -> list[list[float]]:
        """Positions to a micrometre, axes to 1e-6."""
        poses = [self.world.part_pose(k) for k in self._in_cell()]
        return [
            np.round(np.concatenate([T.translation_m, T.rotation[:, 2]]), 6).tolist() for T in poses
        ]
