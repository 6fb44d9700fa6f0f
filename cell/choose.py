"""Look into the bin and choose the next pick."""

import asyncio
from collections import Counter
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cell.config import CellConfig
from cell.grasp import GraspCandidates, shaft_candidates
from cell.line import Line
from cell.planning.collision import CollisionModel, Obstacle
from cell.planning.pick import Choice, PickPlanner, Reject
from cell.scene import Scene
from cell.slots import NextSlot
from drivers.arms import ArmModel
from hal import GripperLimits, Transform, compute
from perception.parts import Part

__all__ = ["Seen", "look_and_choose"]

SAME_GRASP_M, MISS_COST = 0.004, 3.0


@dataclass(frozen=True, eq=False)
class Seen:
    """A scene and what was chosen in it."""

    scene: Scene
    choice: Choice

    def left_reasons(self) -> dict[str, int]:
        """Reason to number of parts that are seen and not taken."""
        found = range(len(self.scene.objects))
        reasons = Counter(self.choice.why(index) for index in found)
        if not self.scene.objects and not self.scene.is_empty:
            reasons["something is there, no part recognised"] = 1
        return dict(sorted(reasons.items()))


async def look_and_choose(line: Line) -> Seen:
    """Capture and find parts, then plan a pick; both are charged as the cell file says."""
    scene = await line.eyes.look()
    line.note(
        "seen",
        look=scene.number,
        parts=[T.matrix[:3] for T in scene.objects],
        confidences=scene.confidences,
        is_empty=scene.is_empty,
        digest=scene.digest,
        **scene.notes,
    )
    slot = line.next_slot()
    if slot is None or not scene.objects:
        return Seen(scene, Choice(None, note="tray is full" if slot is None else ""))
    began_s = asyncio.get_running_loop().time()
    question = _Question.of(line, scene, slot)
    job = line.wall.timed("plan", question.answer)
    choice = await compute(job, charge_s=line.config.charge.plan_s, name="plan")
    ended_s = asyncio.get_running_loop().time()
    line.note("computed", name="plan", start_s=began_s, end_s=ended_s)
    plan = choice.plan
    line.note(
        "chosen",
        look=scene.number,
        part=None if plan is None else plan.detection,
        kind="" if plan is None else plan.kind,
        tries=0 if plan is None else plan.tries,
        rejects=choice.totals,
    )
    return Seen(scene, choice)


@dataclass(frozen=True, eq=False)
class _Question:
    """All that choosing needs, as it was when it was asked: the line goes on meanwhile."""

    config: CellConfig
    part: Part
    arm: ArmModel
    planner: PickPlanner
    limits: GripperLimits
    obstacles: tuple[Obstacle, ...]
    scene: Scene
    slot: NextSlot
    laid_down: tuple[Transform, ...]
    has_failed: tuple[bool, ...]
    missed: tuple[NDArray[np.float64], ...]
    seed: int

    @classmethod
    def of(cls, line: Line, scene: Scene, slot: NextSlot) -> Self:
        retries = line.config.grasp.retries
        return cls(
            config=line.config,
            part=line.part,
            arm=line.arm,
            planner=line.planner,
            limits=line.gripper.limits,
            obstacles=line.obstacles,
            scene=scene,
            slot=slot,
            laid_down=tuple(line.laid_down),
            has_failed=tuple(line.memory.tries_at(T) > retries for T in scene.objects),
            missed=tuple(T_base_tcp for _, T_base_tcp in line.memory.misses),
            seed=line.seed * 1000 + scene.number,
        )

    def answer(self) -> Choice:
        """Plan; pure, for a worker thread."""
        model = CollisionModel(
            self.arm,
            self.config.layout,
            self.part,
            parts=[*self.scene.objects, *self.laid_down],
            clutter_m=self.scene.clutter_m,
            obstacles=self.obstacles,
            margin_m=self.config.grasp.safety_margin_m,
        )
        choice = self.planner.choose(
            self._candidates(), self.scene.objects, model, self.slot, seed=self.seed
        )
        for index, has_failed in enumerate(self.has_failed):
            if has_failed:
                choice.rejects[index] = Counter({Reject.FAILED_BEFORE: 1})
        return choice

    def _candidates(self) -> GraspCandidates:
        """Mark down tool poses next to one that missed, so that the next try is another."""
        grasp = self.config.grasp
        groups = [
            shaft_candidates(
                self.part,
                T_base_object,
                index=index,
                fingers=self.config.layout.fingers,
                limits=self.limits,
                opening_margin_m=grasp.opening_margin_m,
                max_tilt_rad=grasp.max_tilt_rad,
            )
            for index, T_base_object in enumerate(self.scene.objects)
            if not self.has_failed[index]
        ]
        candidates = GraspCandidates.joined(groups)
        for T_base_tcp in self.missed:
            away_m = np.linalg.norm(candidates.T_base_tcp[:, :3, 3] - T_base_tcp[:3, 3], axis=1)
            candidates.score[away_m < SAME_GRASP_M] -= MISS_COST
        return candidates
