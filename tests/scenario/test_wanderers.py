"""Claims about wanderers in a random field: clear of all that matters, and what stands stays."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario import (
    Limits,
    Scenario,
    check,
    dump_scenario,
    parse_scenario,
    random_task,
    realise,
)
from fuzzyq_bullet.scenario.layouts import Wanderers
from fuzzyq_bullet.scenario.movers import standing_field
from fuzzyq_bullet.studies.episodes import Environment, Job, Outfit

seeds = st.integers(0, 2**63 - 1)


def field(seed: int, count: int = 10, layout: str = "scatter", standing: int | None = 25):
    task = random_task(seed, count=standing, layout=layout)
    movers = Wanderers(count=count)
    return task.model_copy(update={"random": task.random.model_copy(update={"movers": movers})})


@given(seeds, st.sampled_from([("scatter", 25), ("maze", None), ("semicircle", None)]))
@settings(max_examples=20, deadline=None)
def test_they_are_clear_of_start_goal_and_what_stands(seed, layout):
    scenario = realise(field(seed, 10, *layout))
    check(scenario)
    stands = standing_field(scenario.obstacles, scenario.arena)
    robot = scenario.robot.radius
    assert len(scenario.movers) == 10
    for one in (scenario.obstacles[i] for i in scenario.movers):
        assert stands.clearance(one.position)[0] > one.radius
        assert math.dist(one.position, scenario.start.position) > robot + one.radius + 1.0
        assert math.dist(one.position, scenario.goal.position) > one.radius + robot
        assert 0.1 <= one.motion.speed <= 0.5


@given(seeds)
@settings(max_examples=10, deadline=None)
def test_what_stands_is_the_same_and_a_larger_count_begins_with_the_smaller(seed):
    few, many = realise(field(seed, 5)), realise(field(seed, 20))
    alone = realise(random_task(seed, count=25))
    assert few.obstacles[:25] == alone.obstacles
    assert many.obstacles[:30] == few.obstacles


def test_speeds_are_spread_over_the_whole_interval():
    speeds = [one.motion.speed for one in realise(field(3, 150)).obstacles[25:]]
    assert np.histogram(speeds, 4, (0.1, 0.5))[0].min() > 20


def test_a_file_may_ask_for_them_and_another_does_not_tell_of_them():
    told = field(1, 4)
    assert parse_scenario(dump_scenario(told)) == told
    assert "movers" not in dump_scenario(random_task(1))


SPEEDS = "movers.speed: must be the least and the greatest speed (m/s), such as "


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("{count: 2, speed: [0.5, 0.1]}", SPEEDS + "[0.1, 0.5]; got [0.5, 0.1]"),
        ("{count: 2, speed: 0.3}", SPEEDS + "[0.3, 0.3]; got 0.3"),
        ("{count: 2, speed: fast}", SPEEDS + "[0.1, 0.5]; got 'fast'"),
        ("{count: 2, speed: [0.2, x]}", SPEEDS + "[0.2, 0.2]; got [0.2, 'x']"),
        ("{count: 2, speed: [true, 1]}", SPEEDS + "[1, 1]; got [true, 1]"),
        ("{count: 2, speed: []}", SPEEDS + "[0.1, 0.5]; got []"),
        ("{count: 2, speed: -1}", SPEEDS + "[0.1, 0.5]; got -1"),
        ("{count: 2, speed: [0.4, 0.2, 0.3]}", SPEEDS + "[0.2, 0.4]; got [0.4, 0.2, 0.3]"),
        ("{count: 2, speed: [0.1, 20]}", "movers.speed[1]: must be at most 3, got 20"),
        ("{count: 2, speed: [.nan, 0.2]}", "movers.speed[0]: must be finite, got nan"),
        ("{radius: 0.2}", "movers.count: is required"),
        ("{count: 2, radius: 0}", "movers.radius: must be at least 0.02, got 0"),
        ("{count: 2, radius: 6}", "movers.radius: must be less than 5 to fit, got 6"),
    ],
)
def test_mistakes_are_named(given, message):
    text = f"""
name: field
start: {{position: [1, 1]}}
goal: {{position: [9, 9]}}
random: {{count: 5, movers: {given}}}
"""
    with pytest.raises(UserError) as caught:
        parse_scenario(text)
    (line,) = str(caught.value).splitlines()
    assert line.endswith(f":5: random.{message}")


def test_too_many_are_refused():
    cramped = {
        "name": "cramped",
        "arena": {"size": (2.5, 2.5)},
        "start": {"position": (0.5, 0.5)},
        "goal": {"position": (2.0, 2.0)},
        "random": {"count": 0, "movers": {"count": 3, "radius": 1.0}},
    }
    with pytest.raises(UserError, match=r"random\.movers\.count: cannot place 3 of radius 1"):
        realise(Scenario.model_validate(cramped))


def test_a_study_asks_for_them_beside_its_own_obstacles():
    plain = random_task(7, count=25)
    outfit = Outfit(movers=Wanderers(count=5))
    job = Job(Environment("scatter", 25, 0, 7), "fuzzy", plain.planner, "wheels", Limits(), outfit)
    asked = realise(Job.of_order(job.as_order()).scenario())
    assert len(asked.movers) == 5
    assert asked.obstacles[:25] == realise(plain).obstacles
