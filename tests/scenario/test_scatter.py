"""Claims about drawn obstacles: Algorithm 2 keeps its promises or says that it cannot."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.robots import FUZZYQ
from fuzzyq_bullet.scenario import (
    Scenario,
    dump_scenario,
    find_conflicts,
    parse_scenario,
    realise,
)

PILLARS = [
    {"shape": "cylinder", "position": [5.0, 5.0], "radius": 0.6},
    {"shape": "box", "position": [3.0, 7.0], "size": [1.0, 0.5], "yaw": 0.4},
]


def asked(random, **rest) -> Scenario:
    return Scenario.model_validate(
        {
            "name": "drawn",
            "start": {"position": [1.0, 1.0]},
            "goal": {"position": [9.0, 9.0]},
            "random": random,
            **rest,
        }
    )


def places(scenario: Scenario, first: int = 0) -> np.ndarray:
    return np.array([item.position for item in scenario.obstacles[first:]]).reshape(-1, 2)


@settings(max_examples=60)
@given(
    st.integers(0, 150),
    st.floats(0.025, 0.6),
    st.floats(0.0, 0.5),
    st.booleans(),
    st.tuples(st.floats(0.5, 9.5), st.floats(0.5, 9.5)),
    st.floats(0.05, 1.0),
    st.integers(0, 2**63 - 1),
)
def test_every_obstacle_is_inside_the_arena_and_clear_of_start_and_goal_and_none_is_lacking(
    count, radius, margin, walls, goal, goal_radius, seed
):
    scenario = asked(
        {"count": count, "radius": radius, "margin": margin},
        arena={"walls": walls},
        goal={"position": goal, "radius": goal_radius},
    )
    drawn = realise(scenario, seed)
    at = places(drawn)
    assert len(at) == count
    assert drawn.random is None
    assert drawn.seed == seed
    assert np.all(at >= radius - 1e-5)
    assert np.all(at <= 10.0 - radius + 1e-5)
    for centre, disc in (((1.0, 1.0), FUZZYQ.radius), (goal, max(goal_radius, FUZZYQ.radius))):
        assert np.all(np.hypot(*(at - centre).T) >= radius + disc + margin)
    assert not [c for c in find_conflicts(drawn) if c[0][0] == "obstacles"]


def test_the_same_seed_gives_the_same_obstacles_and_another_seed_others():
    scenario = asked({"count": 50})
    assert realise(scenario, 3) == realise(scenario, 3)
    assert realise(scenario, 3).obstacles != realise(scenario, 4).obstacles
    assert realise(scenario.model_copy(update={"seed": 3})) == realise(scenario, 3)


def test_the_draw_of_a_known_seed_never_changes():
    x, y = np.random.default_rng(0).random(2)  # centres lie 0.2 m within 10 m
    known = realise(asked({"count": 2}), 0).obstacles[0].position
    assert known == (6.3148, 2.79) == (round(0.2 + 9.6 * x, 4), round(0.2 + 9.6 * y, 4))


@pytest.mark.parametrize("overlap", [True, False])
def test_more_obstacles_begin_with_those_of_a_smaller_count(overlap):
    few, many = (
        realise(asked({"count": n, "radius": 0.1, "overlap": overlap}), 1).obstacles
        for n in (20, 150)
    )
    assert many[:20] == few


def test_listed_obstacles_come_first_and_stay():
    scenario = asked({"count": 10}, obstacles=PILLARS)
    drawn = realise(scenario)
    assert drawn.obstacles[:2] == scenario.obstacles
    assert len(drawn.obstacles) == 12


def test_without_a_random_part_only_the_seed_is_set():
    scenario = asked(None, obstacles=PILLARS)
    assert realise(scenario, 7) == scenario.model_copy(update={"seed": 7})


def test_obstacles_overlap_only_where_they_may():
    apart = realise(asked({"count": 100, "radius": 0.3, "overlap": False}, obstacles=PILLARS), 2)
    at = places(apart, 2)
    gaps = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1)) + 9 * np.eye(len(at))
    assert gaps.min() >= 0.6
    assert np.all(np.hypot(*(at - (5.0, 5.0)).T) >= 0.9)
    free = places(realise(asked({"count": 100, "radius": 0.3}), 2))
    gaps = np.hypot(*(free[:, None] - free[None]).transpose(2, 0, 1)) + 9 * np.eye(len(free))
    assert gaps.min() < 0.6


def test_a_drawn_scenario_is_the_same_after_a_trip_through_a_file():
    drawn = realise(asked({"count": 200}, obstacles=PILLARS), 5)
    assert parse_scenario(dump_scenario(drawn)) == drawn


@pytest.mark.slow
@pytest.mark.parametrize(
    ("random", "arena"),
    [
        ({"count": 1, "radius": 5.1}, [10.0, 10.0]),
        ({"count": 1, "margin": 20.0}, [10.0, 10.0]),
        ({"count": 10_000, "radius": 0.2, "overlap": False}, [10.0, 10.0]),  # denser than any
        ({"count": 480, "radius": 0.2, "overlap": False}, [10.0, 10.0]),  # denser than by chance
        ({"count": 10_000, "radius": 0.042, "overlap": False}, [10.0, 10.0]),  # just so
    ],
)
def test_what_cannot_be_placed_is_refused_soon(random, arena):
    with pytest.raises(UserError, match=r"drawn: random.count: cannot place \d+ obstacles"):
        realise(asked(random, arena={"size": arena}))


def test_more_than_the_most_obstacles_are_refused():
    with pytest.raises(UserError, match="more than 10000"):
        realise(asked({"count": 9_999}, obstacles=PILLARS))


@pytest.mark.parametrize("overlap", [True, False])
def test_ten_thousand_obstacles_take_no_time(overlap):
    scenario = asked({"count": 10_000, "radius": 0.025, "overlap": overlap})
    assert len(realise(scenario).obstacles) == 10_000
