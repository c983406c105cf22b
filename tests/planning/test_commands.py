"""Twists and speeds of wheels as answers of a planner."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from fuzzyq_bullet import CommandSettings, Trajectory, TwistCommand, WheelCommand, load_scenario
from fuzzyq_bullet.episode import run_with
from fuzzyq_bullet.errors import PlannerError
from fuzzyq_bullet.physics.engine import TIME_STEP
from fuzzyq_bullet.planning.commands import PHYSICS_RATE
from fuzzyq_bullet.scenario import Scenario, random_task, realise


class Settings(CommandSettings):
    name: Literal["own"] = "own"


class Answers:
    """Gives the same answer always; may weave."""

    def __init__(self, answer: Any, weave: float = 0.0) -> None:
        self.answer, self.weave, self.count, self.closed = answer, weave, 0, 0

    def decide(self, _: object, /) -> Any:
        self.count += 1
        if self.weave:
            return self.answer._replace(turn_rate=self.weave * math.sin(self.count / 37.0))
        return self.answer

    def close(self) -> None:
        self.closed += 1


def task(guard: bool = False, rate: float = 20.0, time: float = 3.0, **more: Any) -> Scenario:
    scenario = realise(load_scenario("open-field"))
    limits = scenario.limits.model_copy(update={"time": time})
    settings = Settings(guard=guard, rate=rate)
    return scenario.model_copy(update={"planner": settings, "limits": limits, **more})


def test_wheels_and_the_twist_they_make_come_to_the_same() -> None:
    twist = run_with(Answers(TwistCommand(0.3, 0.5)), task())
    half = 0.5 * 0.28 / 2.0
    wheels = run_with(Answers(WheelCommand((0.3 - half) / 0.05, (0.3 + half) / 0.05)), task())
    np.testing.assert_allclose(twist.ticks.position, wheels.ticks.position, atol=1e-6)
    assert twist.ticks.speed[-1] == pytest.approx(0.3, abs=0.01)
    assert twist.ticks.turn_rate[-1] == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("rate", [10.0, 40.0])
def test_a_planner_decides_at_its_own_rate_and_is_closed_once(rate: float) -> None:
    planner = Answers(TwistCommand(0.1, 0.0))
    record = run_with(planner, task(rate=rate))
    assert record.decisions.tick.size == planner.count == 3 * rate
    assert planner.closed == 1


def test_what_it_asked_for_is_on_record_and_in_the_file(tmp_path: Path) -> None:
    record = run_with(Answers(TwistCommand(7.0, -0.2)), task())
    record.save(tmp_path / "own.npz")
    again = Trajectory.load(tmp_path / "own.npz")
    assert again.digest() == record.digest()
    assert set(again.decisions.twist_speed.tolist()) == {7.0}
    assert "twist_turn_rate" in again.csv("decisions").splitlines()[0]


@pytest.mark.parametrize(
    ("answer", "wrong"),
    [
        (TwistCommand(math.nan, 0.0), "must be finite numbers"),
        (WheelCommand(0.0, math.inf), "must be finite numbers"),
        (TwistCommand("1", 0.0), "must be finite numbers"),  # type: ignore[arg-type]
        (TwistCommand(0.1, 0.0, told=3), "not a Decision"),  # type: ignore[arg-type]
        ((0.1, 0.2), "returned a tuple instead of a Decision"),
    ],
)
def test_nonsense_is_one_line_and_the_planner_is_closed(answer: Any, wrong: str) -> None:
    planner = Answers(answer)
    with pytest.raises(PlannerError, match=wrong):
        run_with(planner, task())
    assert planner.closed == 1


def test_the_rate_is_told_of_the_physics() -> None:
    assert pytest.approx(1.0) == TIME_STEP * PHYSICS_RATE


@pytest.mark.slow
def test_full_speed_ahead_touches_nothing_with_the_safety_filter() -> None:
    moved = 0.0
    for seed in range(10):
        field = realise(random_task(seed, count=40))
        limits = field.limits.model_copy(update={"time": 12.0})
        update = {"planner": Settings(guard=True), "limits": limits}
        planner = Answers(TwistCommand(9.0, 0.0), weave=0.8)
        record = run_with(planner, field.model_copy(update=update))
        assert record.collision is None, seed
        assert record.ticks.clearance.min() > 0.0
        moved += float(np.abs(np.diff(record.ticks.position, axis=0)).sum())
    assert moved > 10.0
    unguarded = field.model_copy(update={"planner": Settings(guard=False)})
    assert run_with(Answers(TwistCommand(9.0, 0.0), weave=0.8), unguarded).outcome == "collision"
