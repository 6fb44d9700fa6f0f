"""What happens on the way of a move, and at its corner."""

import numpy as np
import pytest

from tests.sims.controller.test_moves import CAUGHT, program


def drive(bench, *lines, data="", signal="do1"):
    """Run; returns the bench and how deep (mm) the tool was where ``signal`` changed."""
    made = bench(data + program(*lines, errors=CAUGHT))
    depths = []

    async def play(b):
        b.controller.signals[signal].watch(
            lambda _: depths.append(b.value("p0")[0][2] - b.place[2] * 1e3)
        )
        await b.start()
        await b.ended()
        return b, depths

    return made.run(play)


DOWN = "Offs(p0, 0, 0, -150)"


def test_a_procedure_waits_while_interrupts_are_disabled(bench):
    data = "PROC here()\ncount := count + 1;\nENDPROC\n"
    b, _ = drive(
        bench,
        f'MoveLSync {DOWN}, v200, z20, tTool, "here";',
        "IDisable;",
        "MoveL Offs(p0, 0, 150, -150), v200, fine, tTool;",
        "before := count; IDelete never; IEnable;",
        "WaitTime 0.1;",
        data="PERS num count := 0; VAR intnum never; VAR num before;\n" + data,
    )
    assert (b.value("before"), b.value("count")) == (0, 1)


def test_a_procedure_is_called_in_the_middle_of_the_corner(bench):
    _, depths = drive(
        bench,
        f'MoveLSync {DOWN}, v200, z20, tTool, "here";',
        "MoveL Offs(p0, 0, 150, -150), v200, fine, tTool;",
        data="PROC here()\nSetDO do1, 1;\nENDPROC\n",
    )
    assert depths == [pytest.approx(147, abs=4)]


@pytest.mark.parametrize("move", [f"MoveJSync {DOWN}", f"MoveCSync Offs(p0,0,75,-75), {DOWN}"])
def test_at_a_fine_point_it_is_called_where_the_arm_stands(bench, move):
    b, depths = drive(
        bench,
        f'{move}, v200, fine, tTool, "here";',
        data="PROC here()\nSetDO do1, 1;\nENDPROC\n",
    )
    assert depths[0] == pytest.approx(150, abs=0.5)
    assert b.value("phase") == 99


def test_a_procedure_that_is_not_there_is_refused_before_the_move(bench):
    b, _ = drive(bench, f'MoveLSync {DOWN}, v200, fine, tTool, "nowhere";')
    assert b.value("errno_seen") == b.value("ERR_REFUNKPRC")
    assert np.linalg.norm(b.place * 1e3 - b.value("p0")[0]) < 0.1


def test_outputs_of_an_array_are_set_on_the_way(bench):
    b, depths = drive(
        bench,
        'io{1} := [TRUE, 50, FALSE, 0, "do1", 1, 0];',
        'io{2} := [TRUE, 30, TRUE, 0, "do2", 1, 0];',
        f"TriggLIOs {DOWN}, v200 \\TriggData1:=io, fine, tTool;",
        data="VAR triggios io{3};\n",
    )
    assert depths == [pytest.approx(100, abs=1.5)]
    assert b.controller.signals["do2"].value == 1


def test_an_output_that_is_not_there_is_refused(bench):
    b, _ = drive(
        bench,
        'io{1} := [TRUE, 50, FALSE, 0, "di1", 1, 0];',
        f"TriggLIOs {DOWN}, v200 \\TriggData1:=io, fine, tTool;",
        data="VAR triggios io{1};\n",
    )
    assert b.value("errno_seen") == b.value("ERR_ARGVALERR")


@pytest.mark.parametrize(("wanted", "count"), [(1, 1), (0, 0)])
def test_a_signal_is_checked_on_the_way_and_an_interrupt_tells(bench, wanted, count):
    b, _ = drive(
        bench,
        "CONNECT wrong WITH onwrong;",
        f"TriggCheckIO check, 50, di1, EQ, {wanted} \\StopMove, wrong;",
        f"TriggL {DOWN}, v200, check, fine, tTool;",
        data="VAR intnum wrong; VAR triggdata check; PERS num count := 0; PERS num depth := 0;\n"
        "VAR robtarget there;\n"
        "TRAP onwrong\ncount := count + 1; WaitTime 0.5; there := CRobT(\\Tool:=tTool);\n"
        "depth := p0.trans.z - there.trans.z; StartMove;\nENDTRAP\n",
    )
    assert b.value("count") == count
    assert b.value("depth") == (pytest.approx(115, abs=15) if count else 0)
    assert b.value("phase") == 99


def test_triggers_are_copied_and_reset_and_go_with_axis_moves(bench):
    b, depths = drive(
        bench,
        "valid{1} := TriggDataValid(t1);",
        "TriggIO t1, 0 \\DOp:=do1, 1;",
        "TriggDataCopy t1, t2; TriggDataReset t1;",
        "valid{2} := TriggDataValid(t1); valid{3} := TriggDataValid(t2);",
        f"TriggAbsJ CalcJointT({DOWN}, tTool), v200, t2, fine, tTool;",
        data="VAR triggdata t1; VAR triggdata t2; VAR bool valid{3};\n",
    )
    assert b.value("valid") == [False, False, True]
    assert depths == [pytest.approx(150, abs=1)]
