"""The conformance suites and their plugin, tried on devices that break promises."""

import asyncio
from typing import ClassVar

import pytest

from hal import MoveResult, RobotState
from hal.conformance import Bench, GripperConformance, RobotConformance
from hal.conformance.base import cancel_all
from hal.errors import CellError
from sims.direct import DirectGripper, DirectRobot
from sims.direct.stage import WorldStage
from sims.loop import LockstepLoop
from sims.world import World, cylinders

pytest_plugins = ["pytester"]

MODULE = """
import pytest
from hal.conformance import Bench, IoConformance, Stage
from sims.direct import DirectIo
from sims.direct.stage import WorldStage
from sims.loop import LockstepLoop
from sims.world import World

class TestIo(IoConformance):
    backend = "some-io"
    lacks = {lacks}
    {body}

    def make_bench(self):
        world = World()
        io = DirectIo(world)
        stage = WorldStage(world, io.name) if {has_stage} else Stage()
        return Bench(LockstepLoop(world), io, stage)
"""


def run_suite(pytester, *, lacks="{}", body="", has_stage=True):
    pytester.makepyfile(MODULE.format(lacks=lacks, body=body, has_stage=has_stage))
    return pytester.runpytest_inprocess("-p", "hal.conformance.plugin", "-p", "no:cacheprovider")


def test_what_the_stage_cannot_do_must_be_declared(pytester):
    result = run_suite(pytester, has_stage=False, lacks='{"cut_link": "soldered in"}')
    result.assert_outcomes(passed=10, skipped=2, failed=4)
    result.stdout.fnmatch_lines(
        [
            "*the stage of some-io cannot set_input, and 'lacks' does not say so*",
            "promise * some-io",
            "a link cut while waiting is an error * -",
            "an input follows the world * BROKEN",
            "- some-io: a cut link is an error until it is reopened: soldered in",
        ]
    )


def test_a_promise_may_be_lacking_by_name_and_is_listed_with_its_reason(pytester):
    result = run_suite(pytester, lacks='{"test_a_pulse_rises_and_falls": "relay too slow"}')
    result.assert_outcomes(passed=15, skipped=1)
    result.stdout.fnmatch_lines(["- some-io: a pulse rises and falls: relay too slow"])


def test_a_skip_that_is_not_declared_fails(pytester):
    body = "pytestmark = pytest.mark.skipif(True, reason='not today')"
    result = run_suite(pytester, body=body)
    assert result.parseoutcomes()["errors"] == 16
    result.stdout.fnmatch_lines(["*a skip that 'lacks' does not declare*not today*"])


def test_an_inherited_promise_cannot_be_replaced():
    with pytest.raises(TypeError, match="test_speed_is_kept"):

        class Soft(GripperConformance):
            async def test_speed_is_kept(self, gripper):
                pass


def test_a_backend_cannot_add_promises_of_its_own():
    with pytest.raises(TypeError, match="test_mine"):

        class More(GripperConformance):
            backend = "some-gripper"

            async def test_mine(self, gripper):
                pass


class LyingGripper(DirectGripper):
    """Says it is there without going."""

    async def _move_to(self, width_m, speed_mps, force_n):
        return MoveResult(width_m, False)


class DeafRobot(DirectRobot):
    """Does not hear of stops, and drives on."""

    def _check_safe(self):
        pass

    async def _stop(self) -> RobotState:
        return self._state()

    async def _move(self, targets):
        try:
            return await asyncio.shield(asyncio.ensure_future(super()._move(targets)))
        except asyncio.CancelledError:
            raise


class OnGripper(GripperConformance):
    make: ClassVar[type] = LyingGripper

    def make_bench(self) -> Bench:
        world = World(shape=cylinders([-0.03, 0.03], [0.010]), parts=1)
        gripper = self.make(world)
        return Bench(LockstepLoop(world), gripper, WorldStage(world, gripper.name))


class OnRobot(RobotConformance):
    def make_bench(self) -> Bench:
        world = World()
        robot = DeafRobot(world)
        return Bench(LockstepLoop(world), robot, WorldStage(world, robot.name))


@pytest.mark.parametrize(
    ("suite", "promise"),
    [
        (OnGripper(), "test_it_moves_to_a_width"),
        (OnGripper(), "test_speed_is_kept"),
        (OnGripper(), "test_what_blocks_the_fingers_is_said"),
        (OnRobot(), "test_stop_brakes_and_the_motion_says_so"),
        (OnRobot(), "test_cancelling_a_motion_stops_the_arm"),
        (OnRobot(), "test_an_emergency_stop_ends_the_motion_and_locks_the_arm"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_device_that_lies_is_found_out(suite, promise):
    bench = suite.make_bench()
    test = getattr(suite, promise)
    names = test.__code__.co_varnames[1 : test.__code__.co_argcount]
    arguments = {name: bench.stage if name == "stage" else bench.device for name in names}

    async def try_it():
        await bench.device.open()
        await suite.prepare(bench.device)
        await test(**arguments)

    try:
        with pytest.raises((AssertionError, pytest.fail.Exception, CellError)):
            bench.loop.run_until_complete(try_it())
    finally:
        cancel_all(bench.loop)
        bench.loop.close()
