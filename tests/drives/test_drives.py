"""What the drives share: no robot is too slow to arrive."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.planning import ImprovedFuzzySettings
from fuzzyq_bullet.scenario import (
    Arena,
    Box,
    Goal,
    Limits,
    Robot,
    Scenario,
    Start,
    random_task,
    with_options,
)


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


@pytest.mark.slow
def test_whoever_is_slow_gets_out_of_a_trap_too():
    robot = Robot(max_speed=0.1, max_turn_rate=0.2, acceleration=0.1, turn_acceleration=0.5)
    task = random_task(3, layout="u-shape", count=None)
    limits = Limits(time=2000.0)
    task = task.model_copy(update={"robot": robot, "limits": limits})
    assert run(with_options(task, planner="improved-fuzzy")).outcome == "goal"
