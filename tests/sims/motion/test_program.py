import numpy as np
import pytest

from drivers.arms import ARMS, Kinematics
from hal import JointTarget, LinearTarget, Tool, Transform
from hal.errors import UnreachableError
from sims.motion import plan_program

ARM = ARMS["irb1200-5-0.9"]
KINEMATICS = Kinematics(ARM)
TOOL = Tool(Transform.from_translation("flange", "tcp", (0, 0, 0.16)))
HOME = np.array(ARM.home_rad)
TICK_S = 0.002


def plan(*targets, start=HOME):
    return plan_program(KINEMATICS, start, targets, TOOL, TICK_S)


def tcp(joints):
    return KINEMATICS.forward(np.asarray(joints)) @ TOOL.T_flange_tcp.matrix


def tcp_target(joints, by_m=(0, 0, 0)):
    T = tcp(joints)
    T[:3, 3] += by_m
    return Transform("base", "tcp", T)


def rates(program):
    speed = np.diff(program.joints_rad, axis=0) / TICK_S
    return np.abs(speed).max(axis=0), np.abs(np.diff(speed, axis=0) / TICK_S).max(axis=0)


def played(program, brake_at=None):
    rows = []
    while not program.is_done:
        if len(rows) == brake_at:
            program.brake()
        rows.append(program.next_joints_rad())
    return np.array(rows)


@pytest.mark.parametrize("seed", range(5))
def test_joint_moves_keep_the_arms_limits_and_the_straight_joint_line(seed):
    rng = np.random.default_rng(seed)
    target = rng.uniform(ARM.limits.lower_rad, ARM.limits.upper_rad) * 0.8
    program = plan(JointTarget(tuple(target)))
    speed, acceleration = rates(program)
    assert (speed <= np.array(ARM.limits.speed_radps) * 1.001).all()
    assert (acceleration <= np.array(ARM.accelerations_radps2) * 1.01).all()
    way = (target - HOME) / np.linalg.norm(target - HOME)
    away = program.joints_rad - HOME
    assert np.abs(away - (away @ way)[:, None] * way).max() < 1e-9
    assert program.joints_rad[-1] == pytest.approx(target, abs=1e-12)


def test_a_linear_move_is_straight_even_and_no_faster_than_asked():
    program = plan(LinearTarget(tcp_target(HOME, (0.05, 0.1, -0.1)), speed_mps=0.25))
    places = np.array([tcp(q)[:3, 3] for q in program.joints_rad])
    turns = np.array([tcp(q)[:3, :3] for q in program.joints_rad])
    line = (places[-1] - places[0]) / np.linalg.norm(places[-1] - places[0])
    away = places - places[0]
    assert np.linalg.norm(away - (away @ line)[:, None] * line, axis=1).max() < 2e-5
    assert np.abs(turns - turns[0]).max() < 1e-4
    speed = np.linalg.norm(np.diff(places, axis=0), axis=1) / TICK_S
    assert speed.max() == pytest.approx(0.25, rel=0.01)


def test_where_a_joint_would_be_too_fast_the_line_is_driven_slower():
    near_wrist_singularity = np.array([0.0, 0.0, 0.0, 1.3, 0.15, 0.0])
    goal = tcp_target(near_wrist_singularity, (0.0, 0.1, 0.0))
    program = plan(LinearTarget(goal, speed_mps=3.0), start=near_wrist_singularity)
    speed, acceleration = rates(program)
    assert (speed <= np.array(ARM.limits.speed_radps) * 1.001).all()
    assert (acceleration <= np.array(ARM.accelerations_radps2) * 1.001).all()


def test_a_line_out_of_reach_is_refused_with_how_far_it_got():
    with pytest.raises(UnreachableError, match=r"\d+% of its way"):
        plan(LinearTarget(tcp_target(HOME, (0.8, 0, 0))))


