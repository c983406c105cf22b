"""Via points on the way, a heading in the goal, and a goal that is driven through."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from fuzzyq_bullet import Scenario, result_of, run
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario import check
from fuzzyq_bullet.scenario.passing import passed_along


def scenario(**told: Any) -> Scenario:
    given = {"name": "s", "start": {"position": [1, 5]}, "goal": {"position": [4, 5]}, **told}
    return Scenario.model_validate(given)


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_via_points_are_passed_at_speed_and_in_order(drive: str) -> None:
    via = [{"position": [3, 6]}, {"position": [2, 4]}]
    task = scenario(drive=drive, via=via)
    done = run(task)
    result = result_of(done)
    assert (result.outcome, result.via_passed) == ("goal", 2)
    at = [np.hypot(*(done.ticks.position - one["position"]).T).min() for one in via]
    assert max(at) <= 0.5
    counts = np.array(passed_along(task.via, done.ticks.position))
    assert (np.diff(counts) >= 0).all()
    assert done.ticks.speed[(counts == 1).argmax()] > 0.5
    assert result.shortest_path_m is not None
    assert result.shortest_path_m <= result.path_length_m


def test_without_via_points_the_result_is_as_before() -> None:
    assert "via_passed" not in result_of(run(scenario())).model_dump()
    assert "via" not in scenario().model_dump()
    assert set(scenario().goal.model_dump()) == {"position", "radius"}


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_the_robot_ends_facing_the_goals_heading(drive: str) -> None:
    task = scenario(drive=drive, goal={"position": [4, 5], "heading": -2.5})
    done = run(task)
    assert done.outcome == "goal"
    assert abs(math.remainder(done.ticks.heading[-1] + 2.5, math.tau)) <= 0.1
    assert np.hypot(*(done.ticks.position[-1] - (4, 5))) <= 0.2


def test_a_goal_without_stop_is_entered_at_speed() -> None:
    done = run(scenario(goal={"position": [4, 5], "radius": 0.5, "stop": False}))
    assert done.outcome == "goal"
    assert done.ticks.speed[-1] > 0.5


def test_a_via_point_behind_a_trap_and_a_way_back_through_known_places() -> None:
    trap = [
        {"shape": "box", "position": [4, 5], "size": [0.2, 3.0]},
        {"shape": "box", "position": [3.3, 6.4], "size": [1.2, 0.2]},
        {"shape": "box", "position": [3.3, 3.6], "size": [1.2, 0.2]},
    ]
    done = run(scenario(via=[{"position": [6, 5]}], goal={"position": [1, 5]}, obstacles=trap))
    assert (done.outcome, result_of(done).via_passed) == ("goal", 1)


@pytest.mark.parametrize(
    ("via", "why"),
    [
        ([{"position": [5, 5]}], "is 0.3 m inside obstacles"),
        ([{"position": [11, 5]}], "is outside the arena"),
        ([{"position": [1.3, 5]}], "is passed at once"),
        ([{"position": [2, 2]}, {"position": [2.1, 2]}], "is passed at once"),
    ],
)
def test_a_via_point_that_cannot_be_meant_is_refused(via: list[Any], why: str) -> None:
    stone = {"shape": "cylinder", "position": [5, 5], "radius": 0.3}
    with pytest.raises(UserError, match=why):
        check(scenario(via=via, obstacles=[stone]))


def test_a_heading_without_a_stop_is_refused() -> None:
    with pytest.raises(ValidationError, match="leave out one of the two"):
        scenario(goal={"position": [4, 5], "heading": 1.0, "stop": False})
