"""Motions of one pick: to the part, grip, out of the bin, over the tray, down, home."""

from collections.abc import Sequence
from dataclasses import replace

from cell.attempt import Attempt
from cell.line import Line
from cell.planning.pick import PickPlan
from cell.planning.transit import Joints
from hal import GraspOutcome, GripperMode, JointTarget, LinearTarget, Load, Target, Transform

__all__ = ["get_ready", "lay_down", "pick"]


async def get_ready(line: Line) -> None:
    """Home the gripper if it must be, open it, bring the arm home."""
    async with line.phase("get ready"):
        if not (await line.gripper.state()).is_homed:
            await line.gripper.home()
        await line.gripper.release()
        await line.robot.set_load(Load())
        await line.robot.move_joints(line.planner.home_rad, speed=line.config.motion.loaded_speed)


async def pick(line: Line, plan: PickPlan, *, number: int) -> Attempt:
    """Fetch the part; ends over the tray holding it, or at home without."""
    config = line.config
    line.note(
        "pick", number=number, T_base_object=plan.T_base_object, T_base_target=plan.T_base_target
    )
    async with line.phase("approach", attempt=number):
        opening = line.gripper.move_to(plan.opening_m)
        approach = _shifted(plan.T_base_tcp, plan.T_base_tcp, -plan.retreat_m)
        try:
            path = _joint_targets(line, plan.to_approach, config.motion.transit_speed)
            await line.robot.move(path)
        finally:
            await opening
    async with line.phase("descend", attempt=number):
        await line.robot.move_linear(plan.T_base_tcp, speed_mps=config.motion.approach_mps)
    async with line.phase("grip", attempt=number):
        grasp = await line.gripper.grasp(
            expected_m=plan.expected_m,
            inner_tolerance_m=config.grasp.size_tolerance_m,
            outer_tolerance_m=config.grasp.size_tolerance_m,
            speed_mps=config.grasp.closing_mps,
            force_n=config.grasp.force_n,
        )
        if grasp.is_held:
            T_flange_object = _flange_tcp(line) @ plan.T_base_tcp.inverse() @ plan.T_base_object
            x, y, z = T_flange_object.apply(line.part.centre_of_mass_m)
            await line.robot.set_load(Load(line.part.mass_kg, (float(x), float(y), float(z))))
        else:
            await line.gripper.release(width_m=plan.opening_m)
    attempt = replace(
        Attempt.begun(plan, number=number),
        outcome=grasp.outcome,
        size_m=grasp.size_m,
        force_n=grasp.force_n,
        miss="" if grasp.is_held else str(grasp.outcome),
    )
    async with line.phase("retreat", attempt=number):
        await line.robot.move([LinearTarget(approach, config.motion.retreat_mps)])
    if not grasp.is_held:
        return await _home_empty(line, plan, attempt)
    async with line.phase("transfer", attempt=number):
        await line.robot.move(_joint_targets(line, plan.to_place, config.motion.loaded_speed))
    if (await line.gripper.state()).mode is not GripperMode.HOLDING:
        return await _home_empty(line, plan, replace(attempt, miss="lost on the way"))
    line.slots_used += 1
    line.laid_down.append(plan.T_base_target)
    return attempt


async def _home_empty(line: Line, plan: PickPlan, attempt: Attempt) -> Attempt:
    line.memory.remember(plan)
    async with line.phase("home without a part", attempt=attempt.number):
        await line.robot.set_load(Load())
        back = plan.to_home if attempt.outcome is GraspOutcome.HELD else _reversed(line, plan)
        await line.robot.move(_joint_targets(line, back, line.config.motion.transit_speed))
        await line.gripper.release()
    return attempt


def _reversed(line: Line, plan: PickPlan) -> list[Joints]:
    return [*plan.to_approach[-2::-1], line.planner.home_rad]


async def lay_down(line: Line, plan: PickPlan, attempt: Attempt) -> Attempt:
    """From over the tray: down, let go, up, home."""
    config = line.config
    above = _shifted(plan.T_base_place, Transform.identity("base", "tcp"), plan.place_m)
    async with line.phase("lower", attempt=attempt.number):
        await line.robot.move_linear(plan.T_base_place, speed_mps=config.motion.place_mps)
    is_held = (await line.gripper.state()).mode is GripperMode.HOLDING
    async with line.phase("let go", attempt=attempt.number):
        await line.gripper.release(width_m=plan.release_m)
        await line.robot.set_load(Load())
    async with line.phase("home", attempt=attempt.number):
        await line.robot.move_linear(above, speed_mps=config.motion.place_mps)
        await line.robot.move(_joint_targets(line, plan.to_home, config.motion.transit_speed))
    if not is_held:
        line.memory.remember(plan)
        return replace(attempt, miss="lost over the tray")
    line.memory.forget()
    return replace(attempt, is_laid_down=True)


def _joint_targets(line: Line, path: Sequence[Joints], speed: float) -> list[Target]:
    """Blend through all but the last."""
    last = len(path) - 1
    return [
        JointTarget(
            tuple(float(q) for q in joints),
            speed,
            line.config.motion.zone_m if index < last else 0.0,
        )
        for index, joints in enumerate(path)
    ]


def _flange_tcp(line: Line) -> Transform:
    return Transform.from_translation("flange", "tcp", (0, 0, line.config.fingers.tcp_m))


def _shifted(T_base_tcp: Transform, along: Transform, distance_m: float) -> Transform:
    """Move the tool along the z axis of ``along``."""
    shift_m = along.rotation[:, 2] * distance_m
    return Transform.from_parts(
        "base", "tcp", T_base_tcp.rotation, T_base_tcp.translation_m + shift_m
    )
