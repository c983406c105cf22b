"""The planner ``fuzzy-q-lambda``, and the problem that it learns."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.fuzzy.paper import paper_controller
from fuzzyq_bullet.ground_truth import feasible, shortest_path
from fuzzyq_bullet.ground_truth.distance_field import DistanceField
from fuzzyq_bullet.learning import Policy
from fuzzyq_bullet.planning import (
    DEFAULT_PLANNER,
    FuzzyQLambdaSettings,
    ImprovedFuzzySettings,
    make_planner,
)
from fuzzyq_bullet.planning.decision import MODES, Mode
from fuzzyq_bullet.planning.fuzzy import Situation
from fuzzyq_bullet.planning.fuzzy_q_lambda import (
    ACTION_NAMES,
    ACTIONS,
    STATE_NAMES,
    OptionTermination,
    features_of,
)
from fuzzyq_bullet.planning.policies import shipped
from fuzzyq_bullet.scenario import Scenario, Start, load_scenario, random_task, realise
from fuzzyq_bullet.training.problems import WeightsProblem
from fuzzyq_bullet.training.tasks import FIRST_SEED, ROOM, TRIES, Tasks

if TYPE_CHECKING:
    from pathlib import Path


def situation(distance: float, difference: float) -> Situation:
    inferred = paper_controller().infer(distance, difference)
    return Situation(0.0, 1.0, (0.8, 0.0, -0.8), np.ones(3), distance, difference, False, inferred)


def thinking(*best: int) -> Policy:
    """A policy that thinks most of these actions in turn, from state to state."""
    rows = [
        [float(number == best[state % len(best)]) for number in range(len(ACTIONS))]
        for state in range(len(STATE_NAMES))
    ]
    return Policy(
        planner="fuzzy-q-lambda",
        learner="linear-q-lambda",
        command="by hand",
        seed=0,
        version="0",
        drive="wheels",
        scenario="none",
        episodes=1,
        parameters={},
        states=STATE_NAMES,
        actions=ACTION_NAMES,
        table=rows,
    )


@given(st.floats(0.0, 5.0), st.floats(-5.0, 5.0))
def test_the_rules_make_the_state_and_sum_to_one(distance: float, difference: float) -> None:
    state = features_of(situation(distance, difference))
    assert state.values.sum() == pytest.approx(1.0)
    assert (state.values >= 0.0).all()


@given(st.floats(0.0, 5.0), st.floats(0.0, 0.5))
def test_what_stands_on_the_left_is_learned_from_what_stood_on_the_right(
    distance: float, difference: float
) -> None:
    # Near Df = 0, where the two ends of Table 2, which are no mirror images, have no say.
    dense = np.zeros((2, len(STATE_NAMES)))
    for row, sign in zip(dense, (1, -1), strict=True):
        state = features_of(situation(distance, sign * difference))
        row[state.indices] = state.values
    assert dense[0] == pytest.approx(dense[1], abs=0.03)


def test_the_strongest_feature_is_called_by_what_there_is() -> None:
    def strongest(distance: float, difference: float) -> str:
        state = features_of(situation(distance, difference))
        return STATE_NAMES[int(state.indices[state.values.argmax()])]

    assert strongest(0.1, 0.0) == "VN even"
    assert strongest(2.5, -2.2) == "M small"
    assert strongest(5.0, 5.0) == "VF big"
    clear = features_of(situation(5.0, 0.0)._replace(clear=True))
    assert [STATE_NAMES[index] for index in clear.indices] == ["clear"]


@given(st.lists(st.tuples(st.floats(0.0, 3.0), st.sampled_from(MODES), st.booleans()), max_size=40))
def test_a_choice_stands_until_the_robot_is_nearer_than_ever_and_on_no_way_out(
    seen: list[tuple[float, Mode, bool]],
) -> None:
    encounters, nearest, chosen, was_clear = OptionTermination(), math.inf, math.inf, False
    for to_goal, mode, clear in seen:
        enough = 0.2 if clear != was_clear else 1.0
        wanted = mode == "routine" and to_goal <= nearest and to_goal <= chosen - enough
        assert encounters.ends(to_goal, mode, clear=clear) == wanted
        nearest = min(nearest, to_goal)
        if wanted:
            chosen, was_clear = to_goal, clear


@pytest.mark.slow
def test_it_chooses_anew_only_where_an_encounter_begins(tmp_path: Path) -> None:
    path = tmp_path / "two.json"
    thinking(0, 1, len(ACTIONS) - 1).save(path)
    task = realise(random_task(6, count=75))
    record = run(task.model_copy(update={"planner": FuzzyQLambdaSettings(policy=str(path))}))
    decisions = record.decisions
    away = np.hypot(*(record.ticks.position[decisions.tick] - task.goal.position).T)
    changed = np.flatnonzero((decisions.weights[1:] != decisions.weights[:-1]).any(axis=1)) + 1
    assert changed.size > 3
    assert (decisions.mode > 0).any()
    for index in changed:
        assert decisions.mode[index] == 0
        assert away[index] <= away[:index].min()


@pytest.mark.slow
@pytest.mark.parametrize("action", [0, len(ACTIONS) - 1])
def test_a_policy_that_knows_one_answer_drives_like_fixed_weights(
    action: int, tmp_path: Path
) -> None:
    path = tmp_path / "one.json"
    thinking(action).save(path)
    chosen = ACTIONS[action]
    task = realise(random_task(5, count=30))
    fixed = ImprovedFuzzySettings(
        weights=(chosen.step, chosen.turn), breakout_at=chosen.breakout_at
    )
    digests = {
        run(task.model_copy(update={"planner": settings})).digest()
        for settings in (fixed, FuzzyQLambdaSettings(policy=str(path)))
    }
    assert len(digests) == 1


def test_with_a_larger_c_f_it_breaks_out_before_it_is_near() -> None:
    task = realise(random_task(8, count=30))
    settings = ImprovedFuzzySettings(weights=(2.0, 0.5), breakout_at=5.0)
    record = run(task.model_copy(update={"planner": settings}))
    decisions = record.decisions
    here = record.ticks.position[decisions.tick]
    to_goal = np.hypot(*(here - task.goal.position).T)
    middle = decisions.lengths[:, 1]
    assert (
        middle[decisions.mode == 0] >= np.minimum(to_goal, 1.0)[decisions.mode == 0] - 1e-9
    ).all()
    assert middle[decisions.mode == 1][0] > 0.5


def test_it_chooses_by_situation() -> None:
    assert DEFAULT_PLANNER == load_scenario("mixed").planner.name == "fuzzy-q-lambda"
    among = run(realise(random_task(3, count=40))).decisions
    assert len({tuple(pair) for pair in among.weights.tolist()}) > 1
    assert len(set(among.breakout_at.tolist())) > 1


def test_a_policy_file_that_changes_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "p.json"
    settings, rng = FuzzyQLambdaSettings(policy=str(path)), np.random.default_rng(0)
    thinking(0).save(path)
    make_planner(settings, rng)
    path.write_text("{}")
    with pytest.raises(UserError, match=r"p\.json"):
        make_planner(settings, rng)
    path.unlink()
    with pytest.raises(UserError, match="make one with fuzzyq train fuzzy-q-lambda"):
        make_planner(settings, rng)


def test_a_policy_for_other_states_is_refused(tmp_path: Path) -> None:
    data = json.loads(shipped("fuzzy-q-lambda").read_text())
    data["states"][3] = "somewhere else"
    path = tmp_path / "p.json"
    path.write_text(json.dumps(data))
    with pytest.raises(UserError, match="states: number 3 is 'somewhere else'"):
        make_planner(FuzzyQLambdaSettings(policy=str(path)), np.random.default_rng(0))


@pytest.mark.slow
def test_what_an_episode_earns_is_its_delay(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fuzzyq_bullet.training.problems.MOST_LOST", math.inf)
    tasks = Tasks(drive="wheels", scenario=load_scenario("u-shape"))
    problem = WeightsProblem(tasks)
    problem.reset(1)
    total, steps, over = 0.0, 0, False
    while not over:
        _, reward, over = problem.step(len(ACTIONS) - 1)
        total, steps = total + reward, steps + 1
    assert problem.outcome == "goal"
    scenario = tasks.scenario_of(1)
    way = DistanceField(scenario).at(*scenario.start.position)
    assert way > math.dist(scenario.start.position, scenario.goal.position) + 0.4
    # The same drive once more, for its time. All but the last few centimetres within the goal.
    fixed = ImprovedFuzzySettings(weights=ACTIONS[-1][:2], breakout_at=ACTIONS[-1].breakout_at)
    time = run(scenario.model_copy(update={"planner": fixed})).ticks.time[-1]
    delay = way / scenario.robot.max_speed - time
    assert total == pytest.approx(delay, abs=scenario.goal.radius / 0.6)
    assert 3 < steps < time / 0.25 / 2


def test_a_long_search_counts_for_no_more_than_the_most(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fuzzyq_bullet.training.problems.MOST_LOST", 0.25)
    problem = WeightsProblem(Tasks(drive="wheels", scenario=load_scenario("u-shape")))
    problem.reset(1)
    earned, over = [], False
    while not over:
        _, reward, over = problem.step(0)
        earned.append(reward)
    assert min(earned) == -0.25


def test_tasks_repeat_have_a_way_and_are_none_that_a_sweep_has() -> None:
    tasks = Tasks(seed=3)
    first = [tasks.scenario_of(episode) for episode in range(1, 6)]
    assert first == [tasks.scenario_of(episode) for episode in range(1, 6)]
    assert len({one.seed for one in first}) == len(first)
    assert all(feasible(one, ROOM) and one.seed >= FIRST_SEED for one in first)
    assert [len(one.obstacles) for one in first] == [50, 75, 100, 25, 50]
    assert tasks.digest() != Tasks(seed=4).digest()


def test_a_field_without_a_way_is_drawn_anew() -> None:
    dense = [Tasks(counts=(125,)).scenario_of(episode) for episode in range(1, 9)]
    assert all(feasible(one, ROOM) for one in dense)
    assert any(one.seed % TRIES for one in dense)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1])
def test_ways_are_those_of_the_oracle(seed: int) -> None:
    scenario = realise(random_task(seed, count=60))
    distances, rng = DistanceField(scenario), np.random.default_rng([seed, 77])
    checked = 0
    for x, y in rng.uniform(0.5, 9.5, (40, 2)):
        there = scenario.model_copy(update={"start": Start(position=(float(x), float(y)))})
        # A grid misses the narrowest gaps, and no more than those.
        least, most = shortest_path(there, 0.21), shortest_path(there, 0.26)
        if least is None or most is None or most.length == 0.0:
            continue
        checked += 1
        length = distances.at(float(x), float(y)) - scenario.goal.radius  # not to its centre
        assert least.length - 0.05 <= length <= 1.06 * most.length + 0.1
    assert checked > 15


def test_ways_are_finite_where_there_is_none() -> None:
    obstacles = [
        {"shape": "box", "position": [5.0, 5.0], "size": [0.2, 9.99]},
        {"shape": "cylinder", "position": [8.0, 2.0], "radius": 0.5},
    ]
    scenario = Scenario.model_validate(
        {
            "name": "walled",
            "start": {"position": [1, 5]},
            "goal": {"position": [9, 5]},
            "obstacles": obstacles,
        }
    )
    distances = DistanceField(scenario)
    places = [(1.0, 5.0), (5.0, 5.0), (0.0, 0.0), (9.0, 5.0), (8.0, 2.0)]
    assert all(math.isfinite(distances.at(*place)) for place in places)
    assert distances.at(9.0, 5.0) < 0.1
