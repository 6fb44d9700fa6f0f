"""Choose a grasp: sort the candidates, the first that passes every check wins.

Each check that fails is counted under its reason, for each part: that is what the report shows
where parts are left.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from cell.grasp import GraspCandidates
from cell.planning.collision import CollisionModel
from cell.planning.reach import Reach, line_poses
from cell.planning.transit import Joints, plan_transit
from cell.slots import NextSlot
from hal import Layout, RobotLimits, Transform

__all__ = ["Choice", "PickPlan", "PickPlanner", "Reject"]

LINE_STEP_M = 0.004
CHUNK = 48
RIM_CLEARANCE_M = 0.015
TIP_PAST_TCP_M = 0.010
MIN_RETREAT_M = 0.04
PLACE_HEIGHT_M = 0.06


class Reject(StrEnum):
    """Why a candidate was not taken."""

    UNREACHABLE = "out of reach or joint limits"
    GRASP_COLLIDES = "fingers or hand hit something at the grasp"
    APPROACH_LEAVES = "approach leaves the arm's branch"
    APPROACH_COLLIDES = "approach is blocked"
    PART_HITS_BIN = "part would hit the bin on the way out"
    NO_WAY = "no way from home"
    NO_PLACE = "cannot be laid down in the next slot"
    FAILED_BEFORE = "failed before"


@dataclass(frozen=True, eq=False)
class PickPlan:
    """One whole pick: joints and lines, all checked."""

    detection: int
    kind: str
    T_base_object: Transform
    T_base_tcp: Transform
    opening_m: float
    expected_m: float
    to_approach: tuple[Joints, ...]
    retreat_m: float
    to_place: tuple[Joints, ...]
    T_base_place: Transform
    T_base_target: Transform
    place_m: float
    release_m: float
    to_home: tuple[Joints, ...]
    tries: int
    slot: int


@dataclass(frozen=True)
class Choice:
    """A plan or none, and why the others were not taken: part index to reasons."""

    plan: PickPlan | None
    rejects: dict[int, Counter[Reject]] = field(default_factory=dict)
    note: str = ""

    def why(self, detection: int) -> str:
        """Name the commonest reason why one part was not taken."""
        if self.plan is not None and detection == self.plan.detection:
            return "would have been next"
        reasons = self.rejects.get(detection)
        if reasons:
            return str(reasons.most_common(1)[0][0])
        return self.note or ("not tried" if self.plan else "no grasp fits its pose")

    @property
    def totals(self) -> dict[str, int]:
        """Reason to count over all parts."""
        total: Counter[Reject] = Counter()
        for reasons in self.rejects.values():
            total.update(reasons)
        return {str(reason): total[reason] for reason in Reject if total[reason]}


@dataclass(eq=False)
class PickPlanner:
    """Plans from and to ``home_rad``, in a model of the cell as it was last seen."""

    reach: Reach
    limits: RobotLimits
    layout: Layout
    home_rad: Joints
    stroke_m: float = 0.035
    release_margin_m: float = 0.006

    def choose(
        self,
        candidates: GraspCandidates,
        objects: Sequence[Transform],
        model: CollisionModel,
        place: NextSlot,
        *,
        seed: int,
    ) -> Choice:
        """Return the first candidate, best first, that passes every check.

        ``objects`` are the ``T_base_object`` that ``candidates.detection`` indexes.
        """
        ordered = candidates.best_first()
        rejects: dict[int, Counter[Reject]] = {}
        for first in range(0, len(ordered), CHUNK):
            chunk = slice(first, first + CHUNK)
            joints = self._both_ways(ordered.T_base_tcp[chunk])
            for k in range(len(joints)):
                index = first + k
                detection = int(ordered.detection[index])
                checked = _Candidate(self, ordered, index, objects[detection], model, place)
                result = checked.plan(joints[k], np.random.default_rng((seed, index)))
                if isinstance(result, PickPlan):
                    return Choice(result, rejects)
                rejects.setdefault(detection, Counter())[result] += 1
        return Choice(None, rejects)

    def _both_ways(self, T_base_tcp: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, 4, 4) to (N, 2, 6): as given, and turned by half a turn about the approach."""
        turned = np.array(T_base_tcp)
        turned[:, :3, :2] *= -1
        both = self.reach.nearest(np.concatenate([T_base_tcp, turned]), self.home_rad)
        return both.reshape(2, -1, 6).swapaxes(0, 1)


