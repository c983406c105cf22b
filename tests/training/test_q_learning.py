"""The direct planners: states and headings, how they drive, and what they learn."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.episode import STUCK_TIME, run, run_in
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning import Policy, Schedule, load_policy
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.planning import QLambdaSettings, QLearningSettings, make_planner, planner_names
from fuzzyq_bullet.planning.base import STEP_UNIT, Observation, RangeSensor
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.policies import shipped
from fuzzyq_bullet.planning.q_learning import (
    ACTION_NAMES,
    ACTIONS,
    BORDERS,
    POLICY_SPECS,
    STATE_NAMES,
    DirectPlanner,
    act,
    sense,
    state_of,
)
from fuzzyq_bullet.recording.metrics import result_of
from fuzzyq_bullet.scenario import Scenario, load_scenario, parse_scenario
from fuzzyq_bullet.training.problems import PATIENCE, DirectProblem, TrainingEpisode
from fuzzyq_bullet.training.registry import learn, recipe_of
from fuzzyq_bullet.training.rewards import USUAL
from fuzzyq_bullet.training.tasks import Tasks

SETTINGS = {"q-learning": QLearningSettings(), "q-lambda": QLambdaSettings()}
PLANNERS = tuple(SETTINGS)
STRAIGHT = ACTION_NAMES.index("straight")


def policy(planner: str, best: Sequence[int], **changed: object) -> Policy:
    """A policy made by hand: which action is best in each state."""
    expected = POLICY_SPECS[planner]
    table = [
        [0.0 if action == one else -1.0 for action in range(len(ACTION_NAMES))] for one in best
    ]
    return Policy.model_validate(
        {
            "planner": planner,
            "learner": planner,
            "command": "by hand",
            "seed": 0,
            "version": "0",
            "drive": "kinematic",
            "scenario": "none",
            "episodes": 0,
            "parameters": {},
            "states": tuple(expected.states),
            "actions": tuple(expected.actions),
            "table": tuple(map(tuple, table)),
            **changed,
        }
    )


def world_of(planner: str, obstacles: str = "", drive: str = "kinematic") -> Scenario:
    return parse_scenario(
        "name: a\narena: {size: [6.0, 4.0]}\nstart: {position: [1.0, 2.0]}\n"
        f"goal: {{position: [4.13, 2.4]}}\ndrive: {drive}\nlimits: {{time: 19.9}}\n"
        f"planner: {planner}\n{obstacles}"
    )


BLOCK = "obstacles: [{shape: box, position: [2.5, 2.2], size: [0.4, 1.2]}]\n"


# --- states and actions


def test_there_are_64_states_and_5_headings_with_names_of_their_own() -> None:
    assert len(set(STATE_NAMES)) == 64
    assert len(set(ACTION_NAMES)) == 5
    assert STATE_NAMES[0] == "left blocked, ahead blocked, right blocked"
    assert STATE_NAMES[-1] == "left free, ahead free, right free"


@given(st.tuples(*[st.floats(0.0, allow_infinity=True)] * 3))
def test_any_three_lengths_are_a_state_which_is_named_after_them(
    lengths: tuple[float, float, float],
) -> None:
    levels = []
    for length in lengths:
        names = ("blocked", "near", "middling", "free")
        levels.append(names[sum(length >= border for border in np.multiply(BORDERS, STEP_UNIT))])
    said = "left {}, ahead {}, right {}".format(*levels)
    assert STATE_NAMES[state_of(lengths)] == said


def test_every_state_is_met_by_some_lengths() -> None:
    middles = (0.1, 0.3, 0.6, 0.9)
    met = {state_of((a, b, c)) for a in middles for b in middles for c in middles}
    assert met == set(range(64))


def test_a_level_begins_at_its_border_and_the_first_border_is_a_step() -> None:
    assert BORDERS[0] == 1.0
    for unit in (STEP_UNIT, 0.35):  # of the default robot, and of a larger one
        for number, border in enumerate(BORDERS):
            length = border * unit
            below, at = (state_of((0, 0, x), unit) for x in (math.nextafter(length, 0.0), length))
            assert (below, at) == (number, number + 1)


def test_states_and_headings_are_mirrored_in_the_line_to_the_goal() -> None:
    for name in STATE_NAMES:
        left, ahead, right = (part.split()[1] for part in name.split(", "))
        assert f"left {right}, ahead {ahead}, right {left}" in STATE_NAMES
    turns = [action.turn for action in ACTIONS]
    assert turns == [-turn for turn in reversed(turns)]
    for action in ACTIONS:
        side = "left" if action.turn > 0 else "right" if action.turn < 0 else "straight"
        assert action.name.startswith(side)
    # Two headings are lines that are sensed: it is known whether a step along them is free.
    seen = sense(_facing((0.5, 0.6, 0.7)))
    assert {seen.aim.bearing + turn for turn in turns[1:4]} == set(seen.lines)


def test_what_stands_behind_the_goal_is_not_in_the_way() -> None:
    near = replace(_facing((0.5, 0.3, 0.5)), goal=(0.29, 0.0))
    far = replace(near, goal=(0.31, 0.0))
    assert STATE_NAMES[sense(near).state] == "left middling, ahead free, right middling"
    assert STATE_NAMES[sense(far).state] == "left middling, ahead near, right middling"
    assert act(sense(near), STRAIGHT).step == STEP_UNIT
    beside = replace(near, goal=(0.0, 0.12), sensor=_telling((0.5, 0.3, 0.5)))
    assert act(sense(beside), STRAIGHT).step == pytest.approx(0.12)


def _telling(lengths: tuple[float, float, float]) -> RangeSensor:
    return RangeSensor(lambda headings: lengths, lambda headings: lengths)


def _facing(lengths: tuple[float, float, float]) -> Observation:
    """What a robot at the origin sees whose goal is far ahead."""
    return Observation(
        time=0.0,
        position=(0.0, 0.0),
        heading=0.0,
        speed=0.0,
        turn_rate=0.0,
        goal=(8.0, 0.0),
        goal_radius=0.2,
        range=1.0,
        radius=0.22,
        sensor=_telling(lengths),
    )


# --- driving


def test_they_stand_between_the_other_planners() -> None:
    assert planner_names()[:5] == (
        "fuzzy",
        "improved-fuzzy",
        "q-learning",
        "q-lambda",
        "fuzzy-q-lambda",
    )


@pytest.mark.parametrize("drive", ["kinematic", "wheels"])
@pytest.mark.parametrize("planner", PLANNERS)
def test_straight_in_every_state_is_straight_to_a_goal_that_nothing_hides(
    planner: str, drive: str
) -> None:
    scenario = world_of(planner, drive=drive)
    driver = DirectPlanner(SETTINGS[planner], policy(planner, [STRAIGHT] * 64))
    with World(scenario.obstacles, scenario.arena) as world:
        trajectory = run_in(world, scenario, driver)
    assert trajectory.outcome == "goal"
    way = np.array(trajectory.ticks.position)
    moved = np.hypot(*np.diff(way, axis=0).T).sum()
    straight = math.dist((1.0, 2.0), (4.13, 2.4))
    assert moved <= straight + 0.01
    decisions = trajectory.decisions
    assert set(decisions.mode.tolist()) == {0}  # routine
    # What there is to see is told; what has no meaning here is not.
    assert np.isfinite(decisions.lines).all()
    assert np.isfinite(decisions.lengths).all()
    for blank in (decisions.near, decisions.rules, decisions.turn, decisions.weights):
        assert np.isnan(blank).all()


def test_straight_in_every_state_is_straight_into_what_stands_there() -> None:
    scenario = world_of("q-learning", BLOCK)
    driver = DirectPlanner(SETTINGS["q-learning"], policy("q-learning", [STRAIGHT] * 64))
    with World(scenario.obstacles, scenario.arena) as world:
        assert run_in(world, scenario, driver).outcome == "collision"


def test_the_heading_is_the_one_worth_most_in_the_state_at_hand() -> None:
    best = [state % len(ACTIONS) for state in range(64)]
    driver = DirectPlanner(SETTINGS["q-lambda"], policy("q-lambda", best))
    for lengths in ((0.1, 0.3, 0.9), (0.9, 0.1, 0.6), (0.3, 0.3, 0.3), (1.0, 1.0, 1.0)):
        decision = driver.decide(_facing(lengths))
        assert decision.heading == ACTIONS[best[state_of(lengths)]].turn
        assert list(decision.lengths) == list(lengths)


@pytest.mark.parametrize("planner", PLANNERS)
def test_the_policy_that_is_shipped_drives_round_a_pillar(planner: str) -> None:
    pillar = "obstacles: [{shape: cylinder, position: [2.6, 2.25], radius: 0.2}]\n"
    trajectory = run(world_of(planner, pillar))
    assert trajectory.outcome == "goal"
    assert run(world_of(planner, pillar)).digest() == trajectory.digest()


@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize("drive", ["kinematic", pytest.param("wheels", marks=pytest.mark.slow)])
def test_with_filter_and_ways_out_it_touches_nothing_and_gets_out_of_a_trap(
    planner: str, drive: str
) -> None:
    trap = load_scenario("u-shape").model_copy(update={"drive": drive})
    settings = {"guard": True, "breakout": True}
    ends = []
    for how in ({}, settings):
        chosen = type(SETTINGS[planner]).model_validate({"name": planner, **how})
        ends.append(run(trap.model_copy(update={"planner": chosen})))
    alone, guarded = ends
    assert alone.outcome != "goal"
    assert guarded.outcome == "goal"
    assert result_of(guarded).collisions == 0
    assert {1, 2} & set(guarded.decisions.mode.tolist())  # a way out, told as such


@pytest.mark.parametrize("planner", PLANNERS)
def test_a_policy_of_something_else_is_refused_in_one_line(planner: str, tmp_path: Path) -> None:
    (other,) = set(PLANNERS) - {planner}
    wrong = policy(other, [0] * 64)
    with pytest.raises(UserError, match=f"is a policy of the planner '{other}'") as caught:
        DirectPlanner(SETTINGS[planner], wrong)
    assert len(caught.value.problems) == 1
    path = tmp_path / "wrong.json"
    wrong.save(path)
    settings = SETTINGS[planner].model_copy(update={"policy": str(path)})
    with pytest.raises(UserError, match=f"wrong.json: is a policy of .*one of '{planner}'"):
        make_planner(settings, np.random.default_rng(0))
    # The right planner, but a state that means something else.
    names = ("left walled", *STATE_NAMES[1:])
    with pytest.raises(UserError, match="states: number 0 is 'left walled'"):
        DirectPlanner(SETTINGS[planner], policy(planner, [0] * 64, states=names))


# --- learning


def trained(planner: str, episodes: int = 3, trace_decay: Schedule | None = None) -> Policy:
    recipe = recipe_of(planner)
    setup = replace(recipe.setup(episodes, 0), max_steps=150)
    if trace_decay is not None:
        setup = replace(setup, trace_decay=trace_decay)
    tasks = Tasks(drive="kinematic", seed=0, counts=(10,))
    return learn(recipe, tasks, setup, command="test")[0]


@pytest.mark.parametrize("planner", PLANNERS)
def test_the_same_seed_gives_the_same_policy_to_the_byte(planner: str) -> None:
    first = trained(planner)
    assert np.array(first.table).any()
    assert trained(planner).dumps() == first.dumps()
    POLICY_SPECS[planner].check(first, "here")


def test_each_learns_with_the_discount_of_its_equation() -> None:
    assert {p: recipe_of(p).learner().describe()["discount"] for p in PLANNERS} == {
        "q-learning": 0.9,
        "q-lambda": 0.95,
    }


def test_traces_matter_to_the_one_that_has_them() -> None:
    long = Schedule(0.9)
    assert trained("q-lambda").table != trained("q-lambda", trace_decay=long).table
    assert trained("q-learning").table == trained("q-learning", trace_decay=long).table


def test_a_robot_that_hits_something_is_put_back_and_pays_for_it_once() -> None:
    problem = DirectProblem(Tasks(drive="kinematic", scenario=world_of("q-learning", BLOCK)))
    state, hits = problem.reset(1), []
    assert problem.outcome == "going on"
    for _ in range(29):  # 2/3 s each: the next is the last in 19.9 s
        after, reward, over = problem.step(STRAIGHT)
        assert not over
        if reward < -USUAL.hit:
            hits.append(reward)
            assert after == state  # where it was
        state = after
    assert hits == pytest.approx([-USUAL.hit - 2 / 3] * len(hits))
    assert len(hits) > 15
    assert problem.outcome == "collision"
    assert problem.step(STRAIGHT)[2]  # its time is up, however often it was put back
    assert problem.outcome == "collision"


def test_without_a_contact_it_earns_what_any_robot_would() -> None:
    problem = DirectProblem(Tasks(drive="kinematic", scenario=world_of("q-lambda")))
    problem.reset(1)
    total, over = 0.0, False
    while not over:
        _, reward, over = problem.step(STRAIGHT)
        total += reward
    assert problem.outcome == "goal"
    distance = math.dist((1.0, 2.0), (4.13, 2.4))
    steps = math.ceil((distance - 0.2) / STEP_UNIT)
    assert total == pytest.approx(steps * (STEP_UNIT / 0.6 - 2 / 3))


def test_practice_ends_with_a_hit_where_hits_end_it() -> None:
    episode = TrainingEpisode(Tasks(drive="kinematic", scenario=world_of("q-learning", BLOCK)))
    episode.begin(1)
    while not episode.over:
        reward = episode.advance(act(sense(episode.observe()), STRAIGHT))
    assert episode.outcome == "collision"
    assert reward.contact == -USUAL.hit


def test_practice_gives_up_sooner_than_a_run() -> None:
    episode = TrainingEpisode(Tasks(drive="wheels", scenario=world_of("q-learning", BLOCK)))
    episode.begin(1)
    while not episode.over:
        still = episode.observe()
        episode.advance(Decision(heading=still.heading, step=0.0))
    assert episode.outcome == "stuck"
    assert still.time < PATIENCE < STUCK_TIME < still.time + 6.0


@pytest.mark.parametrize("drive", ["kinematic", "wheels"])
def test_a_robot_put_back_is_where_it_decided(drive: str) -> None:
    episode = TrainingEpisode(
        Tasks(
            drive="wheels" if drive == "wheels" else "kinematic",
            scenario=world_of("q-learning", BLOCK),
        ),
        hits_end=False,
    )
    episode.begin(1)
    for _ in range(400):
        before = episode.observe()
        reward = episode.advance(act(sense(before), STRAIGHT))
        if reward.contact:
            break
    after = episode.observe()
    assert reward.contact == -USUAL.hit
    assert reward.progress == pytest.approx(0.0, abs=1e-4)
    assert after.position == pytest.approx(before.position, abs=1e-4)
    assert after.speed == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("planner", PLANNERS)
def test_shipped_policies_are_read_as_what_they_are(planner: str) -> None:
    found = load_policy(shipped(planner), POLICY_SPECS[planner])
    assert (found.episodes, found.seed, found.drive) == (200, 0, "kinematic")
    assert f"fuzzyq train {planner} " in found.command
