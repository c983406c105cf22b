"""What the panels say, of planners with rules and of those without."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from fuzzyq_bullet import episode, with_options
from fuzzyq_bullet.learning import load_policy
from fuzzyq_bullet.planning import FuzzyQLambdaSettings
from fuzzyq_bullet.planning.fuzzy_q_lambda import weights_of
from fuzzyq_bullet.planning.policies import shipped
from fuzzyq_bullet.scenario import load_scenario, random_task, realise
from fuzzyq_bullet.video import paint
from fuzzyq_bullet.video.asked import asks, metres
from fuzzyq_bullet.video.captions import routine_name
from fuzzyq_bullet.video.compositor import Compositor, closing
from fuzzyq_bullet.video.decision_hold import DecisionHold
from fuzzyq_bullet.video.panels.rules import rule_weights
from fuzzyq_bullet.video.timeline import Timeline, sensor_range
from tests.helpers.synthetic import drive, scenario

if TYPE_CHECKING:
    from pathlib import Path

    from fuzzyq_bullet.recording.trajectory import Trajectory

RULED = {"sides:", "left freer", "VN", "ω1", "ω2", "c_f"}


def texts(run: Trajectory, monkeypatch: pytest.MonkeyPatch, *, over: bool = False) -> set[str]:
    """Return all that is written in a frame drawn at once, at 0.5 s or at the end."""
    written: set[str] = set()
    real = paint.write

    def write(image: Any, at: Any, text: str, *args: Any, **more: Any) -> None:
        written.add(text)
        real(image, at, text, *args, **more)

    monkeypatch.setattr(paint, "write", write)
    with Compositor(run) as compositor:
        moment = Timeline(run).at(99.0 if over else 0.5)
        list(compositor.changes(closing(moment) if over else moment))
    return written


def facts(run: Trajectory, **columns: Any) -> Trajectory:
    """Return the record with other numbers in all its decisions."""
    count = len(run.decisions.tick)
    changed = {name: np.tile(value, (count, 1)) for name, value in columns.items()}
    flat = {name: one[:, 0] if one.shape[1] == 1 else one for name, one in changed.items()}
    return replace(run, decisions=replace(run.decisions, **flat))


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return drive(scenario(4, 0), seconds=1.0, outcome="timeout")


def test_the_weights_and_c_f_in_force_are_shown(
    run: Trajectory, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = texts(facts(run, weights=(10.0, 0.25), breakout_at=4.0), monkeypatch)
    assert shown >= {*RULED, "10", "0.25", "4"}
    many = facts(run, weights=(11.0625, 0.03125), breakout_at=2.5)
    assert texts(many, monkeypatch) >= {"11.1", "0.03", "2.5"}  # whole, and not cut off


@pytest.mark.parametrize(
    ("columns", "name"),
    [({}, "the goal"), ({"mode": 2, "aim": (3.0, 5.0), "target": (3.5, 6.0)}, "the way out")],
)
def test_every_panel_names_the_same_aim(
    run: Trajectory, columns: dict[str, Any], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    towards = float(run.decisions.lines[0, 1])
    shown = texts(facts(run, heading=towards + np.radians(20.0), **columns), monkeypatch)
    # Panels 1, 2 and 4: the middle line, d, and the heading.
    assert shown >= {f"to {name}", f"to {name}:", "20° left", f"of {name}"}
    assert not any("ahead" in text for text in shown)


def asked(run: Trajectory, **columns: Any) -> list[tuple[str, str]]:
    """Return what the first decision asks for, with such numbers."""
    return list(asks(facts(run, **columns), 0))


def test_what_is_asked_and_known_free_is_of_one_decision_and_bounded(run: Trajectory) -> None:
    # The wheels drive the longest step (0.4 m) at full speed (0.6 m/s); no hall is 12 m long.
    speed, free = asked(run, step=12.1, reach=0.0, guard=0.77)
    assert speed == ("speed asked", "0.60 m/s")
    # A robot that must turn on the spot first has a reach of 0; what it found free is not 0.
    assert free == ("known free", "0.77 m")
    assert asked(run, step=0.1, reach=0.5, guard=1.0) == [
        ("speed asked", "0.15 m/s"),
        ("known free", "> 1.00 m"),  # as far as it sees, as panel 1 says of its lines
    ]


def test_a_jump_is_asked_in_metres_and_is_no_longer_than_what_is_known_free() -> None:
    record = episode.run(with_options(load_scenario("boxes"), drive="kinematic"))
    facts_of, far = record.decisions, sensor_range(record)
    assert facts_of.reach.max() > 2.0 * far  # it is no distance that anyone saw
    for index in range(len(facts_of.tick)):
        (name, step), (beside, free) = asks(record, index)
        assert (name, beside) == ("step asked", "known free")
        length, room = (float(text.strip("> m")) for text in (step, free))
        assert length <= room <= round(far, 2)
        before, after = record.ticks.position[facts_of.tick[index] : facts_of.tick[index] + 2]
        assert length == pytest.approx(math.dist(before, after), abs=0.006)


def test_what_no_filter_found_free_is_not_called_known(run: Trajectory) -> None:
    nothing = {"step": 0.1, "guard": np.nan}
    assert asked(run, reach=np.inf, **nothing)[1] == ("known free", "not checked")
    # The way to the goal is a limit of planners without the filter, too.
    assert asked(run, reach=8.59, **nothing)[1] == ("stops within", "8.59 m")
    point = replace(run, scenario=run.scenario.model_copy(update={"drive": "kinematic"}))
    assert asked(point, reach=8.59, **nothing)[1] == ("known free", "–")


@pytest.mark.parametrize(("backward", "speed"), [(0.0, -0.2), (1.0, 0.2)])
def test_a_robot_that_rolls_the_other_way_has_sensed_nothing(
    run: Trajectory, backward: float, speed: float
) -> None:
    stops = facts(run, step=0.1, reach=0.0, guard=0.0, backward=backward)
    rolls = replace(stops, ticks=replace(stops.ticks, speed=np.full_like(stops.ticks.speed, speed)))
    assert asks(rolls, 0)[1] == ("known free", "not checked")
    sign = "−" if backward else ""
    stands = asks(stops, 0)
    assert stands == (("speed asked", f"{sign}0.15 m/s"), ("known free", "0.00 m"))


def test_panel_4_shows_what_is_asked_for(run: Trajectory, monkeypatch: pytest.MonkeyPatch) -> None:
    shown = texts(facts(run, step=6.96, guard=0.42), monkeypatch)
    assert shown >= {"speed asked", "0.60 m/s", "known free", "0.42 m", "nearest thing"}
    assert not shown & {"step asked", "last step"}


@pytest.mark.parametrize("explained", [True, False])
def test_a_robot_that_jumps_has_no_speed(explained: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    planner = "fuzzy-q-lambda" if explained else "tangent-bug"
    task = with_options(load_scenario("boxes"), drive="kinematic", planner=planner)
    record = episode.run(task)
    shown = texts(record, monkeypatch, over=True)
    last = record.ticks.position[-2:]
    assert shown >= {"last step", f"{math.dist(*last):.2f} m", "nearest in step"}
    assert not shown & {"speed", "speed asked", "nearest thing", "turning"}
    assert ("turned" in shown) != explained


def test_a_nothing_has_no_sign(monkeypatch: pytest.MonkeyPatch) -> None:
    assert [metres(one) for one in (-0.004, 0.004, -0.01)] == ["0.00 m", "0.00 m", "−0.01 m"]
    blank = drive(scenario(4, 0), seconds=1.0, outcome="timeout", explained=False)
    touching = np.full_like(blank.ticks.clearance, -1e-4)
    shown = texts(replace(blank, ticks=replace(blank.ticks, clearance=touching)), monkeypatch)
    assert "nearest thing 0.00 m" in shown
    assert not any("-0" in text or "−0.00" in text for text in shown)


@pytest.mark.parametrize(("rate", "words"), [(0.5, "29°/s left"), (-0.5, "29°/s right")])
def test_a_twist_is_shown_in_place_of_a_step(
    run: Trajectory, rate: float, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = texts(facts(run, twist_speed=-0.25, twist_turn_rate=rate), monkeypatch)
    assert shown >= {"speed asked", "−0.25 m/s", "turn asked", words}
    assert not shown & {"step asked", "known free"}


def test_sides_that_are_not_asked_for_say_what_they_count_as(
    run: Trajectory, monkeypatch: pytest.MonkeyPatch
) -> None:
    clear = {"lengths": (0.4, 1.0, 0.9), "distance": 5.0, "difference": 0.0, "mode": 0}
    shown = texts(facts(run, **clear), monkeypatch)
    assert shown >= {"way is clear", "−0.50 m", "taken as 0", "taken as alike"}


def test_a_planner_without_rules_has_panels_that_tell_of_what_it_does(
    run: Trajectory, monkeypatch: pytest.MonkeyPatch
) -> None:
    blank = drive(scenario(4, 0), seconds=1.0, outcome="timeout", explained=False)
    shown = texts(blank, monkeypatch)
    assert not shown & RULED
    assert shown >= {"2  HEADS FOR", "3  KEEPS CLEAR", "casts no", "turning"}
    assert shown >= {"arrow: heading", "sees up to", "1.00 m"}
    decision = DecisionHold(blank).at(Timeline(blank).at(0.5))
    near = float(blank.ticks.clearance[blank.decisions.tick[decision]])
    assert f"nearest thing {near:.2f} m" in shown


@pytest.mark.parametrize("explained", [True, False])
def test_the_paper_s_words_for_modes_are_of_planners_with_rules_alone(
    explained: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = drive(scenario(4, 0), seconds=1.0, outcome="timeout", explained=explained)
    half = np.arange(len(run.decisions.tick)) > len(run.decisions.tick) // 2
    followed = replace(run, decisions=replace(run.decisions, mode=np.where(half, 2, 0)))
    assert routine_name(followed) == ("routine" if explained else "improved-fuzzy")
    shown = texts(followed, monkeypatch)
    ruled, others = {"frontier", "breakout"}, {"blocked"}
    assert shown & (ruled | others) == (ruled if explained else others)


def test_in_the_last_frame_the_robot_is_in_the_goal_and_heads_nowhere(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    arrived = drive(scenario(0, 0, start=(8.0, 5.75)), seconds=30.0)
    assert arrived.outcome == "goal"
    shown = texts(arrived, monkeypatch, over=True)
    assert shown >= {"In the goal", "in the goal", "3  RULES NOT ASKED"}
    assert not any("straight" in text for text in shown)
    assert "3  RULES THAT FIRE" in texts(replace(arrived, outcome="stuck"), monkeypatch, over=True)


def test_the_arrows_of_the_rules_are_weighed_by_what_each_has_learned(tmp_path: Path) -> None:
    policy = load_policy(shipped("fuzzy-q-lambda"))
    path = tmp_path / "p.json"
    policy.save(path)
    planner = FuzzyQLambdaSettings(policy=str(path))
    task = realise(random_task(3, count=25)).model_copy(update={"planner": planner})
    record = episode.run(with_options(task, drive="kinematic"))
    assert rule_weights(record) == pytest.approx(weights_of(policy))
    # Another policy than the one that drove says nothing of this run.
    rows = [list(row[::-1]) for row in policy.table]
    policy.model_copy(update={"table": tuple(map(tuple, rows))}).save(path)
    assert (rule_weights(record) == 1.0).all()
    path.unlink()
    assert (rule_weights(record) == 1.0).all()
    fixed = with_options(task, drive="kinematic", planner="improved-fuzzy")
    assert (rule_weights(episode.run(fixed)) == 0.5).all()
