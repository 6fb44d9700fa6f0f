"""The promises of ``hal.Robot``."""

import asyncio
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray

from hal.conformance.base import Conformance
from hal.conformance.stage import Stage
from hal.errors import LinkError, PreemptedError, RejectedError, SafetyError, UnreachableError
from hal.robot import (
    CircularTarget,
    JointTarget,
    LinearTarget,
    Load,
    OperatingMode,
    Robot,
    RobotState,
    Tool,
)
from hal.transform import Transform

__all__ = ["RobotConformance"]


class RobotConformance(Conformance):
    """A small working volume around ``home_rad`` must be free: 0.15 m and 0.4 rad each way."""

    interface = "robot"
    home_rad: ClassVar[tuple[float, ...]] = (0.0, 0.0, 0.0, 0.0, 1.5707963, 0.0)
    joint_tolerance_rad: ClassVar[float] = 2e-4
    path_tolerance_m: ClassVar[float] = 2e-4
    poll_s: ClassVar[float] = 0.01

    @pytest.fixture
    def robot(self, device: Robot) -> Robot:
        return device

    async def prepare(self, device: Any) -> None:
        await device.move_joints(self.home_rad)

    def near(self, **changes_rad: float) -> tuple[float, ...]:
        """Home with some joints (``j1=0.2``) turned."""
        joints = list(self.home_rad)
        for name, change in changes_rad.items():
            joints[int(name[1:]) - 1] += change
        return tuple(joints)

    async def watch(self, robot: Robot, motion: "asyncio.Future[Any] | Any") -> list[RobotState]:
        """Poll the state until a motion has ended."""
        states = []
        while not motion.done():
            states.append(await robot.state())
            await asyncio.sleep(self.poll_s)
        return states

    @pytest.mark.unprepared
    async def test_opening_moves_nothing(self, robot: Robot) -> None:
        before = await robot.state()
        await robot.close()
        await robot.open()
        await asyncio.sleep(0.1)
        after = await robot.state()
        assert not after.is_moving
        assert after.joints_rad == pytest.approx(before.joints_rad, abs=self.joint_tolerance_rad)

    async def test_a_joint_move_ends_standing_at_its_target(self, robot: Robot) -> None:
        target = self.near(j1=0.2, j3=-0.1, j6=0.4)
        state = await robot.move_joints(target)
        assert not state.is_moving
        assert state.joints_rad == pytest.approx(target, abs=self.joint_tolerance_rad)
        now = await robot.state()
        assert now.joints_rad == pytest.approx(target, abs=self.joint_tolerance_rad)

    async def test_moving_to_where_it_is_changes_nothing(self, robot: Robot) -> None:
        target = self.near(j2=0.1)
        first = await robot.move_joints(target)
        second = await robot.move_joints(target)
        tolerance = self.joint_tolerance_rad
        assert second.joints_rad == pytest.approx(first.joints_rad, abs=tolerance)

    async def test_what_it_measures_is_where_it_is(self, robot: Robot, stage: Stage) -> None:
        await robot.move_joints(self.near(j1=-0.2, j5=0.1))
        state = await robot.state()
        true = await stage.true_joints_rad()
        assert state.joints_rad == pytest.approx(true, abs=self.joint_tolerance_rad)

    async def test_states_say_that_it_moves_and_their_stamps_grow(self, robot: Robot) -> None:
        motion = robot.move_joints(self.near(j1=0.4), speed=0.3)
        states = await self.watch(robot, motion)
        await motion
        assert any(state.is_moving for state in states)
        assert not (await robot.state()).is_moving
        assert (np.diff([state.stamp_s for state in states]) > 0).all()

    async def test_a_linear_move_keeps_to_the_line_and_to_its_speed(self, robot: Robot) -> None:
        start = (await robot.state()).T_base_tcp
        goal = shifted(start, (0.05, 0.10, -0.06))
        motion = robot.move_linear(goal, speed_mps=0.2)
        states = await self.watch(robot, motion)
        end = await motion
        assert end.T_base_tcp.matrix == pytest.approx(goal.matrix, abs=2 * self.path_tolerance_m)
        places = np.array([state.T_base_tcp.translation_m for state in states])
        stamps = np.array([state.stamp_s for state in states])
        assert distance_from_line(places, start, goal).max() < self.path_tolerance_m
        speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(stamps)
        assert speeds.max() < 0.2 * 1.05
        assert speeds.max() > 0.2 * 0.8

    async def test_a_circular_move_keeps_to_its_circle(self, robot: Robot) -> None:
        start = (await robot.state()).T_base_tcp
        via, goal = shifted(start, (0.0, 0.06, -0.06)), shifted(start, (0.0, 0.12, 0.0))
        motion = robot.move([CircularTarget(via, goal, speed_mps=0.2)])
        states = await self.watch(robot, motion)
        end = await motion
        assert end.T_base_tcp.matrix == pytest.approx(goal.matrix, abs=2 * self.path_tolerance_m)
        places = np.array([state.T_base_tcp.translation_m for state in states])
        centre = start.translation_m + (0.0, 0.06, 0.0)
        radii = np.linalg.norm(places - centre, axis=1)
        assert np.abs(radii - 0.06).max() < self.path_tolerance_m
        assert (places[:, 2] < centre[2] + self.path_tolerance_m).all()
        assert places[:, 2].min() < via.translation_m[2] + 0.01

    async def test_three_points_on_a_line_are_no_circle(self, robot: Robot) -> None:
        start = (await robot.state()).T_base_tcp
        via, goal = shifted(start, (0.0, 0.05, 0.0)), shifted(start, (0.0, 0.1, 0.0))
        with pytest.raises(UnreachableError):
            await robot.move([CircularTarget(via, goal)])

    async def test_a_linear_move_may_turn_the_tool(self, robot: Robot) -> None:
        start = (await robot.state()).T_base_tcp
        turn = Transform.from_quaternion("tcp", "tcp", (1, 0.05, 0.05, 0.15), (0, 0, 0))
        end = await robot.move_linear(start @ turn, speed_mps=0.2)
        wanted = (start @ turn).matrix
        assert end.T_base_tcp.matrix == pytest.approx(wanted, abs=5 * self.path_tolerance_m)

    async def test_out_of_reach_is_refused_before_anything_moves(self, robot: Robot) -> None:
        before = await robot.state()
        far = shifted(before.T_base_tcp, (3.0, 0.0, 0.0))
        with pytest.raises(UnreachableError):
            await robot.move([JointTarget(self.near(j1=0.3)), LinearTarget(far)])
        after = await robot.state()
        assert after.joints_rad == pytest.approx(before.joints_rad, abs=self.joint_tolerance_rad)

    async def test_nonsense_is_a_value_error_at_once(self, robot: Robot) -> None:
        here = (await robot.state()).T_base_tcp
        limits = robot.limits
        with pytest.raises(ValueError, match="joint 1"):
            robot.move_joints((limits.upper_rad[0] + 0.1, *self.home_rad[1:]))
        with pytest.raises(ValueError, match="joints"):
            robot.move_joints(self.home_rad[:-1])
        with pytest.raises(ValueError, match="target"):
            robot.move([])
        with pytest.raises(ValueError, match="speed"):
            robot.move_linear(here, speed_mps=limits.tcp_speed_mps * 2)
        with pytest.raises(ValueError, match="payload"):
            robot.set_load(Load(limits.payload_kg * 2))

    async def test_a_second_motion_is_refused_and_the_first_goes_on(self, robot: Robot) -> None:
        target = self.near(j1=0.3)
        first = robot.move_joints(target, speed=0.5)
        await asyncio.sleep(0.05)
        with pytest.raises(RejectedError) as caught:
            await robot.move_joints(self.home_rad)
        assert caught.value.code == "busy"
        state = await first
        assert state.joints_rad == pytest.approx(target, abs=self.joint_tolerance_rad)

    async def test_a_zone_is_passed_without_standing(self, robot: Robot) -> None:
        via, end = self.near(j1=0.3), self.near(j1=0.3, j2=0.3)
        motion = robot.move([JointTarget(via, zone_m=0.05), JointTarget(end)])
        states = await self.watch(robot, motion)
        state = await motion
        assert state.joints_rad == pytest.approx(end, abs=self.joint_tolerance_rad)
        steps = np.linalg.norm(np.diff([s.joints_rad for s in states], axis=0), axis=1)
        middle = steps[len(steps) // 4 : -len(steps) // 4]
        assert middle.min() > 0.1 * steps.max()

    async def test_without_a_zone_it_comes_to_a_stand_at_the_target(self, robot: Robot) -> None:
        via, end = self.near(j1=0.3), self.near(j1=0.3, j2=0.3)
        motion = robot.move([JointTarget(via), JointTarget(end)])
        states = await self.watch(robot, motion)
        await motion
        away = np.abs(np.array([s.joints_rad for s in states]) - via).max(axis=1)
        steps = np.abs(np.diff([s.joints_rad for s in states], axis=0)).max(axis=1)
        assert away.min() < 0.01
        nearest = int(away.argmin())
        assert steps[max(0, nearest - 2) : nearest + 2].min() < 0.1 * steps.max()

    async def test_half_the_speed_takes_longer(self, robot: Robot) -> None:
        durations = []
        for speed, target in ((0.2, self.near(j1=0.4)), (0.1, self.home_rad)):
            motion = robot.move_joints(target, speed=speed)
            stamp_s = (await robot.state()).stamp_s
            durations.append((await motion).stamp_s - stamp_s)
        assert durations[1] > 1.5 * durations[0]

    async def test_stop_brakes_and_the_motion_says_so(self, robot: Robot) -> None:
        target = self.near(j1=0.4)
        motion = robot.move_joints(target, speed=0.3)
        await asyncio.sleep(0.15)
        state = await robot.stop()
        assert not state.is_moving
        with pytest.raises(PreemptedError):
            await motion
        assert abs(state.joints_rad[0] - target[0]) > 0.05
        again = await robot.move_joints(target)
        assert again.joints_rad == pytest.approx(target, abs=self.joint_tolerance_rad)

    async def test_stop_when_standing_is_harmless(self, robot: Robot) -> None:
        before = await robot.state()
        state = await robot.stop()
        assert state.joints_rad == pytest.approx(before.joints_rad, abs=self.joint_tolerance_rad)
        await robot.move_joints(self.near(j1=0.05))

    async def test_stopping_keeps_to_the_path(self, robot: Robot) -> None:
        start = (await robot.state()).T_base_tcp
        goal = shifted(start, (0.0, 0.12, -0.08))
        motion = robot.move_linear(goal, speed_mps=0.25)
        await asyncio.sleep(0.25)
        state = await robot.stop()
        with pytest.raises(PreemptedError):
            await motion
        place = state.T_base_tcp.translation_m[None]
        assert distance_from_line(place, start, goal).max() < self.path_tolerance_m

    async def test_cancelling_a_motion_stops_the_arm(self, robot: Robot) -> None:
        target = self.near(j1=0.4)
        motion = robot.move_joints(target, speed=0.3)
        await asyncio.sleep(0.15)
        motion.cancel()
        with pytest.raises(asyncio.CancelledError):
            await motion
        first = await robot.state()
        assert abs(first.joints_rad[0] - target[0]) > 0.05
        await asyncio.sleep(0.2)
        second = await robot.state()
        assert not first.is_moving
        assert second.joints_rad == pytest.approx(first.joints_rad, abs=self.joint_tolerance_rad)
        await robot.move_joints(self.home_rad)

    async def test_a_timeout_around_a_motion_stops_the_arm(self, robot: Robot) -> None:
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.15):
                await robot.move_joints(self.near(j1=0.4), speed=0.2)
        state = await robot.state()
        assert not state.is_moving
        assert abs(state.joints_rad[0] - self.near(j1=0.4)[0]) > 0.05

    async def test_awaiting_a_motion_twice_is_harmless(self, robot: Robot) -> None:
        motion = robot.move_joints(self.near(j1=0.05))
        assert await motion is await motion
        assert motion.done()

    async def test_an_emergency_stop_ends_the_motion_and_locks_the_arm(
        self, robot: Robot, stage: Stage
    ) -> None:
        motion = robot.move_joints(self.near(j1=0.4), speed=0.3)
        await asyncio.sleep(0.15)
        await stage.press_emergency_stop()
        with pytest.raises(SafetyError):
            await motion
        state = await robot.state()
        assert state.emergency_stop
        assert not state.motors_on
        assert not state.may_move
        with pytest.raises(SafetyError):
            await robot.move_joints(self.home_rad)
        await stage.release_emergency_stop()
        assert (await robot.state()).may_move
        await robot.move_joints(self.home_rad)

    async def test_a_protective_stop_ends_the_motion_until_it_is_gone(
        self, robot: Robot, stage: Stage
    ) -> None:
        motion = robot.move_joints(self.near(j1=0.4), speed=0.3)
        await asyncio.sleep(0.15)
        await stage.press_protective_stop()
        with pytest.raises(SafetyError):
            await motion
        state = await robot.state()
        assert state.protective_stop
        assert not state.may_move
        with pytest.raises(SafetyError):
            await robot.move_joints(self.home_rad)
        await stage.release_protective_stop()
        await asyncio.sleep(0.1)
        standing = await robot.state()
        assert not standing.is_moving  # it never goes on by itself
        await robot.move_joints(self.home_rad)

    async def test_without_motors_a_motion_is_refused(self, robot: Robot, stage: Stage) -> None:
        await stage.switch_motors(False)
        assert not (await robot.state()).may_move
        with pytest.raises(RejectedError) as caught:
            await robot.move_joints(self.near(j1=0.1))
        assert caught.value.code == "motors off"
        await stage.switch_motors(True)
        await robot.move_joints(self.near(j1=0.1))

    async def test_in_manual_mode_a_motion_is_refused(self, robot: Robot, stage: Stage) -> None:
        await stage.turn_key(OperatingMode.MANUAL_REDUCED)
        assert (await robot.state()).mode is OperatingMode.MANUAL_REDUCED
        with pytest.raises(RejectedError) as caught:
            await robot.move_joints(self.near(j1=0.1))
        assert caught.value.code == "not in auto"
        await stage.turn_key(OperatingMode.AUTO)
        await robot.move_joints(self.near(j1=0.1))

    async def test_a_tool_moves_the_tool_centre_point(self, robot: Robot) -> None:
        T_flange_tcp = Transform.from_translation("flange", "tcp", (0.01, -0.02, 0.25))
        T_flange_other = Transform.from_translation("flange", "tcp", (0.0, 0.0, 0.0))
        await robot.set_tool(Tool(T_flange_other))
        T_base_flange = (await robot.state()).T_base_tcp.renamed("base", "flange")
        await robot.set_tool(Tool(T_flange_tcp))
        wanted = (T_base_flange @ T_flange_tcp).matrix
        assert (await robot.state()).T_base_tcp.matrix == pytest.approx(wanted, abs=1e-4)

    async def test_a_tool_is_not_changed_while_moving(self, robot: Robot) -> None:
        motion = robot.move_joints(self.near(j1=0.3), speed=0.3)
        await asyncio.sleep(0.05)
        with pytest.raises(RejectedError) as caught:
            await robot.set_tool(Tool(Transform.identity("flange", "tcp")))
        assert caught.value.code == "busy"
        await motion

    async def test_a_load_within_the_payload_is_taken(self, robot: Robot) -> None:
        await robot.set_load(Load(robot.limits.payload_kg / 10, (0.0, 0.0, 0.1)))
        await robot.set_load(Load())

    async def test_a_link_cut_in_motion_is_an_error_and_the_arm_stops(
        self, robot: Robot, stage: Stage
    ) -> None:
        motion = robot.move_joints(self.near(j1=0.4), speed=0.2)
        await asyncio.sleep(0.15)
        await stage.cut_link()
        with pytest.raises(LinkError):
            await motion
        await asyncio.sleep(0.5)
        first = await stage.true_joints_rad()
        await asyncio.sleep(0.2)
        second = await stage.true_joints_rad()
        assert second == pytest.approx(first, abs=self.joint_tolerance_rad)
        await stage.restore_link()
        await robot.open()
        await robot.move_joints(self.home_rad)

    async def test_closing_in_motion_stops_the_arm(self, robot: Robot, stage: Stage) -> None:
        motion = robot.move_joints(self.near(j1=0.4), speed=0.2)
        await asyncio.sleep(0.15)
        await robot.close()
        with pytest.raises((PreemptedError, LinkError)):
            await motion
        first = await stage.true_joints_rad()
        await asyncio.sleep(0.2)
        second = await stage.true_joints_rad()
        assert second == pytest.approx(first, abs=self.joint_tolerance_rad)

    async def test_a_closed_robot_takes_no_motion(self, robot: Robot) -> None:
        await robot.close()
        with pytest.raises(LinkError):
            await robot.move_joints(self.home_rad)
        with pytest.raises(LinkError):
            await robot.state()


def shifted(T_base_tcp: Transform, by_m: tuple[float, float, float]) -> Transform:
    """The same orientation, moved in the base frame."""
    place = T_base_tcp.translation_m + np.array(by_m)
    return Transform.from_parts("base", "tcp", T_base_tcp.rotation, place)


def distance_from_line(
    places_m: NDArray[np.float64], start: Transform, goal: Transform
) -> NDArray[np.float64]:
    """Distances of (N, 3) places from the line between two poses, shape (N,)."""
    along = goal.translation_m - start.translation_m
    along = along / np.linalg.norm(along)
    away = places_m - start.translation_m
    return np.asarray(np.linalg.norm(away - (away @ along)[:, None] * along, axis=1))
