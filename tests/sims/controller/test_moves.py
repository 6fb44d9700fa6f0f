"""Programs move the arm: where, how, and when the program goes on."""

import asyncio

import numpy as np
import pytest

TO_HOME = """
    MoveAbsJ HOME, v1000, fine, tTool;
    p0 := CRobT(\\Tool:=tTool \\WObj:=wobj0);
"""


def program(*lines, errors=""):
    body = "\n".join(f"    {line}" for line in lines)
    handler = f"  ERROR\n{errors}" if errors else ""
    return f"  PROC main()\n{TO_HOME}{body}\n    phase := 99;\n    EXIT;\n{handler}  ENDPROC\n"


CAUGHT = """
    errno_seen := ERRNO;
    TRYNEXT;
"""


def run(bench, *lines, errors="", data="", **changes):
    made = bench(data + program(*lines, errors=errors), **changes)

    async def play(b):
        b.record()
        await b.start()
        await b.ended()
        return b

    return made.run(play)


def off_line(places, a, b):
    along = (b - a) / np.linalg.norm(b - a)
    away = places - a
    return np.linalg.norm(away - (away @ along)[:, None] * along, axis=1)


@pytest.mark.parametrize("speed", ["v100", "v500", "v1500"])
def test_a_line_between_fine_points_is_kept_to_a_twentieth_of_a_millimetre(bench, speed):
    b = run(bench, f"MoveL Offs(p0, 0, 300, -100), {speed}, fine, tTool;")
    assert b.value("phase") == 99
    start = np.array(b.value("p0")[0]) / 1e3
    goal = start + (0, 0.3, -0.1)
    assert off_line(b.places, start, goal).max() < 5e-5
    assert b.place == pytest.approx(goal, abs=2e-5)


def test_with_a_zone_the_program_is_ahead_of_the_arm(bench):
    made = bench(
        program(
            "MoveL Offs(p0, 0, 200, 0), v200, z20, tTool;",
            "phase := 1;",
            "MoveL Offs(p0, 0, 200, -150), v200, fine, tTool;",
        )
    )

    async def play(b):
        b.record()
        await b.start()
        await b.until(lambda: b.value("phase") >= 1)
        assert np.linalg.norm(b.place * 1e3 - b.value("p0")[0]) < 5.0
        await b.ended()
        corner = np.array(b.value("p0")[0]) / 1e3 + (0, 0.2, 0)
        nearest = np.linalg.norm(b.places - corner, axis=1).min()
        assert 0.001 < nearest < 0.02
        assert 50024 not in b.numbers

    made.run(play)


def test_at_a_fine_point_the_program_waits_for_the_arm(bench):
    made = bench(program("MoveL Offs(p0, 0, 200, 0), v200, fine, tTool;", "phase := 1;"))

    async def play(b):
        await b.start()
        await b.until(lambda: b.value("phase") >= 1)
        assert b.place * 1e3 == pytest.approx(np.array(b.value("p0")[0]) + (0, 200, 0), abs=0.05)
        assert b.speed == 0

    made.run(play)


def test_the_look_ahead_is_bounded(bench):
    made = bench(
        program(
            "FOR i FROM 1 TO 200 DO",
            "  phase := i;",
            "  MoveL Offs(p0, 0, i, 0), v50, z1, tTool;",
            "ENDFOR",
        )
    )

    async def play(b):
        await b.start()
        await b.until(lambda: b.value("phase") > 3)
        await asyncio.sleep(0.3)
        way = float(np.linalg.norm(b.place * 1e3 - b.value("p0")[0]))
        assert b.value("phase") - way < 45
        await b.ended()
        assert b.value("phase") == 99
        assert 50024 not in b.numbers

    made.run(play)


def test_a_zone_whose_next_move_is_late_becomes_a_stop_with_a_warning(bench):
    b = run(
        bench,
        "MoveL Offs(p0, 0, 100, 0), v200, z20, tTool;",
        "WaitTime 2;",
        "MoveL Offs(p0, 0, 100, -100), v200, fine, tTool;",
    )
    corner = np.array(b.value("p0")[0]) / 1e3 + (0, 0.1, 0)
    assert np.linalg.norm(b.places - corner, axis=1).min() < 2e-5
    assert 50024 in b.numbers


