"""Several moves as one motion, blended where they have a zone, and its playing back.

Blending: once the tool centre point is within the zone of a target, and the move there only
slows down, the next move begins on top of what is left of this one. The arm does not stop,
every move still ends at its own target, and joint speeds stay below their limits because one
share falls while the other rises. At most half of a move is blended at either end.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from drivers.arms import Kinematics
from hal import JointTarget, LinearTarget, Target, Tool
from sims.motion.segments import Segment, circular_segment, joint_segment, linear_segment

__all__ = ["Program", "plan_program"]

Joints = NDArray[np.float64]


def plan_program(
    kinematics: Kinematics,
    start_rad: Joints,
    targets: Sequence[Target],
    tool: Tool,
    tick_s: float,
) -> "Program":
    """Plan all moves before the first begins.

    Raises
    ------
    UnreachableError
        A linear move does not stay in reach.
    """
    segments: list[Segment] = []
    at = np.array(start_rad, float)
    for target in targets:
        if isinstance(target, JointTarget):
            segments.append(joint_segment(kinematics, at, target, tick_s))
        elif isinstance(target, LinearTarget):
            segments.append(linear_segment(kinematics, at, target, tool, tick_s))
        else:
            segments.append(circular_segment(kinematics, at, target, tool, tick_s))
        at = segments[-1].joints_rad[-1]
    zones_m = [target.zone_m for target in targets]
    return Program(_blended(kinematics, tool, segments, zones_m), kinematics, tick_s)


def _blended(
    kinematics: Kinematics, tool: Tool, segments: list[Segment], zones_m: list[float]
) -> Joints:
    whole = segments[0].joints_rad.copy()
    begins = 0  # the row of ``whole`` at which the current segment began
    for index in range(1, len(segments)):
        before, after = segments[index - 1], segments[index]
        overlap = _overlap(kinematics, tool, before, after, zones_m[index - 1])
        begins = begins + len(before.joints_rad) - 1 - overlap
        step = after.joints_rad - after.joints_rad[0]
        longer = np.vstack([whole, np.repeat(whole[-1:], begins + len(step) - len(whole), axis=0)])
        longer[begins:] += step
        whole = longer
    return whole


def _overlap(
    kinematics: Kinematics, tool: Tool, before: Segment, after: Segment, zone_m: float
) -> int:
    """How many ticks before its end a move may be joined by the next."""
    rows = len(before.joints_rad)
    most = min((rows - 1) // 2, (len(after.joints_rad) - 1) // 2, rows - 1 - before.braking)
    if zone_m <= 0 or most <= 0:
        return 0
    tail = kinematics.forward(before.joints_rad[rows - 1 - most :]) @ tool.T_flange_tcp.matrix
    away = np.linalg.norm(tail[:, :3, 3] - tail[-1, :3, 3], axis=1)
    outside = np.flatnonzero(away > zone_m)
    return most if len(outside) == 0 else most - int(outside[-1]) - 1


class Program:
    """Set-points a tick apart, played at rate 1, or slower while braking."""

    def __init__(self, joints_rad: Joints, kinematics: Kinematics, tick_s: float) -> None:
        self.joints_rad = joints_rad
        self._limits = np.array(kinematics.arm.accelerations_radps2)
        self._tick_s = tick_s
        self._at = 0.0
        self._rate = 1.0
        self._slowing = 0.0

    @property
    def duration_s(self) -> float:
        """Without braking."""
        return (len(self.joints_rad) - 1) * self._tick_s

    @property
    def is_done(self) -> bool:
        """Whether the last set-point was given, or the brake has stopped the motion."""
        return self._rate <= 0 or self._at >= len(self.joints_rad) - 1

    @property
    def was_stopped(self) -> bool:
        """Whether it ended before its end."""
        return self._slowing > 0 and self._at < len(self.joints_rad) - 1

    def next_joints_rad(self) -> Joints:
        """Return the set-point of the next tick."""
        self._rate = max(0.0, self._rate - self._slowing)
        self._at = min(self._at + self._rate, len(self.joints_rad) - 1.0)
        row = int(self._at)
        share = self._at - row
        if share == 0:
            return np.array(self.joints_rad[row])
        return np.array(self.joints_rad[row] * (1 - share) + self.joints_rad[row + 1] * share)

    def brake(self) -> None:
        """Slow down along the path, as hard as the joint that needs longest allows."""
        if self._slowing > 0:
            return
        row = min(int(self._at), len(self.joints_rad) - 2)
        velocity = np.abs(self.joints_rad[row + 1] - self.joints_rad[row]) / self._tick_s
        needs_s = max(float((velocity / self._limits).max()), 4 * self._tick_s)
        self._slowing = self._tick_s / needs_s
