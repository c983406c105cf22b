"""What the drives share: how far the robot surely is from everything, and one cast for one line."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.drives.apart import Apart
from fuzzyq_bullet.drives.base import Tick
from fuzzyq_bullet.drives.foresight import Foresight
from fuzzyq_bullet.drives.nearby import Nearby
from fuzzyq_bullet.drives.sensor import CastOnce
from fuzzyq_bullet.episode import run
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.physics.engine import TIME_STEP
from fuzzyq_bullet.physics.sight import Sight
from fuzzyq_bullet.planning import ImprovedFuzzySettings
from fuzzyq_bullet.robots import FUZZYQ
from fuzzyq_bullet.scenario import (
    Arena,
    Box,
    Cylinder,
    Goal,
    Limits,
    Robot,
    Scenario,
    Start,
    random_task,
    with_options,
)

FIELD = Field(np.array([[0.0, 0.0, 0.3], [1.5, 0.4, 0.2]]))

place = st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))


@given(st.lists(st.tuples(place, st.floats(0.0, 2.0)), min_size=1, max_size=20))
def test_what_is_surely_free_is_never_more_than_the_clearance(asked):
    apart = Apart(lambda x, y: float(FIELD.clearance([(x, y)])[0]))
    for (x, y), enough in asked:
        clearance = float(FIELD.clearance([(x, y)])[0])
        told = apart.by(x, y, enough)
        assert told <= clearance + 1e-9
        assert told >= enough or told == clearance


def test_it_is_measured_anew_only_where_that_may_matter():
    measured = []

    def measure(x, y):
        measured.append((x, y))
        return 1.0

    apart = Apart(measure)
    for k in range(8):
        assert apart.by(0.1 * k, 0.0, 0.25) == pytest.approx(1.0 - 0.1 * k)
    assert apart.by(0.8, 0.0, 0.25) == 1.0  # 0.2 m would be left of it
    assert measured == [(0.0, 0.0), (0.8, 0.0)]


def test_what_was_measured_at_this_very_place_is_not_measured_again():
    measured = []
    apart = Apart(lambda x, y: measured.append((x, y)) or 0.1)
    assert [apart.by(1.0, 2.0, enough) for enough in (0.05, 0.3, 0.2)] == [0.1] * 3
    assert len(measured) == 1


@given(
    st.lists(st.tuples(place, st.floats(0.05, 1.0)), max_size=8),
    st.lists(
        st.tuples(place, st.floats(0.05, 2.0), st.floats(0.05, 2.0), st.floats(-3.2, 3.2)),
        max_size=5,
    ),
    st.sampled_from([None, (3.0, 2.5)]),
    st.lists(place, min_size=1, max_size=8),
    st.lists(st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)), max_size=30),
)
def test_what_is_near_tells_the_clearance_of_all(cylinders, boxes, arena, jumps, moves):
    field = Field(
        np.array([(*at, radius) for at, radius in cylinders]),
        np.array([(*at, *size) for at, *size in boxes]),
        arena,
    )
    near = Nearby(field)
    way = np.cumsum([jumps[0], *moves], axis=0).tolist()
    for x, y in [*way, *jumps]:
        assert near.clearance(x, y) == pytest.approx(field.clearance([(x, y)])[0], abs=1e-9)


def test_where_nothing_stands_it_is_asked_once():
    measured = []
    apart = Apart(lambda x, y: measured.append((x, y)) or math.inf)
    assert [apart.by(x, 0.0, 1.0) for x in range(5)] == [math.inf] * 5
    assert len(measured) == 1


@given(
    st.floats(-0.2, 1.0),
    st.floats(-3.0, 3.0),
    st.floats(-1.9, 1.9),
    st.floats(-1.9, 1.9),
    st.floats(0.002, 0.149),
    st.floats(-math.pi, math.pi),
    st.floats(-math.pi, math.pi),
    st.sampled_from([(0.1, 0.5), (0.1, 10.0), (1.0, 6.0)]),
)
@settings(max_examples=400)
@example(1.0, 3.0, 0.0, 0.0, 0.149, 0.0, math.pi / 2, (0.1, 0.5))
@example(1.0, 2.0, 0.0, 1.9, 0.149, 0.0, math.pi / 2, (0.1, 10.0))
def test_nothing_is_foreseen_to_be_missed_that_the_robot_would_touch(
    speed, turn_rate, faster, quicker, when, heading, beside, accelerations
):
    acceleration, turn_acceleration = accelerations
    limits = Robot(acceleration=acceleration, turn_acceleration=turn_acceleration)
    # An ideal drive with up to 1.9 times its accelerations, in steps of 1 ms or less.
    count = math.ceil(when / 0.001)
    dt = when / count
    middles = (np.arange(count) + 0.5) * dt
    speeds = speed + faster * limits.acceleration * middles
    headings = heading + turn_rate * middles
    headings += quicker * limits.turn_acceleration * middles**2 / 2.0
    x, y = (speeds * np.cos(headings) * dt).sum(), (speeds * np.sin(headings) * dt).sum()
    # A post that it then touches, wherever on its rim.
    reach = FUZZYQ.radius + 0.1
    post = (x + reach * math.cos(beside), y + reach * math.sin(beside), 0.1)
    tick = Tick(0.0, 0.0, 0.0, heading, speed, turn_rate, 0.0, 0.0)
    assert Foresight(Field(np.array([post])), limits).free_steps(tick, 36) * TIME_STEP <= when


def test_a_line_is_cast_once_and_told_as_often_as_asked():
    post = Cylinder(shape="cylinder", position=(3.0, 2.0), radius=0.3)
    with Sight([post], Arena(size=(6.0, 4.0))) as world:
        cast = []

        class Watched:
            def sense(self, origin, headings, *, apart):
                cast.extend(headings)
                return world.sense(origin, headings, apart=apart)

        sense = CastOnce(Watched(), (2.0, 2.0))
        headings = [0.0, 1.0, 2.0, 0.0]
        first = sense(headings)
        assert first == world.sense((2.0, 2.0), headings)
        assert sense([2.0, 0.5, 0.0]) == world.sense((2.0, 2.0), [2.0, 0.5, 0.0])
        assert sense([]) == []
        assert sorted(cast) == [0.0, 0.5, 1.0, 2.0]


@given(
    st.floats(0.05, 1.0),
    st.floats(0.2, 3.0),
    st.floats(0.1, 2.0),
    st.integers(0, 5),
    st.sampled_from(["fuzzy", "improved-fuzzy", "q-learning"]),
)
@settings(max_examples=6)
def test_no_limit_of_the_robot_decides_how_a_point_robot_fares(
    max_speed: float, max_turn_rate: float, acceleration: float, seed: int, planner: str
):
    robot = Robot(max_speed=max_speed, max_turn_rate=max_turn_rate, acceleration=acceleration)
    task = random_task(seed, layout="scatter", count=50)
    task = with_options(task, drive="kinematic", planner=planner)
    usual, slow = run(task), run(task.model_copy(update={"robot": robot}))
    assert slow.digest() == usual.digest()


def test_a_robot_that_turns_slowly_in_a_dead_end_is_waited_for():
    walls = [(4.5, 2.38, 2.0, 0.2), (4.5, 1.62, 2.0, 0.2), (5.5, 2.0, 0.2, 1.0)]
    task = Scenario(
        name="slow-turner",
        arena=Arena(size=(8.0, 4.0)),
        start=Start(position=(5.0, 2.0), heading=0.0),
        goal=Goal(position=(1.0, 2.0)),
        robot=Robot(max_turn_rate=0.2),
        planner=ImprovedFuzzySettings(weights=(1.0, 1.0)),
        obstacles=[
            Box(shape="box", position=(x, y), size=(width, depth)) for x, y, width, depth in walls
        ],
    )
    assert run(task).outcome == "goal"


def test_whoever_is_slow_gets_out_of_a_trap_too():
    robot = Robot(max_speed=0.1, max_turn_rate=0.2, acceleration=0.1, turn_acceleration=0.5)
    task = random_task(3, layout="u-shape", count=None)
    limits = Limits(time=2000.0, steps=10_000)
    task = task.model_copy(update={"robot": robot, "limits": limits})
    assert run(with_options(task, planner="improved-fuzzy")).outcome == "goal"
