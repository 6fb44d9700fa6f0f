"""Poses obey geometry."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from sims.rapid.library import quaternions as q
from tests.sims.rapid.runtime.bench import result

parts = st.floats(-1, 1)
orients = (
    st.tuples(parts, parts, parts, parts)
    .filter(lambda four: math.hypot(*four) > 0.1)
    .map(q.normalised)
)
vectors = st.tuples(parts, parts, parts).map(list)


@given(orients, orients, vectors)
def test_a_product_turns_as_its_parts_one_after_the_other(
    a: q.Orient, b: q.Orient, v: q.Pos
) -> None:
    assert q.rotated(q.product(a, b), v) == pytest.approx(q.rotated(a, q.rotated(b, v)), abs=1e-9)


@given(orients, vectors)
def test_turning_keeps_lengths_and_the_inverse_undoes_it(a: q.Orient, v: q.Pos) -> None:
    turned = q.rotated(a, v)
    assert math.hypot(*turned) == pytest.approx(math.hypot(*v), abs=1e-9)
    assert q.rotated(q.conjugate(a), turned) == pytest.approx(v, abs=1e-9)


@given(orients)
def test_an_orientation_is_found_again_from_its_axes(a: q.Orient) -> None:
    axes = [q.rotated(a, axis) for axis in ([1, 0, 0], [0, 1, 0], [0, 0, 1])]
    found = q.from_axes(*axes)
    assume(abs(a[0]) > 1e-6)
    assert found == pytest.approx([part * math.copysign(1, a[0]) for part in a], abs=1e-6)


TARGET = "VAR robtarget r := [[100,200,300],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];"


def answer(kind: str, expression: str, data: str = TARGET) -> object:
    return result(f"VAR {kind} result;\n{data}\nPROC main()\nresult := {expression};\nENDPROC")


def test_offs_shifts_in_the_work_object_and_reltool_in_the_tool() -> None:
    assert answer("robtarget", "Offs(r,1,2,3)")[0] == [101.0, 202.0, 303.0]
    # The tool looks down: its z is the object's -z, its x the object's -x.
    assert answer("robtarget", "RelTool(r,1,2,3)")[0] == pytest.approx([99.0, 202.0, 297.0])


def test_reltool_turns_about_x_then_y_then_z_of_the_tool() -> None:
    data = TARGET.replace("[0,0,1,0]", "[1,0,0,0]")
    turned = answer("robtarget", "RelTool(r,0,0,0\\Rx:=90\\Rz:=90)", data)[1]
    # x of the tool is first left alone, then turned about the new z, which is the old -y.
    assert q.rotated(turned, [1, 0, 0]) == pytest.approx([0, 0, 1], abs=1e-6)


def test_a_pose_times_its_inverse_is_nothing() -> None:
    pose = "[[1,2,3],OrientZYX(10,20,30)]"
    data = f"VAR pose p;\nFUNC pose made() VAR pose m; m := {pose}; RETURN m; ENDFUNC"
    place, turn = answer("pose", "PoseMult(made(), PoseInv(made()))", data)
    assert place == pytest.approx([0, 0, 0], abs=1e-5)
    assert turn == pytest.approx([1, 0, 0, 0], abs=1e-6)
    assert answer("pos", "PoseVect([[1,2,3],[0,0,0,1]],[1,1,1])", "") == pytest.approx([0, 1, 4])


def test_a_frame_of_three_points_looks_where_they_say() -> None:
    data = "".join(
        f"VAR robtarget p{k} := [{place},[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
        for k, place in enumerate(("[10,0,0]", "[10,5,0]", "[3,7,0]"), 1)
    )
    place, turn = answer("pose", "DefFrame(p1,p2,p3)", data)
    assert place == [10.0, 0.0, 0.0]
    assert q.rotated(turn, [1, 0, 0]) == pytest.approx([0, 1, 0], abs=1e-6)
    assert q.rotated(turn, [0, 1, 0]) == pytest.approx([-1, 0, 0], abs=1e-6)
    assert answer("pose", "DefFrame(p1,p2,p3\\Origin:=3)", data)[0] == pytest.approx([10, 7, 0])


def test_norient_repairs_and_others_refuse_what_is_no_orientation() -> None:
    assert answer("orient", "NOrient([2,0,0,0])", "") == [1.0, 0.0, 0.0, 0.0]
    program = """
        VAR num result;
        VAR pose p;
        PROC main()
            p := PoseInv([[0,0,0],[2,0,0,0]]);
        ERROR
            IF ERRNO = ERR_ORIENT_VALUE result := 1;
            TRYNEXT;
        ENDPROC
    """
    assert result(program) == 1.0