def test_a_circle_is_driven_round(bench):
    b = run(
        bench,
        "ConfL \\Off;",
        "MoveC Offs(p0, 50, 50, 0), Offs(p0, 0, 100, 0), v200, fine, tTool;",
    )
    centre = np.array(b.value("p0")[0]) / 1e3 + (0, 0.05, 0)
    assert np.linalg.norm(b.places - centre, axis=1) == pytest.approx(0.05, abs=5e-5)


def test_work_object_and_tool_are_taken_into_account(bench):
    made = bench(
        """
  PERS wobjdata wTable := [FALSE, TRUE, "", [[400, 100, 500], [0.7071068, 0, 0, 0.7071068]],
      [[0, 0, 0], [1, 0, 0, 0]]];
"""
        + program(
            "ConfJ \\Off;",
            "MoveJ [[-20, 30, 10], [0, 1, 0, 0], [0, 0, 0, 0], NONE], v500, fine, tTool "
            "\\WObj:=wTable;",
            "p0 := CRobT(\\Tool:=tTool \\WObj:=wTable);",
            "ConfL \\Off;",
            "MoveL Offs(p0, 50, 0, 20), v500, fine, tTool \\WObj:=wTable;",
        )
    )

    async def play(b):
        await b.start()
        await b.ended()
        assert b.value("phase") == 99
        assert b.place == pytest.approx((0.370, 0.130, 0.530), abs=3e-5)
        assert b.value("p0")[0] == pytest.approx((-20, 30, 10), abs=0.03)
        assert np.abs(b.value("p0")[1]) == pytest.approx((0, 1, 0, 0), abs=1e-4)

    made.run(play)


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("MoveL Offs(p0, 2000, 0, 0), v500, fine, tTool;", "ERR_OUTSIDE_REACH"),
        ("MoveJ Offs(p0, 2000, 0, 0), v500, fine, tTool;", "ERR_OUTSIDE_REACH"),
        ("MoveAbsJ [[0, 0, 0, 0, 150, 0], NONE], v500, fine, tTool;", "ERR_ROBLIMIT"),
        (
            "MoveJ [p0.trans, p0.rot, [9E9, 9E9, 9E9, 9E9], NONE], v500, fine, tTool;",
            "ERR_PATH_STOP",
        ),
        ("MoveAbsJ [[9E9, 0, 0, 0, 0, 0], NONE], v500, fine, tTool;", "ERR_ROBLIMIT"),
        ("MoveL p0, [0, 500, 5000, 1000], fine, tTool;", "ERR_ARGVALERR"),
        ("MoveL p0, v100 \\T:=0, fine, tTool;", "ERR_ARGVALERR"),
        (
            "MoveL [[1E37, -1E37, 1E37], p0.rot, p0.robconf, NONE], v100, fine, tTool;",
            "ERR_OUTSIDE_REACH",
        ),
        ("MoveC Offs(p0, 0, 50, 0), Offs(p0, 0, 100, 0), v200, fine, tTool;", "ERR_PATH_STOP"),
        (
            "MoveJ [p0.trans, p0.rot, [1, 0, 0, 0], NONE], v500, fine, tTool;",
            "ERR_PATH_STOP",
        ),
        (
            "MoveL [p0.trans, p0.rot, [1, 0, 0, 0], NONE], v500, fine, tTool;",
            "ERR_PATH_STOP",
        ),
        (
            "MoveL [p0.trans, [0, 0, 0, 0], p0.robconf, NONE], v500, fine, tTool;",
            "ERR_ARGVALERR",
        ),
    ],
)
def test_what_cannot_be_driven_is_an_error_at_the_instruction_and_moves_nothing(bench, line, name):
    b = run(bench, line, errors=CAUGHT)
    assert b.value("phase") == 99
    assert b.value("errno_seen") == b.value(name)
    start = np.array(b.value("p0")[0]) / 1e3
    assert b.place == pytest.approx(start, abs=2e-5)


def test_without_a_handler_such_an_error_stops_the_program_and_says_where(bench):
    b = run(bench, "MoveL Offs(p0, 2000, 0, 0), v500, fine, tTool;")
    assert b.value("phase") == 0
    assert b.controller.has_failed
    assert any("line" in line for entry in b.controller.log for line in entry.cause)


