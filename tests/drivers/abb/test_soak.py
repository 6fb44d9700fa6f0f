"""Stops, drops and second thoughts at random: nothing moves by itself, nothing dies."""

import asyncio
import contextlib
import random

import pytest

from hal import OperatingMode
from hal.errors import CellError
from tests.drivers.abb.cell import HOME, THERE, run


async def abort_motion_link(cell):
    channel = cell.robot._link._channel if cell.robot._link is not None else None
    if channel is not None:
        channel._transport.abort()


async def stop_and_start(cell):
    await cell.controller.stop()
    await asyncio.sleep(0.003)
    await cell.controller.start()


async def at_once(act, *arguments):
    act(*arguments)


TROUBLES = {
    "emergency stop": lambda cell, _: at_once(cell.controller.press_emergency_stop),
    "guard": lambda cell, _: at_once(cell.controller.set_guard, True),
    "motors": lambda cell, _: at_once(cell.controller.motors_off),
    "key": lambda cell, _: at_once(cell.controller.set_mode, OperatingMode.MANUAL_REDUCED),
    "program stop": lambda cell, _: cell.controller.stop(),
    "stop and start": lambda cell, _: stop_and_start(cell),
    "drop": lambda cell, _: at_once(cell.network.drop_all),
    "half-close": lambda cell, _: at_once(cell.network.silence_all),
    "motion link": lambda cell, _: abort_motion_link(cell),
    "cancel": lambda _, motion: at_once(motion.cancel),
    "stop": lambda cell, _: cell.robot.stop(),
    "close": lambda cell, _: cell.robot.close(),
}


async def one_round(cell, rng):
    """One motion, one to three troubles in it; returns what went wrong."""
    names = [rng.choice(list(TROUBLES)) for _ in range(rng.randint(1, 3))]
    await cell.robot.open()
    target = THERE if abs(cell.joints_rad[0]) < 0.25 else HOME
    motion = cell.robot.move_joints(target, speed=0.05)
    await asyncio.sleep(rng.random() * rng.choice([0.004, 0.02, 0.4]))
    for name in names:
        with contextlib.suppress(CellError):
            await TROUBLES[name](cell, motion)
        await asyncio.sleep(rng.random() * rng.choice([0.0, 0.001, 0.02]))
    done, _ = await asyncio.wait([motion._task], timeout=8.0)
    assert done, f"{names}: the motion does not end"
    if not motion._task.cancelled():
        error = motion._task.exception()
        assert error is None or isinstance(error, CellError), f"{names}: {error!r}"
    assert await cell.stands(), f"{names}: the arm goes on"
    await mended(cell, names)


async def mended(cell, names):
    """Everything is put right and started: it stays where it is, and works."""
    cell.controller.set_mode(OperatingMode.AUTO)
    cell.controller.set_guard(False)
    await asyncio.sleep(0.05)
    before = cell.joints_rad
    await cell.start()
    await asyncio.sleep(0.5)
    assert abs(cell.joints_rad - before).max() < 1e-3, f"{names}: it moved when it was started"
    assert cell.controller.is_running, (
        f"{names}: the program died: {list(cell.controller.log)[-2:]}"
    )
    await cell.robot.open()
    state = await cell.robot._session.fresh_state()
    assert state.active == 0, f"{names}: motion {state.active} is said to be under way"


def soak(seed, rounds):
    async def main(cell):
        rng = random.Random(seed)
        for _ in range(rounds):
            await one_round(cell, rng)
        assert await cell.is_well()

    run(main)


@pytest.mark.parametrize("seed", range(4))
def test_whatever_comes_between_the_arm_never_goes_on_by_itself(seed):
    soak(seed, 12)


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("seed", range(10, 20))
def test_whatever_comes_for_long_the_arm_never_goes_on_by_itself(seed):
    soak(seed, 100)
