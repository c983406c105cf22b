"""The sentence that says why, and the moments it belongs to."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from fuzzyq_bullet import episode
from fuzzyq_bullet.planning.base import STEP_UNIT
from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.recording.trajectory import Collision
from fuzzyq_bullet.scenario import Goal, load_scenario
from fuzzyq_bullet.video.captions import Story
from fuzzyq_bullet.video.compositor import Compositor
from fuzzyq_bullet.video.decision_hold import HOLD, DecisionHold
from fuzzyq_bullet.video.explanation import (
    ALIKE,
    STRAIGHT,
    aim_name,
    is_asked,
    is_clear,
    off_aim,
    reason,
    side_of,
    struck,
)
from fuzzyq_bullet.video.map.map import Map
from fuzzyq_bullet.video.panels.action import Action
from fuzzyq_bullet.video.panels.fuzzification import Fuzzification
from fuzzyq_bullet.video.panels.rules import Rules
from fuzzyq_bullet.video.panels.sensors import Sensors
from fuzzyq_bullet.video.record import moments
from fuzzyq_bullet.video.scene.scene import Scene
from fuzzyq_bullet.video.timeline import NO_DECISION, Moment, Timeline
from tests.helpers.synthetic import drive, modes, scenario

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory


def told(facing: float = 0.0, *, heading: float = 0.0, mode: int = 0, **columns: Any) -> Trajectory:
    """Return a record of one decision of a robot whose goal lies straight to the east."""
    record = drive(seconds=0.0)
    values = {
        "heading": heading,
        "mode": mode,
        "lines": (math.pi / 4, 0.0, -math.pi / 4),
        "lengths": (1.0, 1.0, 1.0),
        "distance": 5.0,
        "difference": 0.0,
        "turn": heading / record.scenario.planner.turn_unit,  # type: ignore[attr-defined]
        "aim": record.scenario.goal.position,
        **columns,
    }
    changed = {name: np.array([value]) for name, value in values.items()}
    ticks = replace(record.ticks, heading=np.full_like(record.ticks.heading, facing))
    return replace(record, ticks=ticks, decisions=replace(record.decisions, **changed))


def said(facing: float = 0.0, **columns: Any) -> str:
    """Return the sentence for one decision."""
    return reason(told(facing, **columns), 0)


def test_a_clear_way() -> None:
    assert said() == "Way is clear: straight to the goal"
    # What counts is where the aim lies, wherever the robot still faces.
    assert said(0.5) == "Way is clear: straight to the goal"
    assert said(lengths=(1.0, 0.6, 1.0), distance=3.0).startswith("Sides alike")


@pytest.mark.parametrize(
    ("goal", "facing", "said"),
    [
        ({"heading": 1.5}, 0.0, "In the goal: turns to its heading"),
        ({"heading": 1.5}, 1.45, "In the goal: stops"),
        ({}, 0.0, "In the goal: stops"),
        ({"stop": False}, 0.0, "Way is clear: straight to the goal"),
    ],
)
def test_in_the_goal_no_decision_moves_the_robot(
    goal: dict[str, Any], facing: float, said: str
) -> None:
    record = told(facing)
    here = record.ticks.position[0].tolist()
    for away, sentence in ((0.1, said), (0.5, "Way is clear: straight to the goal")):
        place = Goal(position=(here[0] + away, here[1]), **goal)
        there = record.scenario.model_copy(update={"goal": place})
        assert reason(replace(record, scenario=there), 0) == sentence


WAY_OUT: dict[str, Any] = {"mode": 2, "aim": (2.0, 5.0), "target": (2.5, 6.0), "reach": 1.0}


@pytest.mark.parametrize(("more", "name"), [({}, "the goal"), (WAY_OUT, "the way out")])
def test_the_freer_side_and_both_distances(more: dict[str, Any], name: str) -> None:
    blocked: dict[str, Any] = {"lengths": (0.9, 0.3, 0.4), "distance": 1.5, "difference": 2.5}
    assert said(heading=0.6, **blocked, **more) == (
        f"Left is freer (0.9 m against 0.4 m): heads left of {name}"
    )
    mirrored: dict[str, Any] = {"lengths": (0.4, 0.3, 0.9), "distance": 1.5, "difference": -2.5}
    assert said(heading=-0.6, **mirrored, **more) == (
        f"Right is freer (0.9 m against 0.4 m): heads right of {name}"
    )
    small = said(heading=-0.05, **mirrored, **more)
    assert small.endswith(f"0.3 m towards {name}: nearly straight")


def test_the_freer_side_is_the_one_that_measures_more_whatever_the_turn() -> None:
    blocked: dict[str, Any] = {"lengths": (0.4, 0.3, 1.0), "distance": 1.5, "difference": -3.0}
    assert said(heading=0.6, **blocked) == (
        "Right is freer (1.0 m against 0.4 m), yet the rules lead left of the goal"
    )


def moving(speed: float, facing: float = 0.0, **columns: Any) -> str:
    """Return the sentence for one decision of a robot that moves."""
    run = told(facing, **columns)
    ticks = replace(run.ticks, speed=np.full_like(run.ticks.speed, speed))
    return reason(replace(run, ticks=ticks), 0)


@pytest.mark.parametrize("more", [{}, WAY_OUT])
def test_a_turn_that_the_filter_holds_back_is_not_called_the_controllers(
    more: dict[str, Any],
) -> None:
    blocked: dict[str, Any] = {"lengths": (0.4, 0.3, 0.9), "distance": 1.5, "difference": -2.5}
    held = {"heading": 0.6, "turn": -1.0, **blocked, **more}
    assert moving(0.6, **held) == "No room yet to turn so far: brakes first"
    assert moving(0.0, **held) == "No room for an arc: turns 34° left on the spot"
    stopped = {"heading": -0.6, **blocked, **more, "reach": 0.0}
    assert moving(0.6, **stopped) == "No room yet to turn so far: brakes first"
    # How far is counted from its nose, not from the aim as on the dial.
    assert moving(0.0, **stopped) == "No room for an arc: turns 34° right on the spot"
    assert moving(0.0, -0.5, **stopped) == "No room for an arc: turns 6° right on the spot"
    assert moving(0.6, **{**stopped, "reach": 0.1}).startswith("Right is freer")


def test_sides_that_round_to_the_same_are_told_more_exactly() -> None:
    sentence = said(heading=0.3, lengths=(0.44, 0.2, 0.38), distance=1.0, difference=0.3)
    assert sentence.startswith("Left is freer (0.44 m against 0.38 m)")


def test_equal_sides() -> None:
    sentence = said(lengths=(0.4, 0.3, 0.4), distance=1.5)
    assert sentence == "Sides alike (0.4 m), 0.3 m towards the goal: straight on"


def test_nothing_in_sight() -> None:
    assert said(**WAY_OUT) == "Nothing in sight: straight to the way out"


def test_a_breakout_is_named() -> None:
    near: dict[str, Any] = {"lengths": (0.9, 0.1, 0.2), "distance": 0.5, "difference": 3.5}
    assert said(heading=1.0, **near, **{**WAY_OUT, "mode": 1}) == (
        "Blocked towards the goal: breaks out"
    )


def test_a_gap_that_is_aimed_at_exactly() -> None:
    narrow: dict[str, Any] = {"lengths": (0.1, 0.8, 0.2), "distance": 4.0, "difference": -0.5}
    exact: dict[str, Any] = {"exact": 1.0, "heading": 0.0, "turn": -1.0, **narrow}
    assert said(**exact, **WAY_OUT) == "Aims at a gap on the way out: the rules are not asked"
    assert said(**exact) == "Line to the goal leads on (0.8 m): straight to the goal"


def test_what_a_way_out_of_version_0_1_0_said_is_seen_from_the_goal() -> None:
    old: dict[str, Any] = {**WAY_OUT, "aim": (math.nan, math.nan), "exact": math.nan, "turn": 1.0}
    assert said(heading=1.0, **old) == "On a way out: heads left of the goal"
    assert said(heading=3.0, **old) == "On a way out: heads away from the goal"


@pytest.mark.parametrize("mode", [1, 2])
def test_a_robot_without_a_way_on_says_so_and_one_that_only_waits_does_not(mode: int) -> None:
    stopped: dict[str, Any] = {**WAY_OUT, "mode": mode, "step": 0.0, "reach": 0.0}
    nowhere: dict[str, Any] = {**stopped, "target": (math.nan, math.nan)}
    assert said(**nowhere) == "Finds no way on: stops"
    assert "stops" not in said(1.0, **stopped)


def test_both_modes_of_a_run_in_a_trap_are_told_truly(trapped: Trajectory) -> None:
    facts = trapped.decisions
    names = [MODES[k] for k in facts.mode.tolist()]
    assert names.count("following") > 10
    for k, mode in enumerate(names):
        sentence, lean = reason(trapped, k), off_aim(trapped, k)
        assert ("breaks out" in sentence) == (mode == "breakout")
        assert is_asked(facts, k) == (facts.exact[k] == 0.0)
        if found := re.search(r"heads (left|right) of (the .*)", sentence):
            assert lean * (1 if found[1] == "left" else -1) >= STRAIGHT
            assert side_of(trapped, k) == (1 if found[1] == "left" else -1)
            assert found[2] == ("the goal" if mode == "routine" else "the way out")
        if "not asked" in sentence:
            assert facts.exact[k] == 1.0
            assert abs(lean) < STRAIGHT
    spoken = {reason(trapped, k) for k, mode in enumerate(names) if mode == "following"}
    assert any("freer" in one and "way out" in one for one in spoken)


def test_a_planner_that_explains_nothing() -> None:
    blank: dict[str, Any] = {
        "lengths": (math.nan,) * 3,
        "lines": (math.nan,) * 3,
        "difference": math.nan,
        "aim": (math.nan, math.nan),
    }
    run = told(**blank)
    (x, y), goal = run.ticks.position[0].tolist(), run.scenario.goal.position
    bearing = math.atan2(goal[1] - y, goal[0] - x)
    assert said(heading=bearing, **blank) == "Straight to the goal"
    assert said(heading=bearing + 1.0, **blank) == "Heads left of the goal"
    assert said(heading=bearing - 1.0, **blank) == "Heads right of the goal"


def test_the_last_frame_says_how_the_run_ended_and_not_what_was_decided_last() -> None:
    for outcome, words in (
        ("goal", "In the goal"),
        ("timeout", "Time is up before the goal"),
        ("stuck", "Finds no way on: stops"),
    ):
        run = drive(seconds=1.0, outcome=outcome)  # type: ignore[arg-type]
        assert Story(run).sentence(3, over=True) == words
        assert Story(run).sentence(3) == reason(run, 3)


@pytest.fixture(scope="module")
def real() -> Trajectory:
    return episode.run(load_scenario("figure-12a"))


@pytest.fixture(scope="module")
def trapped() -> Trajectory:
    return episode.run(load_scenario("figure-10b"))


@pytest.mark.slow
@pytest.mark.parametrize("speed", [1.0, 4.0])
def test_in_every_frame_the_sentence_is_true_of_what_the_panels_show(
    real: Trajectory, speed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: dict[str, int] = {}
    for panel in (Sensors, Fuzzification, Rules, Action):

        def draw(_: Any, moment: Moment, name: str = panel.__name__) -> None:
            drawn[name] = moment.shown

        monkeypatch.setattr(panel, "draw", draw)

    def tell(_: Any, decision: int, *, over: bool) -> None:
        drawn["Story"] = decision

    monkeypatch.setattr(Story, "draw", tell)
    monkeypatch.setattr(Scene, "draw", lambda *_: None)
    monkeypatch.setattr(Map, "draw", lambda *_: None)
    story, facts = Story(real), real.decisions
    with Compositor(real, speed) as compositor:
        for moment in moments(Timeline(real), speed):
            drawn.clear()
            if not list(compositor.changes(moment)) and not drawn:
                continue  # the closing frame stays
            assert len(drawn) == 5
            [decision] = set(drawn.values())
            sentence = story.sentence(decision, over=moment.over)
            if not moment.over:
                assert sentence == reason(real, decision)
                _agrees(real, decision, sentence)
            # Never older than the hold allows.
            assert decision <= moment.decision
            if decision < moment.decision:
                replaced = float(real.ticks.time[facts.tick[decision + 1]])
                assert moment.time - replaced < HOLD * speed


def _agrees(run: Trajectory, decision: int, sentence: str) -> None:
    """Check a sentence against the numbers that the panels show for a decision."""
    facts = run.decisions
    left, middle, right = facts.lengths[decision].tolist()
    lean = off_aim(run, decision)
    side = re.search(r"(Left|Right) is freer \((.+) m against (.+) m\)", sentence)
    if side:
        more, less = (left, right) if side[1] == "Left" else (right, left)
        assert float(side[2]) == pytest.approx(more, abs=0.051)
        assert float(side[3]) == pytest.approx(less, abs=0.051)
        assert more - less >= ALIKE
    if kept := re.search(r"(?:heads|lead) (left|right) of (the .*)", sentence):
        assert (lean > 0.0) == (kept[1] == "left")
        assert kept[2] == aim_name(run, decision)
    for number in re.findall(r"([\d.]+) m towards", sentence):
        assert float(number) == pytest.approx(middle, abs=0.051)
    if "straight to" in sentence:
        assert abs(lean) < STRAIGHT
    if MODES[int(facts.mode[decision])] == "routine":
        assert ("Way is clear" in sentence) <= is_clear(facts, decision)
    if is_clear(facts, decision):
        assert not side
        assert (
            middle > 4.9 * STEP_UNIT
            or middle
            >= math.dist(run.ticks.position[facts.tick[decision]], run.scenario.goal.position)
            - 1e-9
        )


def test_a_decision_stays_long_enough_to_be_read() -> None:
    run = drive(scenario(60, 5, seed=4))
    timeline, hold = Timeline(run), DecisionHold(run)
    seen = [hold.at(timeline.at(k / 30)) for k in range(int(timeline.end * 30))]
    changes = np.flatnonzero(np.diff(seen)) + 1
    assert len(changes) > 5
    for before, after in pairwise(changes.tolist()):
        if after - before < HOLD * 30 - 1:
            old, new = seen[after - 1], seen[after]
            turned = off_aim(run, old) * off_aim(run, new) < 0
            assert turned or is_clear(run.decisions, old)


def test_a_change_of_mode_is_shown_at_once() -> None:
    run = modes(drive(seconds=3.0), (0, 0.5), (1, 0.5))
    timeline, hold = Timeline(run), DecisionHold(run)
    first = int(np.flatnonzero(run.decisions.mode)[0])
    change = float(run.ticks.time[run.decisions.tick[first]])
    assert hold.at(timeline.at(change - 0.01)) < first
    assert hold.at(timeline.at(change)) == first
    assert "breaks out" in reason(run, first)


def test_what_was_hit_is_named_by_kind_and_place() -> None:
    run = drive(scenario(2, 1), seconds=1.0, outcome="timeout")
    hit = Collision(1.0, (2.0, 4.2), 0, 12.0)
    x, y = run.scenario.obstacles[0].position
    assert struck(replace(run, collision=hit)) == f"the cylinder at ({x:.1f}, {y:.1f})"
    assert struck(replace(run, collision=replace(hit, obstacle=2))).startswith("the box at (")
    wall = replace(run, collision=replace(hit, obstacle=-1), outcome="collision")
    assert struck(wall) == "a wall"
    assert Story(wall).sentence(3, over=True) == "Ran into a wall"
    assert Story(wall).sentence(3) == reason(wall, 3)


def test_pose_between_ticks_takes_the_short_way_round() -> None:
    run = drive(seconds=1.0)
    ticks = run.ticks
    heading, position = ticks.heading.copy(), ticks.position.copy()
    heading[3:5] = math.radians(175.0), math.radians(-175.0)
    position[3:5] = (1.0, 2.0), (2.0, 4.0)
    changed = replace(run, ticks=replace(ticks, heading=heading, position=position))
    moment = Timeline(changed).at(3.5 / 30)
    assert math.cos(moment.heading) == pytest.approx(-1.0)
    assert moment.position == pytest.approx((1.5, 3.0))


def test_the_decision_in_force_is_the_last_one_taken() -> None:
    run = drive(seconds=1.0)
    timeline = Timeline(run)
    assert [timeline.at(k / 30 + 1e-6).decision for k in range(6)] == [0, 0, 1, 1, 2, 2]
    assert timeline.at(-5.0).time == 0.0
    assert timeline.at(99.0).time == 1.0
    later = replace(run, decisions=replace(run.decisions, tick=run.decisions.tick + 3))
    assert Timeline(later).at(0.0).decision == NO_DECISION


def test_an_infinite_clearance_stays_one() -> None:
    run = drive(seconds=1.0)
    far = replace(run.ticks, clearance=np.full_like(run.ticks.clearance, np.inf))
    assert Timeline(replace(run, ticks=far)).at(0.05).clearance == math.inf
