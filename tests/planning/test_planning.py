"""Planners, without a world: what they ask of their sensor and what they make of the answers."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.geometry import Field, wrap_angle
from fuzzyq_bullet.planning import (
    FuzzyPlanner,
    FuzzySettings,
    ImprovedFuzzyPlanner,
    ImprovedFuzzySettings,
    Motion,
    Observation,
    PlannerSettings,
    RangeSensor,
    make_planner,
    planner_names,
    register_planner,
)
from fuzzyq_bullet.planning.base import STEP_UNIT

MOTION = Motion(
    max_speed=0.6,
    max_turn_rate=2.0,
    acceleration=1.0,
    turn_acceleration=6.0,
    period=0.3,
    radius=0.2,
    margin=0.02,
)


def seen(lengths, *, goal=(5.0, 0.0), heading=0.0, speed=0.0, turn_rate=0.0, motion=None):
    """Return an observation at the origin whose sensor answers ``lengths(heading)``."""
    asked = []

    def sense(headings):
        asked.append(list(headings))
        return np.array([lengths(wrap_angle(one)) for one in headings])

    observation = Observation(
        time=0.0,
        position=(0.0, 0.0),
        heading=heading,
        speed=speed,
        turn_rate=turn_rate,
        goal=goal,
        goal_radius=0.2,
        range=1.0,
        radius=0.22,
        sensor=RangeSensor(sense, sense),
        motion=motion,
    )
    return observation, asked


def fuzzy(**settings):
    return FuzzyPlanner(FuzzySettings(**settings))


def improved(**settings):
    """The planner without its ways out, which test_escape.py is about."""
    return ImprovedFuzzyPlanner(ImprovedFuzzySettings(breakout=False, **settings))


def sides(left, middle, right):
    return lambda heading: middle if abs(heading) < 0.1 else left if heading > 0 else right


@given(st.floats(-3.1, 3.1))
def test_the_lines_point_at_the_goal_and_to_both_its_sides(bearing):
    goal = (5 * math.cos(bearing), 5 * math.sin(bearing))
    decision = fuzzy(line_angle=0.7).decide(seen(lambda _: 1.0, goal=goal)[0])
    expected = np.array([bearing + 0.7, bearing, bearing - 0.7])
    assert decision.lines == pytest.approx(expected)


@given(st.floats(-3.1, 3.1))
def test_with_nothing_in_the_way_it_makes_for_the_goal(bearing):
    goal = (5 * math.cos(bearing), 5 * math.sin(bearing))
    for planner in (fuzzy(), improved()):
        decision = planner.decide(seen(lambda _: 1.0, goal=goal)[0])
        assert abs(wrap_angle(decision.heading - bearing)) < 0.01
        assert (decision.distance, decision.difference) == (5.0, 0.0)
        assert decision.mode == "routine"


def test_more_room_on_the_left_turns_it_left_and_on_the_right_right():
    to_left = fuzzy().decide(seen(sides(1.0, 0.4, 0.3))[0])
    to_right = fuzzy().decide(seen(sides(0.3, 0.4, 1.0))[0])
    assert to_left.difference == pytest.approx(3.5)
    assert to_left.heading > 0.2
    assert to_right.heading < -0.2


def test_a_way_free_up_to_the_goal_counts_as_free_however_near_a_wall_is():
    # The goal is 0.5 m away and 0.6 m are free: what stands behind the goal is no matter.
    decision = fuzzy().decide(seen(sides(0.1, 0.6, 1.0), goal=(0.5, 0.0))[0])
    assert (decision.distance, decision.difference) == (5.0, 0.0)


def test_the_nearer_the_obstacle_the_shorter_the_step():
    steps = [fuzzy().decide(seen(lambda _, d=d: d)[0]).step for d in (0.1, 0.3, 0.6, 0.9)]
    assert steps == sorted(steps)
    assert steps[0] < 0.5 * steps[-1]


def test_equation_17_weighs_the_step_by_the_first_weight_and_the_turn_by_the_second():
    view = sides(1.0, 0.4, 0.3)
    plain = fuzzy(weights=(1.0, 1.0)).decide(seen(view)[0])
    assert plain.step == pytest.approx(plain.stride * STEP_UNIT)
    assert plain.heading == pytest.approx(plain.turn * FuzzySettings().turn_unit)
    short = fuzzy(weights=(0.3, 1.0)).decide(seen(view)[0])
    assert short.step == pytest.approx(0.3 * plain.step)
    assert short.heading == pytest.approx(plain.heading)
    gentle = fuzzy(weights=(1.0, 0.3)).decide(seen(view)[0])
    assert gentle.step == pytest.approx(plain.step)
    assert gentle.heading == pytest.approx(0.3 * plain.heading)


def test_the_distance_is_the_middle_lines_or_the_least_of_the_three():
    view = sides(0.9, 0.6, 0.2)
    assert fuzzy().decide(seen(view)[0]).distance == pytest.approx(3.0)
    assert fuzzy(distance="least").decide(seen(view)[0]).distance == pytest.approx(1.0)


def test_the_misprinted_table_and_the_five_point_centroid_can_be_chosen():
    view = sides(1.0, 0.3, 0.3)
    mended = fuzzy().decide(seen(view)[0])
    printed = fuzzy(rules="printed").decide(seen(view)[0])
    coarse = fuzzy(samples=5).decide(seen(view)[0])
    assert printed.turn < 0.0 < mended.turn  # as printed it turns to the blocked side
    assert coarse.turn != mended.turn


def test_it_never_steps_beyond_the_goal():
    decision = fuzzy(weights=(1.0, 1.0)).decide(seen(lambda _: 1.0, goal=(0.25, 0.0))[0])
    assert decision.step <= 0.25


def test_the_guard_caps_the_step_of_the_point_robot_by_one_corridor():
    observation, asked = seen(sides(0.8, 0.3, 0.1))
    decision = improved().decide(observation)
    assert asked[1] == [decision.heading]
    assert decision.guard == 0.8
    blocked, _ = seen(lambda heading: 0.07 if abs(heading) < 0.7 else 1.0)
    capped = improved(weights=(1.0, 0.3)).decide(blocked)
    assert capped.guard == 0.07
    assert capped.step <= 0.05
    unguarded = improved(guard=False).decide(seen(lambda _: 0.01)[0])
    assert unguarded.step > 0.01


def test_the_guard_of_a_turning_robot_covers_all_it_will_sweep():
    # It faces 1.2 rad to the left of the goal: the fan reaches from there to the new heading.
    observation, asked = seen(lambda _: 1.0, heading=1.2, speed=0.5, motion=MOTION)
    improved().decide(observation)
    fan = sorted([*asked[0], *asked[1]])  # the line to the goal serves as its last corridor
    fan = [way for way in fan if way >= -0.01]
    assert fan[0] == pytest.approx(0.0, abs=0.01)
    assert fan[-1] == pytest.approx(1.2)
    assert np.diff(fan).max() < 0.6


def test_something_on_the_way_round_limits_how_far_it_may_go():
    def view(heading):
        return 0.3 if 0.35 < heading < 0.85 else 1.0

    clear = improved().decide(seen(lambda _: 1.0, heading=1.2, speed=0.3, motion=MOTION)[0])
    narrow = improved().decide(seen(view, heading=1.2, speed=0.3, motion=MOTION)[0])
    assert clear.reach > 0.9
    assert narrow.reach < 0.3


def test_a_fast_robot_does_not_turn_to_where_it_could_not_stop():
    def view(heading):
        return 0.15 if heading < 0.9 else 1.0

    slow = improved().decide(seen(view, heading=1.2, speed=0.0, motion=MOTION)[0])
    fast = improved().decide(seen(view, heading=1.2, speed=0.6, motion=MOTION)[0])
    assert slow.heading == pytest.approx(0.0, abs=0.1)
    assert fast.heading > 0.9
    assert fast.reach == 0.0  # it brakes, to turn when it is slower


def test_a_robot_that_still_turns_away_minds_where_it_turns():
    def view(heading):
        return 0.1 if heading < -0.1 else 1.0

    observation, _ = seen(view, heading=0.0, speed=0.3, turn_rate=-2.0, motion=MOTION)
    assert improved().decide(observation).reach <= 0.1
    # The same where it is to turn back the other way: to the goal, 0.3 rad to its left.
    observation, _ = seen(
        lambda way: view(way + 0.4), heading=-0.3, speed=0.3, turn_rate=-2.0, motion=MOTION
    )
    assert improved().decide(observation).reach <= 0.1


@given(
    st.lists(st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(0.05, 0.5)), max_size=12),
    st.floats(-3.1, 3.1),
    st.floats(0.0, 0.6),
    st.floats(-2.0, 2.0),
)
def test_the_reach_is_free_on_every_way_between_facing_and_heading(
    cylinders, heading, speed, turn_rate
):
    field = Field(np.array(cylinders).reshape(-1, 3))
    if field.clearance([(0.0, 0.0)])[0] < 0.22:
        return
    observation, _ = seen(
        lambda angle: field.free_distance((0.0, 0.0), [angle], 0.22, 1.0)[0],
        heading=heading,
        speed=speed,
        turn_rate=turn_rate,
        motion=MOTION,
    )
    decision = improved().decide(observation)
    turn = wrap_angle(decision.heading - heading)
    if abs(turn) > math.pi / 2:
        return
    fastest = min(MOTION.max_speed, speed + MOTION.acceleration * MOTION.period)
    farthest = fastest * MOTION.period + MOTION.way_to_stop(fastest)
    swept = heading + np.linspace(0.0, turn, 40)
    free = field.free_distance((0.0, 0.0), swept, MOTION.radius, 1.0)
    assert min(decision.reach, farthest) <= free.min() + 1e-9


def test_every_registered_planner_is_built_from_its_own_settings():
    assert planner_names()[:2] == ("fuzzy", "improved-fuzzy")
    rng = np.random.default_rng(0)
    assert isinstance(make_planner(FuzzySettings(), rng), FuzzyPlanner)
    assert isinstance(make_planner(ImprovedFuzzySettings(), rng), ImprovedFuzzyPlanner)


def test_a_name_is_registered_once():
    with pytest.raises(ValueError, match="registered already"):
        register_planner("fuzzy", FuzzySettings, lambda settings, rng: FuzzyPlanner(settings))


def test_settings_that_cannot_take_the_name_are_refused():
    with pytest.raises(ValueError, match="name"):
        register_planner("other", FuzzySettings, lambda settings, rng: FuzzyPlanner(settings))
    assert "other" not in planner_names()
    assert issubclass(FuzzySettings, PlannerSettings)
