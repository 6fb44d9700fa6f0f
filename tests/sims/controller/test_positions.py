"""Poses, postures and confdata: there and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.arms import ARMS, Kinematics
from sims.controller.confdata import confdata_of, is_in, postures, solution_in
from sims.controller.frames import frame_of, pose_of
from sims.rapid.errors import RapidError

JOINTS = st.tuples(
    *(
        st.floats(low * 0.99, high * 0.99)
        for low, high in zip(
            ARMS["irb1200-5-0.9"].limits.lower_rad,
            ARMS["irb1200-5-0.9"].limits.upper_rad,
            strict=True,
        )
    )
)


@given(st.sampled_from(sorted(ARMS)), JOINTS)
def test_a_posture_is_found_again_by_its_confdata(name, joints):
    arm = ARMS[name]
    kinematics = Kinematics(arm)
    joints = np.clip(joints, kinematics.lower_rad, kinematics.upper_rad)
    if abs(np.sin(joints[4])) < 0.02:
        return  # in the wrist singularity axes 4 and 6 share what they turn
    quarters = np.array(joints)[[0, 3, 5]] / (np.pi / 2)
    if np.abs(quarters - np.round(quarters)).min() < 0.02:
        return  # at an edge two quarters are right
    pose = kinematics.forward(joints)
    found = solution_in(kinematics, pose, confdata_of(arm, joints), np.zeros(6))
    assert found is not None
    rivals = [
        row
        for row in postures(kinematics, pose)
        if is_in(row, confdata_of(arm, joints))
        and confdata_of(arm, row)[3] == confdata_of(arm, joints)[3]
    ]
    if len(rivals) == 1:
        assert found == pytest.approx(joints, abs=1e-6)
    assert confdata_of(arm, found) == confdata_of(arm, joints)


@pytest.mark.parametrize(
    ("degrees", "confdata"),
    [
        ((10, 0, 0, 20, 30, 100), [0, 0, 1, 0]),
        ((-10, 0, 0, -20, 30, -100), [-1, -1, -2, 0]),
        ((100, 0, 0, 95, -30, 200), [1, 1, 2, 1]),
        ((0, 0, 0, 0, 45, 0), [0, 0, 0, 0]),
        ((0, -60, -80, 0, 45, 0), [0, 0, 0, 4]),
        ((0, 80, -160, 0, 45, 0), [0, 0, 0, 2]),
        ((0, 20, -160, 0, 45, 0), [0, 0, 0, 6]),
    ],
)
def test_quarters_are_counted_from_zero_both_ways(degrees, confdata):
    assert confdata_of(ARMS["irb1200-5-0.9"], np.radians(degrees)) == confdata


def test_an_edge_belongs_to_both_quarters():
    hair = np.array([0.0, 0, 0, -1e-9, 1.0, 0])
    assert confdata_of(ARMS["irb1200-5-0.9"], hair)[1] == 0
    assert is_in(hair, [0, 0, 0, 0])
    assert is_in(hair, [0, -1, 0, 0])
    assert not is_in(hair, [0, 1, 0, 0])


@given(st.tuples(*[st.floats(-1, 1)] * 4), st.tuples(*[st.floats(-2000, 2000)] * 3))
def test_poses_go_there_and_back(quaternion, place):
    norm = np.linalg.norm(quaternion)
    if norm < 0.1:
        return
    q = np.array(quaternion) / norm
    back = pose_of(frame_of([list(place), list(q)]))
    assert back[0] == pytest.approx(place, abs=1e-9)
    assert abs(float(np.dot(back[1], q))) == pytest.approx(1.0, abs=1e-12)
    assert back[1][0] >= 0


@pytest.mark.parametrize(
    "pose",
    [
        [[0, 0, 0], [0, 0, 0, 0]],
        [[0, 0, 0], [2, 0, 0, 0]],
        [[float("nan"), 0, 0], [1, 0, 0, 0]],
        [[0, float("inf"), 0], [1, 0, 0, 0]],
        [[0, 0, 0], [float("nan"), 0, 0, 1]],
    ],
)
def test_what_is_no_pose_is_refused(pose):
    with pytest.raises(RapidError):
        frame_of(pose)


CALC = """
  VAR jointtarget j;
  VAR robtarget p;
  VAR errnum wrong := 0;
  PROC main()
    MoveAbsJ [[10, 20, -30, 40, 50, 60], NONE], v1000, fine, tTool;
    j := CJointT();
    p := CRobT(\\Tool:=tTool \\WObj:=wobj0);
    j := CalcJointT(p, tTool);
    p0 := CalcRobT(j, tTool \\WObj:=wobj0);
    p.trans.x := 3000;
    j := CalcJointT(p, tTool \\ErrorNumber:=wrong);
    phase := wrong;
    p := CalcRobT([[0, 0, 0, 0, 30, 0], NONE], tTool);
    j := CalcJointT(p, tTool);
    EXIT;
  ENDPROC
"""


def test_programs_calculate_positions_both_ways(bench):
    async def play(b):
        await b.start()
        await b.ended()
        expected = (b.kinematics.forward(np.radians((10, 20, -30, 40, 50, 60))) @ b.tool)[:3, 3]
        assert b.value("p0")[0] == pytest.approx(expected * 1e3, abs=0.02)
        assert b.value("p0")[2] == [0, 0, 0, 0]
        assert b.value("phase") == b.value("ERR_OUTSIDE_REACH")
        assert b.value("j")[0] == pytest.approx((0, 0, 0, 0, 30, 0), abs=1e-3)

    bench(CALC).run(play)
