"""Ways that grow while they are driven: geometry, limits, corners, stops."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from drivers.arms import ARMS, Kinematics
from hal.errors import UnreachableError
from sims.motion import (
    CircleError,
    Pace,
    SingularityError,
    Way,
    WayPlayer,
    Zone,
    circular_leg,
    joint_leg,
    linear_leg,
)

ARM = ARMS["irb1200-5-0.9"]
KINEMATICS = Kinematics(ARM)
TOOL = np.eye(4)
TOOL[2, 3] = 0.16
HOME = np.array(ARM.home_rad)
TICK_S = 0.002
SPEEDS = np.array(ARM.limits.speed_radps)
ACCELERATIONS = np.array(ARM.accelerations_radps2)


def pace(speed_mps, **changes):
    limits = {
        "tcp_mps": speed_mps,
        "turn_radps": 8.7,
        "joint_radps": SPEEDS,
        "joint_radps2": ACCELERATIONS,
        "tcp_mps2": 4.0,
        "tcp_brake_mps2": 4.0,
        "turn_radps2": 30.0,
    }
    return Pace(**{**limits, **changes})


def tcp(joints):
    return KINEMATICS.forward(np.asarray(joints)) @ TOOL


def beside(by_m, joints=HOME):
    T = tcp(joints)
    T[:3, 3] += by_m
    return T


def way_of(legs, speed_mps=0.5, zone=None):
    way = Way()
    for leg in legs:
        way, _ = way.joined(
            KINEMATICS, TOOL, leg, pace(speed_mps), zone=zone if way.pieces else None
        )
    return way


def legs_through(*goals, start=HOME):
    legs, at = [], start
    for goal in goals:
        legs.append(linear_leg(KINEMATICS, at, goal, TOOL))
        at = legs[-1].end_rad
    return legs


def player_on(way, place=0.0):
    player = WayPlayer(way, place, tick_s=TICK_S, window=15, joint_radps2=ACCELERATIONS)
    player.plan(way)
    return player


def played(player, at=None, do=None):
    rows = [player.next_joints_rad()]
    while not player.is_done:
        if len(rows) == at:
            do(player)
        rows.append(player.next_joints_rad())
    return np.array(rows)


def rates(rows):
    speed = np.diff(rows, axis=0) / TICK_S
    return np.abs(speed).max(axis=0), np.abs(np.diff(speed, axis=0) / TICK_S).max(axis=0)


@pytest.mark.parametrize("speed_mps", [0.1, 0.5, 1.5])
def test_a_line_is_straight_to_a_hundredth_of_a_millimetre_at_the_speed_asked_for(speed_mps):
    goal = beside((-0.05, 0.35, -0.1))
    rows = played(player_on(way_of(legs_through(goal), speed_mps)))
    places = tcp(rows)[:, :3, 3]
    start = tcp(HOME)[:3, 3]
    along = (goal[:3, 3] - start) / np.linalg.norm(goal[:3, 3] - start)
    away = places - start
    assert np.linalg.norm(away - (away @ along)[:, None] * along, axis=1).max() < 1e-5
    speed = np.linalg.norm(np.diff(places, axis=0), axis=1) / TICK_S
    assert speed.max() <= speed_mps * 1.002
    if speed_mps < 1:
        assert np.median(speed) == pytest.approx(speed_mps, rel=2e-3)


@pytest.mark.parametrize("seed", range(8))
def test_joints_never_pass_their_speeds_and_accelerations(seed):
    rng = np.random.default_rng(seed)
    way, at = Way(), HOME
    for k in range(4):
        goal = rng.uniform(ARM.limits.lower_rad, ARM.limits.upper_rad) * 0.6
        leg = joint_leg(KINEMATICS, at, goal, TOOL)
        zone = Zone(0.1) if k else None
        way, _ = way.joined(KINEMATICS, TOOL, leg, pace(10.0), zone=zone)
        at = leg.end_rad
    rows = np.vstack([HOME, played(player_on(way))])
    speed, acceleration = rates(rows)
    assert (speed <= SPEEDS).all()
    assert (acceleration <= ACCELERATIONS * 1.02).all()
    assert rows[-1] == pytest.approx(at, abs=1e-9)


def test_fast_joint_moves_use_the_full_speed():
    leg = joint_leg(KINEMATICS, HOME, np.array([2.5, 0.5, -0.5, 2, 1, 3.0]), TOOL)
    speed, acceleration = rates(played(player_on(way_of([leg], 10.0))))
    assert (speed / SPEEDS).max() > 0.95
    assert (acceleration / ACCELERATIONS).max() > 0.95


@given(
    st.floats(0.002, 0.2),
    st.floats(20.0, 170.0),
    st.floats(0.05, 0.3),
    st.floats(0.05, 0.3),
    st.sampled_from([0.1, 0.5, 1.5]),
)
def test_the_corner_stays_within_its_zone(zone_m, turn_deg, first_m, second_m, speed_mps):
    corner = beside((0, first_m, -0.1))
    turn = np.radians(turn_deg)
    end = corner.copy()
    end[:3, 3] += second_m * np.array([-np.sin(turn), np.cos(turn), 0.0])
    try:
        legs = legs_through(beside((0, 0, -0.1)), corner, end)[1:]
    except UnreachableError:
        return
    way = way_of(legs, speed_mps, Zone(zone_m))
    rows = played(player_on(way))
    places = tcp(rows)[:, :3, 3]
    point = corner[:3, 3]
    start, goal = beside((0, 0, -0.1))[:3, 3], end[:3, 3]

    def away(a, b):
        along = (b - a) / np.linalg.norm(b - a)
        off = places - a
        return np.linalg.norm(off - (off @ along)[:, None] * along, axis=1)

    outside = np.linalg.norm(places - point, axis=1) > zone_m * 1.001
    assert np.minimum(away(start, point), away(point, goal))[outside].max(initial=0) < 1.5e-5
    assert np.linalg.norm(places - point, axis=1).min() <= zone_m
    assert rows[-1] == pytest.approx(legs[-1].end_rad, abs=1e-9)
    speed, acceleration = rates(rows)
    assert (speed <= SPEEDS).all()
    assert (acceleration <= ACCELERATIONS * 1.02).all()


def test_through_a_zone_the_arm_does_not_stop():
    legs = legs_through(beside((0, 0.15, 0)), beside((-0.1, 0.15, 0)))
    rows = played(player_on(way_of(legs, 0.25, Zone(0.02))))
    speed = np.linalg.norm(np.diff(tcp(rows)[:, :3, 3], axis=0), axis=1) / TICK_S
    middle = len(speed) // 2
    assert speed[middle - 150 : middle + 150].min() > 0.15


def test_without_a_zone_the_arm_stands_at_the_corner():
    legs = legs_through(beside((0, 0.15, 0)), beside((-0.1, 0.15, 0)))
    rows = played(player_on(way_of(legs, 0.25)))
    corner = legs[0].end_rad
    assert np.abs(rows - corner).max(axis=1).min() < 2e-4


def test_a_leg_that_comes_in_time_is_joined_without_a_jump_or_a_stop():
    first, second = legs_through(beside((0, 0.2, 0)), beside((-0.1, 0.2, 0)))
    way = way_of([first], 0.25)
    player = player_on(way)

    def go_on(player):
        longer, _ = way.joined(
            KINEMATICS, TOOL, second, pace(0.25), zone=Zone(0.02), not_before=player.lead
        )
        assert len(longer.pieces) == 3
        player.plan(longer)

    rows = np.vstack([HOME, played(player, at=200, do=go_on)])
    _, acceleration = rates(rows)
    assert (acceleration <= ACCELERATIONS * 1.02).all()
    assert rows[-1] == pytest.approx(second.end_rad, abs=1e-9)


def test_a_leg_that_comes_too_late_finds_the_corner_closed():
    first, second = legs_through(beside((0, 0.2, 0)), beside((-0.1, 0.2, 0)))
    way = way_of([first], 0.25)
    player = player_on(way)
    while player.place < first.length_before_end(0.01):
        player.next_joints_rad()
    longer, begin = way.joined(
        KINEMATICS, TOOL, second, pace(0.25), zone=Zone(0.02), not_before=player.lead
    )
    assert len(longer.pieces) == 2
    assert longer.stands == (begin,)


@given(st.integers(2, 700), st.floats(0.1, 2.0))
def test_braking_ends_on_the_way_and_going_on_ends_at_its_end(at, speed_mps):
    legs = legs_through(beside((0, 0.2, -0.1)), beside((-0.1, 0.1, 0)))
    player = player_on(way_of(legs, speed_mps, Zone(0.03)))
    whole = played(player_on(player.way))
    at = min(at, len(whole) - 2)
    rows = np.vstack([HOME, played(player, at=at, do=WayPlayer.brake)])
    stop = player.place
    assert rows[-1] == pytest.approx(player.way.joints_rad(np.array([stop]))[0], abs=1e-9)
    _, acceleration = rates(rows)
    assert (acceleration <= ACCELERATIONS * 1.02).all()
    if not player.is_done or stop < player.way.end:
        player.plan(player.way)
        rows = np.vstack([rows, played(player)]) if not player.is_done else rows
    assert rows[-1] == pytest.approx(whole[-1], abs=1e-9)
    _, acceleration = rates(rows)
    assert (acceleration <= ACCELERATIONS * 1.02).all()


def test_a_brake_taken_back_at_once_is_smooth():
    player = player_on(way_of(legs_through(beside((0, 0.3, 0))), 1.0))
    rows = [HOME]
    for k in range(2000):
        if player.is_done:
            break
        if k == 150:
            player.brake()
        if k == 160:
            player.plan(player.way)
        rows.append(player.next_joints_rad())
    _, acceleration = rates(np.array(rows))
    assert (acceleration <= ACCELERATIONS * 1.02).all()
    assert player.place == pytest.approx(player.way.end, abs=1e-12)


def test_a_slower_ratio_stretches_time_and_not_the_way():
    way = way_of(legs_through(beside((0, 0.2, 0)), beside((-0.1, 0.2, 0))), 0.5, Zone(0.02))
    fast = played(player_on(way))
    player = player_on(way)
    player.plan(way, ratio=0.25)
    slow = played(player)
    assert len(slow) > 2.5 * len(fast)
    distance = np.linalg.norm(slow[:, None, :] - fast[None, ::4, :], axis=2).min(axis=1)
    assert distance.max() < 0.01
    speed = np.linalg.norm(np.diff(tcp(slow)[:, :3, 3], axis=0), axis=1) / TICK_S
    assert speed.max() == pytest.approx(0.125, rel=5e-3)


def test_a_circle_is_round_and_goes_through_its_points():
    via, end = beside((0.05, 0.05, 0)), beside((0, 0.1, 0))
    leg = circular_leg(KINEMATICS, HOME, via, end, TOOL)
    centre = beside((0, 0.05, 0))[:3, 3]
    rows = played(player_on(way_of([leg], 0.3)))
    places = tcp(rows)[:, :3, 3]
    assert np.linalg.norm(places - centre, axis=1) == pytest.approx(0.05, abs=1e-5)
    assert np.linalg.norm(places - via[:3, 3], axis=1).min() < 1e-3
    assert places[-1] == pytest.approx(end[:3, 3], abs=1e-9)


def test_a_circle_may_turn_the_tool_through_its_middle_point():
    via, end = beside((0.05, 0.05, 0)), beside((0, 0.1, 0))
    via[:3, :3] = via[:3, :3] @ Rotation.from_euler("x", 20, degrees=True).as_matrix()
    even = circular_leg(KINEMATICS, HOME, via, end, TOOL)
    through = circular_leg(KINEMATICS, HOME, via, end, TOOL, turns_through_via=True)
    for leg, angle in ((even, 0.0), (through, np.radians(20))):
        poses = tcp(leg.joints_rad(leg.knots))
        nearest = poses[np.linalg.norm(poses[:, :3, 3] - via[:3, 3], axis=1).argmin()]
        turned = Rotation.from_matrix(end[:3, :3].T @ nearest[:3, :3]).magnitude()
        assert turned == pytest.approx(angle, abs=0.02)
        assert poses[-1] == pytest.approx(end, abs=1e-9)


@given(st.floats(0.02, 0.12), st.floats(0.2, 6.0), st.floats(0.1, 0.9))
def test_circles_of_any_angle_keep_their_radius(radius_m, angle, share):
    start = beside((0, 0, -0.2))
    centre = start[:3, 3] - np.array([radius_m, 0, 0])

    def on(turn):
        T = start.copy()
        T[:3, 3] = centre + radius_m * np.array([np.cos(turn), np.sin(turn), 0])
        return T

    at = KINEMATICS.nearest(start @ np.linalg.inv(TOOL), HOME)
    try:
        leg = circular_leg(KINEMATICS, at, on(angle * share), on(angle), TOOL)
    except UnreachableError:
        return
    assert leg.way_m == pytest.approx(radius_m * angle, rel=5e-3)
    assert np.linalg.norm(leg.tcp_m - centre, axis=1) == pytest.approx(radius_m, abs=1e-6)


@pytest.mark.parametrize("via", [(0, 0.05, 0), (0, 1e-6, 0), (0, 0.1, 0)])
def test_points_on_a_line_or_too_near_make_no_circle(via):
    with pytest.raises(CircleError):
        circular_leg(KINEMATICS, HOME, beside(via), beside((0, 0.1, 0)), TOOL)


def test_a_line_out_of_reach_says_how_far_it_got():
    with pytest.raises(UnreachableError, match=r"\d+%"):
        linear_leg(KINEMATICS, HOME, beside((0.9, 0, 0)), TOOL)


WRIST = np.array([0.0, 0.1, 0.0, 0.0, 0.3, 0.0])
PAST_WRIST = np.array([0.0, 0.0, 0.0, 0.0, -0.3, 0.0])


def through_the_wrist(**options):
    return linear_leg(KINEMATICS, WRIST, tcp(PAST_WRIST), TOOL, **options)


def test_a_line_through_the_wrist_singularity_is_refused_by_name():
    with pytest.raises(SingularityError, match=r"joint [46]"):
        through_the_wrist()


def test_with_wrist_interpolation_it_is_driven_and_ends_at_its_pose():
    leg = through_the_wrist(keeps_wrist=True)
    assert tcp(leg.end_rad) == pytest.approx(tcp(PAST_WRIST), abs=1e-6)


def test_a_leg_to_where_one_stands_has_no_length():
    assert linear_leg(KINEMATICS, HOME, beside((0, 0, 0)), TOOL).length == 0
    assert joint_leg(KINEMATICS, HOME, HOME, TOOL).length == 0
