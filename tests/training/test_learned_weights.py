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
from fuzzyq_bullet.planning.fuzzy_q_lambda import (
    CHOICE_NAMES,
    CHOICES,
    STEPS,
    TURNS,
    firing,
    rule_names,
    twins_of,
    weighed,
    weights_of,
)
from fuzzyq_bullet.planning.policies import shipped
from fuzzyq_bullet.scenario import Scenario, Start, load_scenario, random_task, realise
from fuzzyq_bullet.training.problems import RuleWeightsProblem
from fuzzyq_bullet.training.tasks import FIRST_SEED, ROOM, TRIES, Tasks

if TYPE_CHECKING:
    from pathlib import Path


PAPER = paper_controller()
RULE_NAMES = rule_names(PAPER.base)
TWINS = twins_of(PAPER.base)


def thinking(*best: int) -> Policy:
    """A policy whose rules think most of these choices in turn."""
    rows = [
        [float(number == best[rule % len(best)]) for number in range(len(CHOICES))]
        for rule in range(len(RULE_NAMES))
    ]
    return Policy(
        planner="fuzzy-q-lambda",
        learner="fuzzy-q-lambda",
        command="by hand",
        seed=0,
        version="0",
        drive="wheels",
        scenario="none",
        episodes=1,
        parameters={},
        states=RULE_NAMES,
        actions=CHOICE_NAMES,
        table=rows,
    )


@given(st.floats(0.0, 5.0), st.floats(-5.0, 5.0))
def test_the_shares_of_the_rules_sum_to_one_whatever_is_sensed(
    distance: float, difference: float
) -> None:
    shares = firing(PAPER.infer(distance, difference))
    assert shares.sum() == pytest.approx(1.0)
    assert (shares >= 0.0).all()
    weights = np.array([CHOICES[rule % len(CHOICES)] for rule in range(len(RULE_NAMES))])
    step, turn = weighed(shares, weights)
    assert min(STEPS) - 1e-9 <= step <= max(STEPS) + 1e-9
    assert min(TURNS) - 1e-9 <= turn <= max(TURNS) + 1e-9


def test_the_rule_that_fires_alone_has_the_weights_that_it_learned() -> None:
    number = RULE_NAMES.index("M NS")
    policy = thinking(0)
    rows = [list(row) for row in policy.table]
    rows[number][-1] = 2.0
    weights = weights_of(policy.model_copy(update={"table": rows}))
    assert tuple(weights[number]) == CHOICES[-1]
    alone = np.eye(len(RULE_NAMES))[number]
    assert weighed(alone, weights) == CHOICES[-1]
    strongest = firing(PAPER.infer(2.49, -2.22))
    assert int(strongest.argmax()) == number


@given(st.floats(0.0, 5.0), st.floats(0.0, 0.5))
def test_the_twin_of_a_rule_fires_for_the_same_thing_on_the_other_side(
    distance: float, difference: float
) -> None:
    # Near Df = 0, where the two ends of Table 2, which are no mirror images, have no say.
    here, there = (firing(PAPER.infer(distance, side * difference)) for side in (1, -1))
    assert here == pytest.approx(there[list(TWINS)], abs=0.03)
    assert [RULE_NAMES[twin] for twin in TWINS[:5]] == ["VN PB", "VN PS", "VN ZO", "VN NS", "VN NB"]


@pytest.mark.slow
@pytest.mark.parametrize("choice", [1, len(CHOICES) - 1])
def test_a_policy_of_one_answer_drives_like_fixed_weights(choice: int, tmp_path: Path) -> None:
    path = tmp_path / "one.json"
    thinking(choice).save(path)
    chosen = CHOICES[choice]
    task = realise(random_task(5, count=30))
    fixed = ImprovedFuzzySettings(weights=(chosen.step, chosen.turn), breakout_at=4.0)
    one, other = (
        run(task.model_copy(update={"planner": settings}))
        for settings in (fixed, FuzzyQLambdaSettings(policy=str(path)))
    )
    # The shares sum to 1 but for the last digit, and so do weights that are all the same.
    assert one.outcome == other.outcome == "goal"
    assert other.ticks.time[-1] == pytest.approx(one.ticks.time[-1], abs=0.1)
    assert other.decisions.weights == pytest.approx(np.full((other.decisions.tick.size, 2), chosen))