def test_conf_off_takes_the_nearest_posture(bench):
    b = run(
        bench,
        "ConfJ \\Off;",
        "MoveJ [[p0.trans.x, 100, p0.trans.z], p0.rot, [1, 1, 1, 0], NONE], v500, fine, tTool;",
    )
    assert b.value("phase") == 99
    assert np.abs(b.world.arm.measured_rad).max() < 2.0


def test_the_duration_overrides_the_speed(bench):
    made = bench(program("MoveL Offs(p0, 0, 200, 0), v50 \\T:=1, fine, tTool;", "phase := 1;"))

    async def play(b):
        await b.start()
        await b.until(lambda: b.speed > 0)
        began = b.loop.time()
        await b.until(lambda: b.value("phase") >= 1)
        assert 1.0 <= b.loop.time() - began < 1.35

    made.run(play)


def test_manual_reduced_speed_keeps_the_tool_below_a_quarter_metre_a_second(bench):
    from hal import OperatingMode

    made = bench(program("MoveL Offs(p0, 0, 300, 0), v1500, fine, tTool;"))

    async def play(b):
        b.controller.set_mode(OperatingMode.MANUAL_REDUCED)
        await asyncio.sleep(0.01)
        b.record()
        await b.start()
        await b.ended()
        speed = np.linalg.norm(np.diff(b.places, axis=0), axis=1) / 0.002
        assert 0.24 < speed.max() < 0.2525

    made.run(play)


def test_the_speed_ratio_slows_what_is_under_way(bench):
    made = bench(program("MoveL Offs(p0, 0, 300, 0), v500, fine, tTool;"))

    async def play(b):
        await b.start()
        await b.until(lambda: b.value("p0")[0][0] > 0 and b.speed > 0)
        await asyncio.sleep(0.25)
        fast = b.controller.unit.speed
        b.controller.set_speed_ratio(0.5)
        await asyncio.sleep(0.1)
        assert b.controller.unit.speed == pytest.approx(fast / 2, rel=0.1)
        b.controller.set_speed_ratio(0.0)
        await asyncio.sleep(0.2)
        assert b.speed == 0
        b.controller.set_speed_ratio(1.0)
        await b.ended()
        assert b.value("phase") == 99

    made.run(play)


def test_an_output_is_set_at_its_place_on_the_way(bench):
    made = bench(
        "  VAR triggdata io;\n"
        + program(
            "TriggIO io, 50 \\DOp:=do1, 1;",
            "TriggL Offs(p0, 0, 200, 0), v200, io, fine, tTool;",
        )
    )

    async def play(b):
        await b.start()
        await b.until(lambda: b.world.cabinet.outputs["do1"])
        goal = np.array(b.value("p0")[0]) + (0, 200, 0)
        assert np.linalg.norm(b.place * 1e3 - goal) == pytest.approx(50, abs=1.0)

    made.run(play)


def test_move_l_do_sets_its_output_in_the_corner(bench):
    made = bench(
        program(
            "MoveLDO Offs(p0, 0, 200, 0), v200, z20, tTool \\WObj:=wobj0, do2, 1;",
            "MoveL Offs(p0, 0, 200, -100), v200, fine, tTool;",
        )
    )

    async def play(b):
        await b.start()
        await b.until(lambda: b.world.cabinet.outputs["do2"])
        corner = np.array(b.value("p0")[0]) + (0, 200, 0)
        before, after = corner[1] - b.place[1] * 1e3, corner[2] - b.place[2] * 1e3
        assert 1 < before < 12
        assert before == pytest.approx(after, abs=1.6)  # half round, by joints

    made.run(play)


@pytest.mark.parametrize("line", ["WaitTime \\InPos, 0;", "WaitUntil \\InPos, TRUE;"])
def test_waits_in_position_begin_where_the_arm_stands(bench, line):
    made = bench(program("MoveL Offs(p0, 0, 200, 0), v200, z20, tTool;", line, "phase := 1;"))

    async def play(b):
        await b.start()
        await b.until(lambda: b.value("phase") >= 1)
        assert b.place * 1e3 == pytest.approx(np.array(b.value("p0")[0]) + (0, 200, 0), abs=0.05)

    made.run(play)
