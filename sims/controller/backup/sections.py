"""Sections of configuration files to values; each says by name what it leaves out."""

import re
from collections.abc import Mapping

from sims.controller.backup.values import (
    CrossConnection,
    Event,
    EventRoutine,
    MotionConfig,
    SignalConfig,
    SystemInput,
    SystemOutput,
)
from sims.controller.cfg import Cfg, Instance
from sims.rapid.host import SignalKind

__all__ = [
    "UNDERSTOOD",
    "crosses_of",
    "event_routines_of",
    "motion_of",
    "signals_of",
    "system_inputs_of",
    "system_outputs_of",
]

UNDERSTOOD = {
    "SYS": {"CAB_TASKS", "CAB_EXEC_HOOKS", "CAB_TASK_MODULES"},
    "EIO": {"EIO_SIGNAL", "EIO_CROSS", "SYSSIG_IN", "SYSSIG_OUT"},
    "MOC": {"ARM", "JOINT", "ROBOT"},
}

_MAX_ARGUMENTS = 10
_MAX_ACTORS = 5
_AXES = 6


def signals_of(eio: Cfg, rest: list[str]) -> tuple[SignalConfig, ...]:
    """Signals by name; the first of two with one name counts."""
    found: dict[str, SignalConfig] = {}
    for item in eio.section("EIO_SIGNAL"):
        kind = item.text("SignalType").upper()
        if not item.name or kind not in SignalKind.__members__:
            rest.append(f"EIO_SIGNAL {item.name!r}: type {kind!r} is not one of {_kinds()}")
        elif item.name.lower() in found:
            rest.append(f"EIO_SIGNAL {item.name!r}: stands twice")
        else:
            found[item.name.lower()] = _signal(item, SignalKind(kind))
    return tuple(found.values())


def crosses_of(eio: Cfg) -> tuple[CrossConnection, ...]:
    """Cross connections."""
    found: list[CrossConnection] = []
    for item in eio.section("EIO_CROSS"):
        actors: list[tuple[str, bool]] = []
        operators: list[str] = []
        for number in range(1, _MAX_ACTORS + 1):
            if not (actor := item.text(f"Act{number}")):
                break
            actors.append((actor, item.flag(f"Act{number}_invert")))
            operators.append(item.text(f"Oper{number}", "AND").upper())
        if item.text("Res") and actors:
            found.append(
                CrossConnection(
                    item.text("Res"), tuple(actors), tuple(operators[: len(actors) - 1])
                )
            )
    return tuple(found)


def system_inputs_of(eio: Cfg) -> tuple[SystemInput, ...]:
    """System inputs."""
    return tuple(
        SystemInput(item.text("Signal"), item.text("Action"), _arguments(item))
        for item in eio.section("SYSSIG_IN")
        if item.text("Signal") and item.text("Action")
    )


def system_outputs_of(eio: Cfg) -> tuple[SystemOutput, ...]:
    """System outputs."""
    return tuple(
        SystemOutput(item.text("Status"), item.text("Signal"), _arguments(item))
        for item in eio.section("SYSSIG_OUT")
        if item.text("Signal") and item.text("Status")
    )


def event_routines_of(sys: Cfg, rest: list[str]) -> tuple[EventRoutine, ...]:
    """Event routines in the order in which they run."""
    found: list[EventRoutine] = []
    for item in sys.section("CAB_EXEC_HOOKS"):
        event = re.sub(r"[\s_]", "", item.text("Shelf")).upper()
        if event not in set(Event):
            rest.append(f"CAB_EXEC_HOOKS {item.text('Routine')!r}: event {event!r} is not known")
            continue
        task = "" if item.flag("AllTask") else item.text("Task")
        sequence = int(max(min(item.number("SeqNo"), 1e6), -1e6))
        found.append(EventRoutine(Event(event), item.text("Routine"), task, sequence))
    return tuple(sorted(found, key=lambda item: item.sequence))


def motion_of(moc: Cfg) -> MotionConfig:
    """Return what is known of the first robot."""
    robots = moc.section("ROBOT")
    if not robots:
        return MotionConfig(joint_bounds_rad=_bounds(moc, None))
    robot = robots[0]
    position = orientation = None
    if robot.get("base_frame_pos_x") is not None:
        x, y, z = (robot.number(f"base_frame_pos_{axis}") for axis in "xyz")
        position = (x, y, z)
    if robot.get("base_frame_orient_u0") is not None:
        w, i, j, k = (robot.number(f"base_frame_orient_u{number}") for number in range(4))
        orientation = (w, i, j, k)
    return MotionConfig(robot.text("use_robot_type"), _bounds(moc, robot), position, orientation)


def _bounds(moc: Cfg, robot: Instance | None) -> tuple[tuple[float, float], ...] | None:
    """From the robot's joints to their arms; by the arms' usual names where that fails."""
    arms: Mapping[str, Instance] = {arm.name.lower(): arm for arm in moc.section("ARM")}
    joints = {joint.name.lower(): joint for joint in moc.section("JOINT")}
    found: list[tuple[float, float]] = []
    for axis in range(_AXES):
        name = f"rob1_{axis + 1}"
        if robot is not None and (joint := joints.get(robot.text(f"use_joint_{axis}").lower())):
            name = joint.text("use_arm", name).lower()
        arm = arms.get(name)
        if arm is None or arm.get("upper_joint_bound") is None:
            return None
        found.append((arm.number("lower_joint_bound"), arm.number("upper_joint_bound")))
    return tuple(found)


def _signal(item: Instance, kind: SignalKind) -> SignalConfig:
    device_map = item.text("DeviceMap") or item.text("UnitMap")
    is_group = kind in (SignalKind.GI, SignalKind.GO)
    return SignalConfig(
        name=item.name,
        kind=kind,
        device=item.text("Device") or item.text("Unit"),
        device_map=device_map,
        access=item.text("Access"),
        label=item.text("Label"),
        default=item.number("Default"),
        bits=_bits(device_map, item.number("Size")) if is_group else 1,
        is_inverted=item.flag("Invert"),
        logical_min=item.number("MinLog"),
        logical_max=item.number("MaxLog"),
    )


def _bits(device_map: str, size: float) -> int:
    """Count the bits of a map such as ``0-7,9``; a group has at most 32."""
    count = 0
    for part in device_map.split(","):
        if match := re.fullmatch(r"\s*([0-9]{1,6})\s*(?:-\s*([0-9]{1,6}))?\s*", part):
            last = match[2] or match[1]
            count += abs(int(last) - int(match[1])) + 1
    return int(max(1, min(32, count or size or 32)))


def _arguments(item: Instance) -> tuple[str, ...]:
    given = [item.text("Arg") or item.text("Arg1")]
    given += [item.text(f"Arg{number}") for number in range(2, _MAX_ARGUMENTS + 1)]
    while given and not given[-1]:
        given.pop()
    return tuple(given)


def _kinds() -> str:
    return " ".join(SignalKind)
