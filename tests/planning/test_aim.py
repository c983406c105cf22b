"""Steps 8 to 11 in the paper's order: an aim, three lines towards it, rules, weights."""

import math

import numpy as np
import pytest

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning import ImprovedFuzzySettings
from fuzzyq_bullet.planning.aim import along_heading, towards_goal
from fuzzyq_bullet.planning.escape.escape import Escape
from fuzzyq_bullet.planning.escape.exploration import ExplorationGraph
from fuzzyq_bullet.planning.escape.frontiers import Frontier
from fuzzyq_bullet.planning.escape.path_follower import PathFollower, Segment
from fuzzyq_bullet.planning.fuzzy import Routine
from fuzzyq_bullet.planning.improved_fuzzy import ImprovedFuzzyPlanner
from fuzzyq_bullet.planning.scan import scan_360
from tests.helpers.exploring import observe

HERE = (0.0, 0.0)
POST_ON_THE_RIGHT = Field(np.array([[0.75, -0.5, 0.2]]))
"""Beside the way to the goal: the line straight on is free as far as the robot sees."""
WALL = Field(boxes=np.array([[0.7, 0.0, 0.1, 3.0, 0.0]]))


def routine(**settings):
    return Routine(ImprovedFuzzySettings(**settings))


def test_the_lines_are_cast_towards_the_aim_and_the_rules_turn_off_it():
    seen = observe(POST_ON_THE_RIGHT, HERE, goal=(0.0, 9.0))
    aim = along_heading(seen, 0.4, 0.5, "following", (0.5, 0.2))
    situation = routine().sense(seen, aim)
    assert situation.lines[1] == 0.4
    weak, strong = (routine().step(situation, (1.0, w2)) for w2 in (0.25, 1.0))
    assert situation.difference > 0.0  # more room on the left
    assert strong.heading - 0.4 == pytest.approx(4.0 * (weak.heading - 0.4))
    assert weak.heading > 0.4
    assert (weak.aim, weak.target, weak.mode) == (aim.point, (0.5, 0.2), "following")


def test_the_step_is_weighted_on_a_way_out_too():
    seen = observe(POST_ON_THE_RIGHT, HERE)
    situation = routine().sense(seen, along_heading(seen, 0.0, 0.9, "following", (0.9, 0.0)))
    half, full = (routine().step(situation, (w1, 1.0)).step for w1 in (0.5, 1.0))
    assert 0.0 < half == pytest.approx(full / 2)


def test_an_exact_aim_is_headed_for_without_the_rules():
    seen = observe(POST_ON_THE_RIGHT, HERE)
    aim = towards_goal(seen)
    turned, straight = (
        routine().step(routine().sense(seen, one), (1.0, 1.0))
        for one in (aim, aim._replace(exact=True))
    )
    assert (turned.exact, straight.exact) == (0.0, 1.0)
    assert turned.heading > 0.05
    assert straight.heading == aim.bearing


@pytest.mark.parametrize(("goal", "clear"), [((0.8, 0.0), True), ((5.0, 0.0), False)])
def test_nothing_is_to_be_avoided_only_where_the_line_is_free_up_to_the_goal(goal, clear):
    seen = observe(POST_ON_THE_RIGHT, HERE, goal=goal)
    assert seen.sense([0.0]) == [seen.range]
    situation = routine().sense(seen)
    assert situation.clear == clear
    assert (situation.difference == 0.0) == clear
    assert routine(clear="range").sense(seen).clear  # as far as it sees is enough there


def test_on_a_way_out_there_is_always_something_to_judge():
    seen = observe(POST_ON_THE_RIGHT, HERE)
    situation = routine().sense(seen, along_heading(seen, 0.0, 0.5, "breakout", (0.5, 0.0)))
    assert not situation.clear
    assert situation.difference > 0.0


def test_without_rules_it_goes_straight_with_the_longest_step():
    seen = observe(POST_ON_THE_RIGHT, HERE)
    decision = routine(rules="none").step(routine(rules="none").sense(seen), (1.0, 1.0))
    assert (decision.heading, decision.step) == (0.0, pytest.approx(2.0 * seen.unit))
    assert np.sum(decision.rules) == 0.0


def test_where_the_way_is_blocked_the_planner_aims_at_a_frontier_in_sight():
    settings = ImprovedFuzzySettings(weights=(1.0, 0.25), breakout_at=4.0)
    seen = observe(WALL, HERE, goal=(5.0, 0.0))
    decision = ImprovedFuzzyPlanner(settings).decide(seen)
    assert decision.mode == "breakout"
    assert math.dist(decision.aim, HERE) <= seen.range
    assert decision.lines[1] == pytest.approx(math.atan2(decision.aim[1], decision.aim[0]))


@pytest.mark.parametrize(("far", "scans"), [(0.25, 1), (0.35, 2)])
def test_it_looks_around_again_on_its_way_to_a_frontier(far, scans, monkeypatch):
    looks = []

    def counted(observation):
        looks.append(observation.position)
        return scan_360(observation)

    monkeypatch.setattr("fuzzyq_bullet.planning.escape.exploration.scan_360", counted)
    escape = Escape()
    first = escape.aim(observe(WALL, HERE, goal=(5.0, 0.0)), 4.0)
    there = (far * math.cos(first.bearing), far * math.sin(first.bearing))
    escape.aim(observe(WALL, there, goal=(5.0, 0.0), time=0.5), 4.0)
    assert len(looks) == scans


def test_a_frontier_that_it_turned_away_from_once_is_gone_to_the_end(monkeypatch):
    a, b = (Frontier(0, (0.0, y), 0.0, 3.0, None) for y in (3.0, -3.0))
    best = [(one, [HERE, one.point]) for one in (a, b) * 10]
    monkeypatch.setattr(ExplorationGraph, "best_frontier", lambda *_: best.pop(0))
    escape, targets = Escape(), []
    for k in range(8):
        here = (0.0, 0.35 * (k % 2))
        seen = observe(WALL, here, goal=(5.0, 0.0), time=0.5 * k)
        targets.append(escape.aim(seen, 4.0).target[1])
    assert targets == [3.0, -3.0] + [3.0] * 6


@pytest.mark.parametrize("exact", [True, False])
def test_a_gap_is_aimed_at_exactly(exact, monkeypatch):
    leg = Segment(1.2, 0.5, exact=exact)
    monkeypatch.setattr(PathFollower, "next", lambda self, observation: leg)
    assert Escape().aim(observe(WALL, HERE, goal=(5.0, 0.0)), 4.0).exact is exact


def test_a_frontier_that_was_not_reached_is_aimed_at_exactly_the_second_time():
    escape, tries = Escape(), {}
    for k in range(400):  # the robot is held where it is
        aim = escape.aim(observe(WALL, HERE, goal=(5.0, 0.0), time=0.25 * k), 4.0)
        if aim.hopeless:
            break
        tries.setdefault(aim.target, []).append(aim.exact)
    first = next(iter(tries.values()))
    assert first == sorted(first)  # at first by the rules, then without
    assert set(first) == {True, False}
