"""Tables of places: they learn one field, sense nothing, and know no other."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.episode import run_with
from fuzzyq_bullet.planning.position import HEADINGS, Cells, step_of
from fuzzyq_bullet.scenario import Scenario, parse_scenario
from fuzzyq_bullet.studies.episodes import Environment, Job, Row
from fuzzyq_bullet.studies.options import POSITIONAL, described, planners_of
from fuzzyq_bullet.studies.plan import LIMITS
from fuzzyq_bullet.studies.positional import work_for_row
from fuzzyq_bullet.training.position import PositionProblem, learn_position

WALL = """\
name: wall
arena: {size: [4, 4]}
start: {position: [0.6, 2]}
goal: {position: [3.4, 2]}
drive: kinematic
obstacles: [{shape: box, position: [2, 2], size: [0.3, 1.2]}]
"""


def wall() -> Scenario:
    return parse_scenario(WALL)


@given(st.floats(0.0, 10.0), st.floats(0.0, 7.0))
def test_every_place_of_the_arena_has_a_cell_of_its_own_and_its_neighbours(
    x: float, y: float
) -> None:
    cells = Cells.over((10.0, 7.0))
    assert (cells.columns, cells.rows, cells.count) == (25, 18, 450)
    state = cells.state_of((x, y))
    assert 0 <= state < cells.count
    row, column = divmod(state, cells.columns)
    assert column * cells.side - 1e-9 <= x <= (column + 1) * cells.side + 1e-9
    assert row * cells.side - 1e-9 <= y <= (row + 1) * cells.side + 1e-9


def test_a_contact_leaves_the_robot_where_it_was_and_costs() -> None:
    problem = PositionProblem(wall())
    state = problem.reset(1)
    seen = [problem.step(0) for _ in range(6)]  # east, against the wall
    assert [over for _, _, over in seen] == [False] * 6
    assert seen[-1][0] == seen[-2][0] != state
    assert seen[-1][1] < -30.0 < seen[0][1]
    assert problem.outcome == "collision"


@pytest.mark.parametrize("planner", ["q-learning", "q-lambda"])
def test_a_field_is_learned_and_crossed_without_sensing(
    planner: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = wall()
    learned = learn_position(planner, scenario)
    monkeypatch.setattr("fuzzyq_bullet.planning.base.RangeSensor.sense", None)
    driven = run_with(learned, scenario)
    assert driven.outcome == "goal"
    assert driven.physics_steps < 20
    # The same table in another field: it drives into what it has never met.
    other = wall().model_copy(
        update={"obstacles": parse_scenario(WALL.replace("[2, 2]", "[2, 3]")).obstacles}
    )
    assert run_with(learned, other).outcome == "collision"


def test_a_row_is_that_of_a_planner_which_has_learned_its_environment() -> None:
    [settings] = planners_of("q-learning-position").values()
    job = Job(
        Environment.of("scatter", 5, 0, 0), "q-learning-position", settings, "kinematic", LIMITS
    )
    row = Row.model_validate(work_for_row(job.as_order())["row"])
    assert (row.planner, row.outcome, row.collisions) == ("q-learning-position", "goal", 0)
    assert row == Row.model_validate(work_for_row(job.as_order())["row"])


def test_what_a_row_depends_on_is_no_policy_that_is_shipped() -> None:
    told = described(planners_of(POSITIONAL))
    assert all(one["policy"] is None for one in told.values())


@given(st.integers(0, HEADINGS - 1), st.floats(0.0, 20.0))
def test_a_step_is_a_cell_long_and_never_passes_the_goal(action: int, to_goal: float) -> None:
    heading, length = step_of(action, 0.4, to_goal)
    assert length <= to_goal
    assert length in (0.4, to_goal)
    assert math.degrees(heading) == pytest.approx(45.0 * action)