def test_a_line_past_a_singularity_is_refused():
    T = tcp(np.array([0.0, 0.0, 0.0, -0.1, -0.3, 0.0]))
    with pytest.raises(UnreachableError, match="singularity"):
        plan(
            LinearTarget(Transform("base", "tcp", T), 0.25),
            start=np.array([0.0, 0.0, 0.0, 0.1, 0.3, 0.0]),
        )


def test_zones_save_time_do_not_stop_and_end_at_the_last_target():
    via, end = (0.5, 0.2, 0, 0, 1.4, 0), (0.5, -0.2, 0.2, 0, 1.2, 0.5)
    stopping = plan(JointTarget(via), JointTarget(end))
    flying = plan(JointTarget(via, zone_m=0.05), JointTarget(end))
    assert flying.duration_s < stopping.duration_s - 0.03
    assert flying.joints_rad[-1] == pytest.approx(end, abs=1e-12)
    steps = np.linalg.norm(np.diff(flying.joints_rad, axis=0), axis=1)
    n = len(steps)
    assert steps[n // 5 : -n // 5].min() > 0.1 * steps.max()
    speed, _ = rates(flying)
    assert (speed <= np.array(ARM.limits.speed_radps) * 1.001).all()


@pytest.mark.parametrize("zone_m", [0.01, 0.03])
def test_the_corner_is_cut_within_the_zone(zone_m):
    corner, end = tcp_target(HOME, (0, 0, -0.12)), tcp_target(HOME, (0, 0.12, -0.12))
    program = plan(LinearTarget(corner, 0.25, zone_m), LinearTarget(end, 0.25))
    places = np.array([tcp(q)[:3, 3] for q in program.joints_rad])
    away = np.linalg.norm(places - corner.translation_m, axis=1)
    assert 0 < away.min() < zone_m
    before = places[: int(away.argmin())]
    outside = before[np.linalg.norm(before - corner.translation_m, axis=1) > zone_m]
    start = tcp(HOME)[:3, 3]
    assert np.abs((outside - start)[:, :2]).max() < 2e-5  # straight until the zone begins


def test_several_blended_moves_pass_every_zone():
    stations = [(0, 0.05, 0), (0.05, 0.1, 0), (0.0, 0.1, -0.05)]
    targets = [LinearTarget(tcp_target(HOME, by), 0.2, 0.01) for by in stations]
    program = plan(*targets, JointTarget(tuple(HOME)))
    places = np.array([tcp(q)[:3, 3] for q in program.joints_rad])
    for target in targets:
        nearest = np.linalg.norm(places - target.T_base_tcp.translation_m, axis=1).min()
        assert nearest < 0.01
    assert program.joints_rad[-1] == pytest.approx(HOME, abs=1e-9)


def test_braking_stays_on_the_path_and_within_twice_the_acceleration():
    program = plan(JointTarget((1.2, 0.5, -0.5, 1.0, 1.0, 2.0)))
    whole = program.joints_rad.copy()
    rows = played(program, brake_at=100)
    assert program.was_stopped
    assert len(rows) < len(whole)
    way = (whole[-1] - whole[0]) / np.linalg.norm(whole[-1] - whole[0])
    away = rows - whole[0]
    assert np.abs(away - (away @ way)[:, None] * way).max() < 1e-9
    change = np.abs(np.diff(rows, n=2, axis=0)).max(axis=0) / TICK_S**2
    assert (change <= 2.1 * np.array(ARM.accelerations_radps2)).all()
    assert np.abs(rows[-1] - rows[-2]).max() < 1e-3


def test_played_undisturbed_it_is_the_plan():
    program = plan(JointTarget((0.3, 0, 0, 0, 1.5, 0)))
    assert played(program) == pytest.approx(program.joints_rad[1:])
    assert not program.was_stopped


def test_going_nowhere_takes_no_time():
    assert plan(JointTarget(tuple(HOME))).duration_s <= TICK_S
    assert plan(LinearTarget(tcp_target(HOME))).duration_s <= TICK_S