def test_the_weights_in_force_are_those_of_the_rules_that_fire(tmp_path: Path) -> None:
    path = tmp_path / "all.json"
    policy = thinking(*range(len(CHOICES)))
    policy.save(path)
    task = realise(random_task(6, count=40))
    record = run(task.model_copy(update={"planner": FuzzyQLambdaSettings(policy=str(path))}))
    decisions = record.decisions
    fired = decisions.rules.reshape(len(decisions.tick), -1)
    shares = fired / fired.sum(axis=1, keepdims=True)
    assert decisions.weights == pytest.approx(shares @ weights_of(policy))
    assert len({tuple(pair) for pair in decisions.weights.round(3).tolist()}) > 20


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


def test_the_default_planner_s_rules_have_weights_of_their_own() -> None:
    assert DEFAULT_PLANNER == load_scenario("mixed").planner.name == "fuzzy-q-lambda"
    among = run(realise(random_task(3, count=40))).decisions
    assert len({tuple(pair) for pair in among.weights.round(3).tolist()}) > 1
    assert set(among.breakout_at.tolist()) == {4.0}


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


def earned(problem: RuleWeightsProblem, choice: int) -> tuple[list[float], int]:
    """Play the first episode with one choice; return its rewards and the number of its steps."""
    problem.reset(1)
    rewards, over = [], False
    while not over:
        _, reward, over = problem.step([choice] * len(RULE_NAMES))
        rewards.append(reward)
    return rewards, len(rewards)


@pytest.mark.slow
def test_what_an_episode_earns_is_its_delay() -> None:
    tasks = Tasks(drive="wheels", scenario=load_scenario("u-shape"))
    problem = RuleWeightsProblem(tasks, settings=FuzzyQLambdaSettings(), discount=1.0)
    rewards, steps = earned(problem, 4)
    assert problem.outcome == "goal"
    scenario = tasks.scenario_of(1)
    way = DistanceField(scenario).at(*scenario.start.position)
    assert way > math.dist(scenario.start.position, scenario.goal.position) + 0.4
    # All but the last few centimetres within the goal, and the last step may be shorter.
    delay = way / scenario.robot.max_speed - 0.3 * steps
    assert sum(rewards) == pytest.approx(delay, abs=scenario.goal.radius / 0.6 + 0.3)
    # Ways out are told by the truth: without it the same weights take longer in a trap.
    fixed = ImprovedFuzzySettings(weights=tuple(CHOICES[4]), breakout_at=4.0)
    alone = run(scenario.model_copy(update={"planner": fixed}))
    assert alone.ticks.time[-1] > 0.3 * steps + 1.0


def test_discounted_the_way_that_is_left_counts_by_what_it_is_worth_later() -> None:
    # Σ γᵏ·(γΦ' − Φ) leaves −Φ(start) and the end: whatever is done in between changes nothing.
    tasks, discount = Tasks(drive="wheels", scenario=load_scenario("open-field")), 0.9
    sums = []
    for choice in (1, 4):
        rewards, steps = earned(
            RuleWeightsProblem(tasks, settings=FuzzyQLambdaSettings(), discount=discount), choice
        )
        spent = -0.3 * sum(discount**k for k in range(steps))
        sums.append(sum(discount**k * reward for k, reward in enumerate(rewards)) - spent)
    scenario = tasks.scenario_of(1)
    at_start = DistanceField(scenario).at(*scenario.start.position) / scenario.robot.max_speed
    assert sums == pytest.approx([at_start] * 2, abs=0.3 + 0.02 * at_start)


def test_tasks_repeat_have_a_way_and_are_none_that_a_sweep_has() -> None:
    tasks = Tasks(seed=3)
    first = [tasks.scenario_of(episode) for episode in range(1, 6)]
    assert first == [tasks.scenario_of(episode) for episode in range(1, 6)]
    assert len({one.seed for one in first}) == len(first)
    assert all(feasible(one, ROOM) and one.seed >= FIRST_SEED for one in first)
    assert [len(one.obstacles) for one in first] == [50, 75, 100, 25, 50]
    assert tasks.digest() != Tasks(seed=4).digest()


def test_corridors_of_pillars_follow_after_the_last_number_of_obstacles() -> None:
    tasks = Tasks(counts=(5, 10), cellular=True)
    assert [tasks.is_corridor(episode) for episode in range(1, 7)] == [False, True, False] * 2
    names = [tasks.scenario_of(episode).name.split("-")[0] for episode in range(1, 4)]
    assert names[1] == "cellular" != names[0] == names[2]
    assert tasks.digest() != Tasks(counts=(5, 10)).digest()


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