@dataclass(eq=False)
class _Candidate:
    planner: PickPlanner
    candidates: GraspCandidates
    index: int
    T_base_object: Transform
    model: CollisionModel
    place: NextSlot

    def plan(self, ways: NDArray[np.float64], rng: np.random.Generator) -> PickPlan | Reject:
        """Try both ways round; the reason that came furthest is reported."""
        worst = Reject.UNREACHABLE
        order = list(Reject)
        for turned, joints in enumerate(ways):
            if np.isnan(joints).any():
                continue
            result = self._plan_one(bool(turned), joints, rng)
            if isinstance(result, PickPlan):
                return result
            worst = max(worst, result, key=order.index)
        return worst

    def _plan_one(
        self, is_turned: bool, joints: Joints, rng: np.random.Generator
    ) -> PickPlan | Reject:
        planner, model = self.planner, self.model
        opening_m = float(self.candidates.opening_m[self.index])
        if model.hits(joints, opening_m):
            return Reject.GRASP_COLLIDES
        T = np.array(self.candidates.T_base_tcp[self.index])
        if is_turned:
            T[:3, :2] *= -1
        retreat_m = self._retreat(T, self._lowest())
        line = planner.reach.follow(line_poses(T, -T[:3, 2], retreat_m, LINE_STEP_M), joints)
        if line is None:
            return Reject.APPROACH_LEAVES
        if any(model.hits(q, opening_m) for q in line[1:]):
            return Reject.APPROACH_COLLIDES
        T_base_tcp = Transform("base", "tcp", T)
        T_tcp_object = T_base_tcp.inverse() @ self.T_base_object
        expected_m = float(self.candidates.expected_m[self.index])
        with model.carrying(T_tcp_object):
            if any(model.hits_carried(q, expected_m) for q in line[1:]):
                return Reject.PART_HITS_BIN
        to_approach = self._transit(planner.home_rad, line[-1], opening_m, rng)
        if to_approach is None:
            return Reject.NO_WAY
        placing = self._place(line[-1], T_tcp_object, expected_m, rng)
        if placing is None:
            return Reject.NO_PLACE
        to_place, T_base_place, T_base_target, to_home = placing
        return PickPlan(
            int(self.candidates.detection[self.index]),
            str(self.candidates.kind[self.index]),
            self.T_base_object,
            T_base_tcp,
            opening_m,
            expected_m,
            to_approach,
            retreat_m,
            to_place,
            T_base_place,
            T_base_target,
            PLACE_HEIGHT_M,
            self._release(expected_m),
            to_home,
            self.index + 1,
            self.place.index,
        )

    def _release(self, width_m: float) -> float:
        """How far the fingers open to let go."""
        return min(width_m + self.planner.release_margin_m, self.planner.stroke_m)

    def _retreat(self, T: NDArray[np.float64], lowest_m: float) -> float:
        """How far back along the approach until tips and part are over the rim."""
        layout = self.planner.layout
        rim_m = layout.bin.T_base_bin.translation_m[2] + layout.bin.size_m[2]
        lowest_m = min(lowest_m, float(T[2, 3]) - TIP_PAST_TCP_M)
        rise_m = float(rim_m + RIM_CLEARANCE_M - lowest_m)
        return max(MIN_RETREAT_M, float(rise_m / max(0.3, -T[2, 2])))

    def _lowest(self) -> float:
        """Height of the part's lowest point where it lies now."""
        part = self.place.part
        sine = float(np.hypot(*self.T_base_object.rotation[:2, 2]))
        down_m = abs(self.T_base_object.rotation[2, 2]) * part.length_m / 2
        return float(self.T_base_object.translation_m[2] - down_m - sine * part.max_radius_m)

    def _transit(
        self,
        start: Joints,
        goal: Joints,
        opening_m: float,
        rng: np.random.Generator,
    ) -> tuple[Joints, ...] | None:
        path = plan_transit(
            lambda q: not self.model.hits_in_transit(q, opening_m),
            start,
            goal,
            lower_rad=np.array(self.planner.limits.lower_rad),
            upper_rad=np.array(self.planner.limits.upper_rad),
            rng=rng,
        )
        return None if path is None else tuple(path)

    def _place(
        self, start: Joints, T_tcp_object: Transform, width_m: float, rng: np.random.Generator
    ) -> tuple[tuple[Joints, ...], Transform, Transform, tuple[Joints, ...]] | None:
        planner, model = self.planner, self.model
        release_m = self._release(width_m)
        for T_base_tcp, T_base_object in self.place.poses(T_tcp_object, self._kind):
            poses = line_poses(
                T_base_tcp.matrix, np.array([0, 0, 1.0]), PLACE_HEIGHT_M, LINE_STEP_M
            )
            for above in planner.reach.solutions(poses[-1:], start)[0]:
                if np.isnan(above).any() or model.hits(above, release_m):
                    continue
                line = planner.reach.follow(poses[::-1], above)
                if line is None or any(model.hits(q, release_m) for q in line):
                    continue
                with model.carrying(T_tcp_object):
                    to_place = self._transit(start, above, width_m, rng)
                if to_place is None:
                    continue
                to_home = self._transit(above, planner.home_rad, release_m, rng)
                if to_home is not None:
                    return to_place, T_base_tcp, T_base_object, to_home
        return None

    @property
    def _kind(self) -> str:
        return str(self.candidates.kind[self.index])
