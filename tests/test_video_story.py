"""The sentence that says why, and the moments it belongs to."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from synthetic import drive, modes, scenario

from fuzzyq_bullet.video.story import READING_TIME, Narrator, reason
from fuzzyq_bullet.video.timeline import NO_DECISION, Timeline


def said(facing: float = 0.0, *, heading: float = 0.0, mode: int = 0, **columns: Any) -> str:
    """Return the sentence for one decision of a robot whose goal lies straight to the east."""
    record = drive(seconds=0.0).decisions
    values = {
        "heading": heading,
        "mode": mode,
        "lines": (math.pi / 4, 0.0, -math.pi / 4),
        "lengths": (1.0, 1.0, 1.0),
        "distance": 5.0,
        "difference": 0.0,
        **columns,
    }
    changed = {name: np.array([value]) for name, value in values.items()}
    return reason(replace(record, **changed), 0, facing)


def test_a_clear_way() -> None:
    assert said() == "Way is clear: straight to the goal"
    assert said(0.5) == "Way is clear: turns right, to the goal"
    assert said(-0.5) == "Way is clear: turns left, to the goal"


def test_the_freer_side_and_both_distances() -> None:
    blocked = {"lengths": (0.9, 0.3, 0.4), "distance": 1.5, "difference": 2.5}
    assert said(heading=0.6, **blocked) == "Left is freer (0.9 m against 0.4 m): turns left"
    assert said(0.6, heading=0.6, **blocked).endswith(": keeps left")
    assert said(1.2, heading=0.6, **blocked).endswith(": keeps left, a little less")
    mirrored = {"lengths": (0.4, 0.3, 0.9), "distance": 1.5, "difference": -2.5}
    assert said(heading=-0.6, **mirrored) == "Right is freer (0.9 m against 0.4 m): turns right"


def test_sides_that_round_to_the_same_are_told_more_exactly() -> None:
    sentence = said(heading=0.3, lengths=(0.44, 0.2, 0.38), distance=1.0, difference=0.3)
    assert sentence.startswith("Left is freer (0.44 m against 0.38 m)")


def test_equal_sides() -> None:
    sentence = said(lengths=(0.4, 0.3, 0.4), distance=1.5)
    assert sentence == "Both sides alike (0.4 m), 0.3 m ahead: straight on, slower"


def test_other_modes_are_named() -> None:
    assert said(heading=1.0, mode=1) == "Way to the goal is blocked: breaks out to the left"
    assert said(mode=2) == "Large obstacle in the way: follows its edge"
    assert said(heading=-1.0, mode=2).endswith("follows its edge, turns right")


def test_a_planner_that_explains_nothing() -> None:
    blank = {"lengths": (math.nan,) * 3, "lines": (math.nan,) * 3, "difference": math.nan}
    assert said(**blank) == "Drives straight on"
    assert said(heading=1.0, **blank) == "Turns left"


def test_a_sentence_stays_long_enough_to_be_read() -> None:
    run = drive(scenario(60, 5, seed=4))
    timeline, narrator = Timeline(run), Narrator(run.decisions)
    shown: list[tuple[float, str]] = []
    for k in range(int(timeline.end * 30)):
        moment = timeline.at(k / 30)
        sentence = narrator.tell(moment)
        if not shown or shown[-1][1] != sentence:
            shown.append((moment.time, sentence))
    assert len(shown) > 5
    gaps = np.diff([time for time, _ in shown])
    assert gaps.min() >= READING_TIME - 1e-9


def test_a_change_of_mode_is_told_at_once() -> None:
    run = modes(drive(seconds=3.0), (0, 0.5), (1, 0.5))
    timeline, narrator = Timeline(run), Narrator(run.decisions)
    change = float(run.ticks.time[run.decisions.tick[np.flatnonzero(run.decisions.mode)[0]]])
    narrator.tell(timeline.at(change - 0.05))
    assert "breaks out" in narrator.tell(timeline.at(change))


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
