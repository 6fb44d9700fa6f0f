"""Program displacement moves the program, and CRobT sees what the program sees."""

import numpy as np
import pytest

from sims.rapid.library import quaternions as q
from tests.sims.controller.test_moves import run

DOWN_90 = [0.7071068, 0, 0, 0.7071068]


def placed(b, name):
    return np.array(b.value(name)[0])


def test_a_displaced_target_is_reached_shifted_and_read_back_as_programmed(bench):
    b = run(
        bench,
        "PDispSet [[0, 50, -20], [1, 0, 0, 0]];",
        "MoveL p0, v500, fine, tTool;",
        "p1 := CRobT(\\Tool:=tTool \\WObj:=wobj0);",
        "p2 := ORobT(p1);",
        "shown := C_PROGDISP.pdisp;",
        "PDispOff;",
        "p3 := CRobT(\\Tool:=tTool \\WObj:=wobj0);",
        data="VAR robtarget p1; VAR robtarget p2; VAR robtarget p3; VAR pose shown;",
    )
    start = placed(b, "p0")
    assert b.place * 1e3 == pytest.approx(start + (0, 50, -20), abs=0.05)
    assert placed(b, "p1") == pytest.approx(start, abs=0.05)
    assert placed(b, "p2") == pytest.approx(start + (0, 50, -20), abs=0.05)
    assert placed(b, "p3") == pytest.approx(start + (0, 50, -20), abs=0.05)
    assert b.value("shown") == [[0, 50, -20], [1, 0, 0, 0]]


def test_pdispon_takes_the_programmed_point_to_where_the_tool_is(bench):
    b = run(
        bench,
        "PDispOn Offs(p0, 0, 0, 80), tTool;",
        "MoveL Offs(p0, 0, 100, 80), v500, fine, tTool;",
    )
    assert b.place * 1e3 == pytest.approx(placed(b, "p0") + (0, 100, 0), abs=0.05)


def test_with_rot_the_displacement_turns_what_is_programmed(bench):
    b = run(
        bench,
        "turned := Offs(p0, 0, 20, 0); turned.rot := p0.rot * OrientZYX(30, 0, 0);",
        "PDispOn \\Rot \\ExeP:=turned, p0, tTool;",
        "ConfJ \\Off;",
        "MoveJ Offs(p0, 60, 0, -50), v500, fine, tTool;",
        data="VAR robtarget turned;",
    )
    start, turned = b.value("p0"), b.value("turned")
    turn = q.product(turned[1], q.conjugate(start[1]))
    expected = np.array(turned[0]) + q.rotated(turn, [60, 0, -50])
    assert b.place * 1e3 == pytest.approx(expected, abs=0.05)


def test_axis_moves_are_not_displaced_and_pp_to_main_ends_it(bench):
    b = run(bench, "PDispSet [[0, 50, 0], [1, 0, 0, 0]];", "MoveAbsJ HOME, v1000, fine, tTool;")
    assert np.degrees(b.world.arm.measured_rad) == pytest.approx([0, 0, 0, 0, 90, 0], abs=0.01)
    b.loop.run_until_complete(b.controller.restart())
    assert (b.controller.mechanics.settings.T_object_shown == np.eye(4)).all()
    b.loop.run_until_complete(b.controller.power_off())


def test_calcrobt_and_calcjointt_agree_under_a_displacement(bench):
    b = run(
        bench,
        "PDispSet [[0, 50, 0], [1, 0, 0, 0]];",
        "there := CalcRobT(HOME, tTool);",
        "back := CalcJointT(there, tTool);",
        data="VAR robtarget there; VAR jointtarget back;",
    )
    assert placed(b, "there") == pytest.approx(placed(b, "p0") - (0, 50, 0), abs=0.05)
    assert b.value("back")[0] == pytest.approx([0, 0, 0, 0, 90, 0], abs=1e-3)


@pytest.mark.parametrize(
    ("line", "phase"),
    [
        ("EOffsSet [0, 0, 0, 0, 0, 0];", 99),
        ("EOffsSet NONE;", 99),
        ("EOffsOn \\ExeP:=p0, p0;", 99),
        ("EOffsSet [5, 0, 0, 0, 0, 0];", 0),
    ],
)
def test_offsets_of_axes_that_are_not_there_have_to_be_none(bench, line, phase):
    assert run(bench, line, "EOffsOff;").value("phase") == phase


def test_defdframe_takes_the_old_points_to_the_new_ones(bench):
    b = run(
        bench,
        "d := DefDFrame(p0, Offs(p0,100,0,0), Offs(p0,0,100,0),",
        "  Offs(p0,5,0,0), Offs(p0,5,100,0), Offs(p0,-95,0,0));",
        "at := PoseVect(d, p0.trans); along := PoseVect(d, p0.trans + [100, 0, 0]);",
        data="VAR pose d; VAR pos at; VAR pos along;",
    )
    start = placed(b, "p0")
    assert b.value("at") == pytest.approx(start + (5, 0, 0), abs=1e-2)
    assert b.value("along") == pytest.approx(start + (5, 100, 0), abs=1e-2)


def test_mirpos_mirrors_the_place_and_two_axes(bench):
    b = run(
        bench,
        "plane.uframe.rot := OrientZYX(0, 0, 90);",
        "m := MirPos(Offs(p0, 0, 40, 0), plane);",
        "again := MirPos(m, plane);",
        data='VAR robtarget m; VAR robtarget again; PERS wobjdata plane := [FALSE, TRUE, "",'
        " [[0, 0, 0], [1, 0, 0, 0]], [[0, 0, 0], [1, 0, 0, 0]]];",
    )
    start = placed(b, "p0") + (0, 40, 0)
    assert placed(b, "m") == pytest.approx(start * (1, -1, 1), abs=1e-2)
    assert placed(b, "again") == pytest.approx(start, abs=1e-2)
    x = np.array(q.rotated(b.value("p0")[1], [1, 0, 0]))
    assert q.rotated(b.value("m")[1], [1, 0, 0]) == pytest.approx(x * (1, -1, 1), abs=1e-5)


def test_the_active_tool_and_object_can_be_read(bench):
    b = run(
        bench,
        "before := CWObj();",
        "MoveL p0, v500, fine, tTool \\WObj:=table;",
        "tool := CTool(); after := CWObj(); GetSysData tool \\ObjectName:=name;",
        "level := PathLevel();",
        data="VAR tooldata tool; VAR wobjdata before; VAR wobjdata after; VAR string name; "
        'VAR num level; PERS wobjdata table := [FALSE, TRUE, "",'
        " [[0, 0, -10], [1, 0, 0, 0]], [[0, 0, 0], [1, 0, 0, 0]]];\n",
    )
    assert b.value("tool") == b.value("tTool")
    assert b.value("before") == b.value("wobj0")
    assert b.value("after") == b.value("table")
    assert (b.value("name"), b.value("level")) == ("tTool", 1)
    assert b.place * 1e3 == pytest.approx(placed(b, "p0") - (0, 0, 10), abs=0.05)


def test_persistents_keep_their_values_over_a_warm_start(bench):
    made = bench("PROC main()\nphase := 7;\nEXIT;\nENDPROC\n")

    async def play(b):
        await b.start()
        await b.ended()
        await b.controller.restart()
        assert b.value("phase") == 7
        assert not b.controller.is_running

    made.run(play)
