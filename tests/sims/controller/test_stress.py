"""An operator who presses everything at any time: the arm stays within its limits, and arrives."""

import asyncio
import random

import numpy as np
import pytest

from sims.controller import StartRefusedError

TOUR = """
  PROC main()
    MoveAbsJ HOME, v1000, fine, tTool;
    p0 := CRobT(\\Tool:=tTool \\WObj:=wobj0);
    ConfL \\Off;
    FOR i FROM 1 TO 4 DO
      MoveL Offs(p0, 0, 120, 0), v800, z20, tTool;
      MoveL Offs(p0, 0, 120, -100), v800, z5, tTool;
      MoveJ Offs(p0, 60, 0, -100), v1000, z50, tTool;
      MoveC Offs(p0, 30, -30, -60), Offs(p0, 0, 0, -20), v400, z10, tTool;
      MoveAbsJ [[40, 0, 0, 0, 80, 20], NONE], v2000, z20, tTool;
      MoveL p0, v800, fine, tTool;
      phase := i;
    ENDFOR
    phase := 99;
    EXIT;
  ENDPROC
"""


async def press(b, hand):
    c = b.controller
    match hand.randrange(6):
        case 0:
            await c.stop()
        case 1:
            c.press_emergency_stop()
            await asyncio.sleep(hand.random() * 0.3)
            c.release_emergency_stop()
        case 2:
            c.set_guard(True)
            await asyncio.sleep(hand.random() * 0.1)
            c.set_guard(False)
        case 3:
            c.set_speed_ratio(hand.choice([0.0, 0.1, 0.5, 1.0]))
        case 4:
            c.motors_off()
        case 5:
            c.unit.hold("hand")
            await asyncio.sleep(hand.random() * 0.05)
            c.unit.release("hand")


async def set_right(b):
    c = b.controller
    c.motors_on()
    c.look()
    try:
        await c.start()
    except StartRefusedError:
        return


@pytest.mark.parametrize("seed", range(12))
def test_whatever_is_pressed_the_arm_keeps_its_limits_and_the_program_ends_where_it_should(
    bench, seed
):
    hand = random.Random(seed)
    targets = []

    def note(b):
        targets.append(np.array(b.world.arm.target_rad))
        return False

    async def play(b):
        b.world.until(lambda: note(b))
        await b.start()
        for _ in range(25):
            await asyncio.sleep(hand.random() * 0.4)
            await press(b, hand)
            if hand.random() < 0.7:
                await asyncio.sleep(hand.random() * 0.2)
                await set_right(b)
            if b.value("phase") == 99:
                break
        b.controller.set_speed_ratio(1.0)
        while b.value("phase") != 99:
            await set_right(b)
            await asyncio.sleep(0.5)
        limits = b.world.arm_model
        rows = np.array(targets)
        speed = np.diff(rows, axis=0) / 0.002
        change = np.diff(speed, axis=0) / 0.002
        assert (np.abs(speed) <= np.array(limits.limits.speed_radps)).all()
        assert (np.abs(change) <= 1.02 * np.array(limits.accelerations_radps2)).all()
        assert 50204 not in b.numbers
        goal = np.array(b.value("p0")[0]) / 1e3
        await b.until(lambda: b.controller.unit.is_standing)
        assert b.place == pytest.approx(goal, abs=3e-5)

    bench(TOUR).run(play, limit_s=300)
