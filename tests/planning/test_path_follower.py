"""A way that is remembered is driven: by the farthest point in view, and exactly where narrow."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fuzzyq_bullet.geometry import Field, wrap_angle
from fuzzyq_bullet.planning import Motion, Observation, RangeSensor
from fuzzyq_bullet.planning.escape.path_follower import CREEP, LEAST, PATIENCE, PathFollower

MOTION = Motion(
    max_speed=0.6,
    max_turn_rate=2.0,
    acceleration=1.0,
    turn_acceleration=6.0,
    period=0.3,
    radius=0.2,
    margin=0.02,
)


def observe(field, here=(0.0, 0.0), *, heading=0.0, time=0.0, motion=MOTION):
    def sense(headings):
        return field.free_distance(here, headings, 0.22, 1.0)

    return Observation(
        time=time,
        position=here,
        heading=heading,
        speed=0.0,
        turn_rate=0.0,
        goal=(9.0, 0.0),
        goal_radius=0.2,
        range=1.0,
        radius=0.22,
        sensor=RangeSensor(sense, sense),
        motion=motion,
    )


CORNER = Field(boxes=np.array([[0.8, -0.8, 1.0, 1.0, 0.0]]))
"""A block from (0.3, −1.3) to (1.3, −0.3)."""


def test_in_the_open_it_makes_straight_for_the_end():
    segment = PathFollower([(0.0, 0.0), (0.3, 0.2), (0.6, 0.0)]).next(observe(Field()))
    assert (segment.heading, segment.length, segment.reach) == (0.0, pytest.approx(0.6), math.inf)


def test_it_takes_the_farthest_point_in_view_and_stops_there_for_the_rest():
    # Up along the block, along its top, and down behind it.
    around = PathFollower([(0.0, -0.5), (0.1, 0.1), (1.0, 0.1), (1.7, -0.2), (1.7, -1.2)])
    segment = around.next(observe(CORNER, (0.0, -0.8)))
    assert segment.heading == pytest.approx(math.atan2(0.9, 0.1))
    assert segment.reach == segment.length == pytest.approx(math.hypot(0.1, 0.9))
    segment = around.next(observe(CORNER, (0.1, 0.1)))
    assert segment.heading == pytest.approx(0.0)
    assert segment.reach == segment.length == pytest.approx(0.9)
    segment = around.next(observe(CORNER, (1.0, 0.1)))
    assert segment.reach == segment.length == pytest.approx(math.hypot(0.7, 0.3))
    segment = around.next(observe(CORNER, (1.68, -0.2)))
    assert (segment.length, segment.reach) == (pytest.approx(math.hypot(0.02, 1.0)), math.inf)


def test_no_more_than_three_points_ahead_are_tried():
    segment = PathFollower([(0.1 * k, 0.0) for k in range(1, 9)]).next(observe(Field()))
    assert segment.length == segment.reach == pytest.approx(0.3)


def test_a_point_passed_is_never_gone_back_to():
    follower = PathFollower([(0.0, 0.0), (0.5, 0.0), (0.5, 0.5)])
    assert follower.next(observe(Field())).heading == pytest.approx(math.pi / 4)
    segment = follower.next(observe(Field(), (0.6, 0.0)))
    assert segment.length == pytest.approx(math.hypot(0.1, 0.5))


def test_a_point_beyond_its_sight_counts_as_seen_when_all_it_sees_is_free():
    segment = PathFollower([(3.0, 0.0)]).next(observe(Field()))
    assert (segment.length, segment.reach) == (3.0, math.inf)


def test_a_point_is_passed_only_where_it_was_really_reached():
    follower = [(0.0, -0.8), (0.05, 0.1), (1.0, -0.07)]
    assert PathFollower(follower).next(observe(CORNER, (0.05, -0.8))).length == pytest.approx(0.9)
    # 2 cm off it counts as reached, though what comes next is hidden yet; 4 cm off it does not.
    follower = ((0.03, -0.1), (1.0, -0.07))
    segment = PathFollower([*follower]).next(observe(CORNER, (0.03, -0.12)))
    assert segment.heading == pytest.approx(math.atan2(0.05, 0.97), abs=math.radians(45.0))
    assert segment.length == pytest.approx(0.1)
    segment = PathFollower([*follower]).next(observe(CORNER, (0.03, -0.14), heading=math.pi / 2))
    assert segment.heading == pytest.approx(math.pi / 2)
    assert segment.reach == segment.length == pytest.approx(0.04)


def between(width, at=0.25):
    """Two cylinders with room between them, ahead."""
    y = 0.2 + width / 2
    return Field(np.array([[at, y, 0.2], [at, -y, 0.2]]))


@pytest.mark.parametrize("facing", [0.3, -0.3, 0.05, 2.5, 6.0])
def test_where_the_way_is_narrow_it_turns_on_the_spot_first(facing):
    segment = PathFollower([(1.5, 0.0)]).next(observe(between(0.45), heading=facing))
    assert (segment.heading, segment.reach) == (0.0, 0.0)


@pytest.mark.parametrize("facing", [0.0, 0.03, -0.03, math.tau])
def test_when_it_faces_a_narrow_way_it_enters(facing):
    segment = PathFollower([(1.5, 0.0)]).next(observe(between(0.45), heading=facing))
    assert (segment.heading, segment.reach) == (0.0, math.inf)


@pytest.mark.parametrize("side", [1, -1])
def test_a_way_is_narrow_where_it_is_so_on_one_side(side):
    field = Field(np.array([[0.15, 0.43 * side, 0.2]]))
    assert PathFollower([(1.5, 0.0)]).next(observe(field, heading=0.3)).reach == 0.0


def test_where_the_way_is_wide_it_turns_as_it_drives():
    segment = PathFollower([(1.5, 0.0)]).next(observe(between(0.8), heading=0.3))
    assert segment.reach == math.inf


def test_what_is_narrow_only_farther_on_is_no_matter_yet():
    segment = PathFollower([(1.5, 0.0)]).next(observe(between(0.45, at=0.4), heading=0.3))
    assert segment.reach == math.inf


@pytest.mark.parametrize("side", [1, -1])
def test_a_near_point_far_aside_is_not_circled_but_turned_to_on_the_spot(side):
    def segment(angle, way=0.1, motion=MOTION):
        beside = (way * math.cos(angle), side * way * math.sin(angle))
        follower = PathFollower([beside, (3.0, side * 2.0)])
        return follower.next(observe(between(0.5), motion=motion))

    assert segment(math.radians(80)).reach == 0.0
    assert segment(math.radians(35)).reach == 0.0
    assert segment(math.radians(20)).reach == pytest.approx(0.1)
    assert segment(math.radians(80), motion=None).reach == pytest.approx(0.1)


def test_a_point_robot_needs_no_turn():
    segment = PathFollower([(1.5, 0.0)]).next(observe(between(0.45), heading=2.0, motion=None))
    assert segment.reach == math.inf


@pytest.mark.parametrize("side", [1, -1])
def test_where_the_way_is_blocked_it_goes_aside_by_the_least_that_is_free(side):
    ahead = observe(Field(np.array([[0.45, 0.05 * side, 0.2]])))  # 0.04 m are free
    segment = PathFollower([(1.0, 0.0)]).next(ahead)
    assert segment.length == pytest.approx(0.1)
    assert ahead.sense([segment.heading])[0] >= segment.length
    turn = -segment.heading * side
    assert 0.0 < turn < math.pi / 2
    # The turns that are tried grow by less than 1.6 each, on both sides alike.
    assert max(ahead.sense(np.linspace(-turn / 1.6, turn / 1.6, 50))) < segment.length


def test_near_a_point_less_room_is_enough():
    # To the next point 5 cm are missing; 10 cm are free nowhere near it.
    field = Field(np.array([[0.7, 0.24, 0.2]]), arena=(9.0, 9.0))
    here = observe(field, (0.24, 0.24))
    segment = PathFollower([(0.29, 0.24), (8.0, 0.23)]).next(here)
    assert segment.length == pytest.approx(0.05)
    assert here.sense([segment.heading])[0] >= 0.05


def test_where_nothing_is_free_it_gives_up_at_once():
    assert PathFollower([(1.0, 0.0)]).next(observe(Field(arena=(0.48, 0.48)), (0.24, 0.24))) is None


def test_where_hardly_anything_is_free_it_creeps_along_what_is():
    # 5 cm are free to either side along x, 2 cm along y.
    here = observe(Field(arena=(0.54, 0.48)), (0.27, 0.24))
    segment = PathFollower([(0.6, 1.0)]).next(here)
    assert segment.exact
    assert CREEP < segment.length < LEAST
    assert here.sense([segment.heading])[0] == segment.length


def test_it_gives_up_when_it_came_no_nearer_for_three_seconds():
    follower = PathFollower([(1.5, 0.0)])
    for time in (10.0, 11.0, 10.0 + PATIENCE):
        assert follower.next(observe(Field(), time=time)) is not None
    assert follower.next(observe(Field(), time=10.1 + PATIENCE)) is None


def test_a_robot_that_turns_slowly_is_given_the_time_to_turn_round():
    follower, slow = PathFollower([(-1.5, 0.0)]), replace(MOTION, max_turn_rate=0.5)
    half_turn = math.pi / 0.5
    for time in (10.0, 10.1 + PATIENCE, 11.0 + half_turn, 9.9 + PATIENCE * slow.slowness):
        assert follower.next(observe(Field(), time=time, motion=slow)) is not None
    assert (
        follower.next(observe(Field(), time=10.1 + PATIENCE * slow.slowness, motion=slow)) is None
    )


@pytest.mark.parametrize("uncertainty", [0.0, 0.05])
@pytest.mark.parametrize(("step", "goes_on"), [(0.012, True), (0.008, False)])
def test_a_centimetre_nearer_than_it_can_tell_is_patience_anew(step, goes_on, uncertainty):
    follower, step = PathFollower([(1.5, 0.0)]), step + uncertainty

    def way_on(x, time):
        told = replace(observe(Field(), (x, 0.0), time=time), uncertainty=uncertainty)
        return follower.next(told)

    assert way_on(0.0, 0.0) is not None
    assert way_on(step, 2.0) is not None
    assert (way_on(step, PATIENCE + 0.5) is not None) is goes_on


def test_a_new_point_is_patience_anew():
    follower = PathFollower([(0.1, 0.1), (1.0, 0.1), (1.7, -0.2), (1.7, -1.2)])
    assert follower.next(observe(CORNER, (0.0, -0.8), time=0.0)).length < 1.0
    at_it = [follower.next(observe(CORNER, (0.1, 0.1), time=t)) for t in (2.0, 4.0, 5.0, 5.1)]
    assert [segment is None for segment in at_it] == [False, False, False, True]


def test_the_heading_it_gives_is_the_one_to_its_point_wherever_that_is():
    for angle in np.linspace(-3.0, 3.0, 7):
        segment = PathFollower([(0.7 * math.cos(angle), 0.7 * math.sin(angle))]).next(
            observe(Field())
        )
        assert abs(wrap_angle(segment.heading - angle)) < 1e-9


def test_the_last_point_is_never_dropped():
    assert PathFollower([(0.0, 0.0)]).next(observe(Field())).length == 0.0


def test_points_that_it_stands_on_are_no_legs():
    pillar = Field(cylinders=np.array([[0.3, 0.5, 0.1]]))
    follower = PathFollower([(0.0, 0.0), (0.0, 0.0), (1.0, 3.0)])
    segment = follower.next(observe(pillar))
    assert segment is None or segment.length > 0.0
