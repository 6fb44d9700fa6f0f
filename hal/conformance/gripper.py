"""The promises of ``hal.Gripper``."""

import asyncio
from typing import Any, ClassVar

import pytest

from hal.conformance.base import Conformance
from hal.conformance.stage import Stage
from hal.errors import FaultError, LinkError, PreemptedError, RejectedError
from hal.gripper import GraspOutcome, Gripper, GripperEvent, GripperMode

__all__ = ["GripperConformance"]


class GripperConformance(Conformance):
    """The fingers must be free to go through their whole stroke."""

    interface = "gripper"
    width_tolerance_m: ClassVar[float] = 1e-4
    size_tolerance_m: ClassVar[float] = 1e-4
    force_tolerance_n: ClassVar[float] = 5.0
    part_m: ClassVar[float] = 0.020
    force_n: ClassVar[float] = 80.0

    @pytest.fixture
    def gripper(self, device: Gripper) -> Gripper:
        return device

    async def prepare(self, device: Any) -> None:
        await device.home()
        await device.move_to(device.limits.stroke_m)

    async def hold(self, gripper: Gripper, stage: Stage) -> None:
        """Hold a part."""
        await stage.place_part(self.part_m)
        result = await gripper.grasp(expected_m=self.part_m, force_n=self.force_n)
        assert result.outcome is GraspOutcome.HELD

    @pytest.mark.unprepared
    async def test_opening_moves_nothing_and_never_homes(
        self, gripper: Gripper, stage: Stage
    ) -> None:
        before = await stage.true_width_m()
        await gripper.close()
        await gripper.open()
        await asyncio.sleep(0.2)
        assert await stage.true_width_m() == pytest.approx(before, abs=self.width_tolerance_m)
        assert not (await gripper.state()).is_homed

    @pytest.mark.unprepared
    async def test_unhomed_it_refuses_to_move(self, gripper: Gripper) -> None:
        for motion in (gripper.move_to(0.02), gripper.grasp(), gripper.release()):
            with pytest.raises(RejectedError) as caught:
                await motion
            assert caught.value.code == "not homed"

    @pytest.mark.unprepared
    async def test_homing_finds_the_stroke(self, gripper: Gripper) -> None:
        result = await gripper.home()
        assert result.stroke_m == pytest.approx(gripper.limits.stroke_m, abs=5e-4)
        assert (await gripper.state()).is_homed

    @pytest.mark.unprepared
    async def test_homing_against_a_block_is_a_fault_until_it_is_cleared(
        self, gripper: Gripper, stage: Stage
    ) -> None:
        await stage.block_fingers(0.015)
        with pytest.raises(FaultError):
            await gripper.home()
        state = await gripper.state()
        assert state.mode is GripperMode.FAULT
        assert state.fault
        with pytest.raises(FaultError):
            await gripper.move_to(0.02)
        await stage.unblock_fingers()
        await gripper.clear_fault()
        assert not (await gripper.state()).fault
        await gripper.home()
        assert (await gripper.state()).is_homed

    async def test_it_moves_to_a_width(self, gripper: Gripper, stage: Stage) -> None:
        for width_m in (0.020, 0.005, 0.030):
            result = await gripper.move_to(width_m)
            assert not result.is_blocked
            assert result.width_m == pytest.approx(width_m, abs=self.width_tolerance_m)
            true_m = await stage.true_width_m()
            assert true_m == pytest.approx(width_m, abs=self.width_tolerance_m)

    async def test_saying_it_twice_changes_nothing(self, gripper: Gripper) -> None:
        first = await gripper.move_to(0.020, force_n=self.force_n)
        assert await gripper.move_to(0.020, force_n=self.force_n) == first

    async def test_outside_its_limits_is_a_value_error_at_once(self, gripper: Gripper) -> None:
        limits = gripper.limits
        with pytest.raises(ValueError, match="width"):
            gripper.move_to(limits.stroke_m * 1.1)
        with pytest.raises(ValueError, match="width"):
            gripper.move_to(-0.001)
        with pytest.raises(ValueError, match="force"):
            gripper.move_to(0.01, force_n=limits.max_force_n * 1.1)
        with pytest.raises(ValueError, match="force"):
            gripper.grasp(force_n=limits.min_force_n * 0.9)
        with pytest.raises(ValueError, match="speed"):
            gripper.grasp(speed_mps=limits.max_speed_mps * 1.1)
        with pytest.raises(ValueError, match="width"):
            gripper.grasp(expected_m=limits.stroke_m * 1.1)
        with pytest.raises(ValueError, match="width"):
            gripper.release(width_m=limits.stroke_m * 1.1)

    async def test_speed_is_kept(self, gripper: Gripper) -> None:
        await gripper.move_to(0.030)
        began_s = (await gripper.state()).stamp_s
        await gripper.move_to(0.020, speed_mps=0.010)
        took_s = (await gripper.state()).stamp_s - began_s
        assert 1.0 <= took_s < 1.5

    async def test_what_blocks_the_fingers_is_said(self, gripper: Gripper, stage: Stage) -> None:
        await stage.block_fingers(0.012)
        result = await gripper.move_to(0.005)
        assert result.is_blocked
        assert result.width_m == pytest.approx(0.012, abs=5e-4)
        await stage.unblock_fingers()
        assert not (await gripper.move_to(0.005)).is_blocked

    async def test_a_part_is_held_and_measured(self, gripper: Gripper, stage: Stage) -> None:
        await stage.place_part(self.part_m)
        result = await gripper.grasp(expected_m=self.part_m, force_n=self.force_n)
        assert result.outcome is GraspOutcome.HELD
        assert result.is_held
        assert result.size_m == pytest.approx(self.part_m, abs=self.size_tolerance_m)
        assert result.force_n == pytest.approx(self.force_n, abs=self.force_tolerance_n)
        state = await gripper.state()
        assert state.mode is GripperMode.HOLDING
        assert state.size_m == result.size_m
        assert state.force_n == pytest.approx(self.force_n, abs=self.force_tolerance_n)

    async def test_without_an_expectation_any_part_will_do(
        self, gripper: Gripper, stage: Stage
    ) -> None:
        await stage.place_part(self.part_m)
        assert (await gripper.grasp()).is_held

    async def test_another_size_is_the_wrong_part(self, gripper: Gripper, stage: Stage) -> None:
        await stage.place_part(self.part_m)
        result = await gripper.grasp(expected_m=self.part_m + 0.004)
        assert result.outcome is GraspOutcome.WRONG_PART
        assert result.size_m == pytest.approx(self.part_m, abs=self.size_tolerance_m)
        assert (await gripper.state()).mode is GripperMode.WRONG_PART

    async def test_the_window_decides_and_has_two_sides(
        self, gripper: Gripper, stage: Stage
    ) -> None:
        await stage.place_part(self.part_m)
        wide = {"inner_tolerance_m": 0.003, "outer_tolerance_m": 1e-4}
        narrow = {"inner_tolerance_m": 1e-4, "outer_tolerance_m": 0.003}
        expected_m = self.part_m + 0.002
        assert (await gripper.grasp(expected_m=expected_m, **wide)).is_held
        result = await gripper.grasp(expected_m=expected_m, **narrow)
        assert result.outcome is GraspOutcome.WRONG_PART

    async def test_nothing_there_is_no_part(self, gripper: Gripper) -> None:
        result = await gripper.grasp(expected_m=self.part_m)
        assert result.outcome is GraspOutcome.NO_PART
        assert (await gripper.state()).mode is GripperMode.NO_PART
        assert (await gripper.state()).width_m == pytest.approx(0, abs=self.width_tolerance_m)

    async def test_release_opens_fully_or_to_a_width(self, gripper: Gripper, stage: Stage) -> None:
        await self.hold(gripper, stage)
        result = await gripper.release(width_m=0.028)
        assert result.width_m == pytest.approx(0.028, abs=self.width_tolerance_m)
        result = await gripper.release()
        stroke_m = gripper.limits.stroke_m
        assert result.width_m == pytest.approx(stroke_m, abs=self.width_tolerance_m)
        assert (await gripper.state()).mode is GripperMode.READY

    async def test_stop_keeps_a_held_part(self, gripper: Gripper, stage: Stage) -> None:
        await self.hold(gripper, stage)
        await gripper.stop()
        await asyncio.sleep(0.3)
        state = await gripper.state()
        assert state.mode is GripperMode.HOLDING
        assert state.force_n == pytest.approx(self.force_n, abs=self.force_tolerance_n)

    async def test_stop_stops_the_fingers(self, gripper: Gripper) -> None:
        motion = gripper.move_to(0.0, speed_mps=0.010)
        await asyncio.sleep(0.5)
        await gripper.stop()
        with pytest.raises(PreemptedError):
            await motion
        first = await gripper.state()
        await asyncio.sleep(0.2)
        second = await gripper.state()
        assert first.width_m is not None
        assert first.width_m > 0.02
        assert second.width_m == pytest.approx(first.width_m, abs=self.width_tolerance_m)

    async def test_a_newer_command_takes_the_olders_place(self, gripper: Gripper) -> None:
        older = gripper.move_to(0.0, speed_mps=0.010)
        await asyncio.sleep(0.2)
        newer = gripper.move_to(0.030)
        with pytest.raises(PreemptedError):
            await older
        assert (await newer).width_m == pytest.approx(0.030, abs=self.width_tolerance_m)

    async def test_cancelling_stops_the_fingers(self, gripper: Gripper) -> None:
        motion = gripper.move_to(0.0, speed_mps=0.010)
        await asyncio.sleep(0.3)
        motion.cancel()
        with pytest.raises(asyncio.CancelledError):
            await motion
        await asyncio.sleep(0.05)
        first = (await gripper.state()).width_m
        await asyncio.sleep(0.3)
        assert (await gripper.state()).width_m == pytest.approx(first, abs=self.width_tolerance_m)

    async def test_a_lost_part_is_an_event(self, gripper: Gripper, stage: Stage) -> None:
        await self.hold(gripper, stage)
        heard: list[GripperEvent] = []
        gripper.on_event(heard.append)
        await stage.pull_part()
        async with asyncio.timeout(2.0):
            while GripperEvent.PART_LOST not in heard:
                await asyncio.sleep(0.01)
        assert (await gripper.state()).mode is GripperMode.PART_LOST

    async def test_who_stops_listening_hears_nothing(self, gripper: Gripper, stage: Stage) -> None:
        await self.hold(gripper, stage)
        heard: list[GripperEvent] = []
        end = gripper.on_event(heard.append)
        end()
        end()
        await stage.pull_part()
        await asyncio.sleep(1.0)
        assert heard == []

    async def test_homing_while_holding_must_be_forced(
        self, gripper: Gripper, stage: Stage
    ) -> None:
        await self.hold(gripper, stage)
        with pytest.raises(RejectedError) as caught:
            await gripper.home()
        assert caught.value.code == "holding"
        assert (await gripper.state()).mode is GripperMode.HOLDING

    async def test_a_cut_link_ends_the_motion_and_is_an_event(
        self, gripper: Gripper, stage: Stage
    ) -> None:
        heard: list[GripperEvent] = []
        gripper.on_event(heard.append)
        motion = gripper.move_to(0.0, speed_mps=0.010)
        await asyncio.sleep(0.2)
        await stage.cut_link()
        with pytest.raises(LinkError):
            await motion
        await asyncio.sleep(0.1)
        assert heard == [GripperEvent.LINK_LOST]

    async def test_without_a_link_a_held_part_stays_held(
        self, gripper: Gripper, stage: Stage
    ) -> None:
        await self.hold(gripper, stage)
        await stage.cut_link()
        await asyncio.sleep(0.5)
        await stage.restore_link()
        await gripper.open()
        assert (await gripper.state()).mode is GripperMode.HOLDING

    async def test_a_closed_gripper_takes_no_command(self, gripper: Gripper) -> None:
        await gripper.close()
        for motion in (gripper.move_to(0.02), gripper.grasp(), gripper.home(), gripper.stop()):
            with pytest.raises(LinkError):
                await motion
        with pytest.raises(LinkError):
            await gripper.state()

    async def test_stamps_grow(self, gripper: Gripper) -> None:
        first = await gripper.state()
        await asyncio.sleep(0.1)
        second = await gripper.state()
        assert second.stamp_s > first.stamp_s
