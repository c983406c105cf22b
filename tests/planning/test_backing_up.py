"""A decision may back the robot up: the wheels obey, the safety filter looks that way."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from fuzzyq_bullet import Decision, Trajectory, load_scenario
from fuzzyq_bullet.episode import run_with
from fuzzyq_bullet.planning import Observation
from fuzzyq_bullet.planning.safety_filter import safety_filter
from fuzzyq_bullet.scenario import Scenario, random_task, realise

HOLD = 15
"""Decisions that a course is held for."""


class Wanders:
    """Goes wherever chance says, forward or backward, as far as the safety filter lets it."""

    def __init__(self, seed: int, backward: float) -> None:
        self.rng, self.share, self.left = np.random.default_rng(seed), backward, 0
        self.heading, self.backward = 0.0, False

    def decide(self, observation: Observation, /) -> Decision:
        if self.left == 0:
            self.heading = self.rng.uniform(-math.pi, math.pi)
            self.backward = bool(self.rng.random() < self.share)
            self.left = HOLD
        self.left -= 1
        decision = Decision(self.heading, 0.4, backward=self.backward)
        return safety_filter(decision, observation)


class Backs:
    """Backs up along a heading."""

    def __init__(self, heading: float) -> None:
        self.decision = Decision(heading, 0.2, backward=True)

    def decide(self, _: Observation, /) -> Decision:
        return self.decision


class Filtered(Backs):
    """Backs up as far as the safety filter lets it."""

    def decide(self, observation: Observation, /) -> Decision:
        return safety_filter(self.decision, observation)


def limited(scenario: Scenario, time: float) -> Scenario:
    return scenario.model_copy(update={"limits": scenario.limits.model_copy(update={"time": time})})


def open_field(time: float = 2.0, **more: object) -> Scenario:
    return limited(realise(load_scenario("open-field")), time).model_copy(update=more)


def backed_up(record: Trajectory) -> float:
    """Return how far (m) the robot backed up."""
    return float(-np.minimum(record.ticks.speed, 0.0).sum()) * 0.05


@pytest.mark.slow
@pytest.mark.parametrize("backward", [0.5, 1.0])
@pytest.mark.parametrize("seed", range(3))
def test_backing_up_never_touches_what_stands(seed: int, backward: float) -> None:
    scenario = limited(realise(random_task(4000 + seed, count=60)), 40.0)
    record = run_with(Wanders(seed, backward), scenario)
    assert record.outcome != "collision"
    assert backed_up(record) > 2.0


@pytest.mark.parametrize("latency", [0.0, 0.2])
def test_it_backs_up_to_the_wall_and_stops_before_it(latency: float) -> None:
    scenario = open_field(8.0)
    robot = scenario.robot.model_copy(update={"latency": latency})
    scenario = scenario.model_copy(update={"robot": robot})
    record = run_with(Filtered(scenario.start_heading() + math.pi), scenario)
    assert record.outcome != "collision"
    assert backed_up(record) > 0.5
    assert 0.0 < record.ticks.clearance[-1] < 0.15
    assert abs(record.ticks.speed[-1]) < 0.01


def test_the_wheels_turn_the_back_to_the_heading() -> None:
    scenario = open_field()
    heading = scenario.start_heading() + math.pi - 0.5
    record = run_with(Backs(heading), scenario)
    ticks = record.ticks
    assert ticks.speed[-1] == pytest.approx(-0.3, abs=0.02)
    assert math.remainder(ticks.heading[-1] + math.pi - heading, math.tau) == pytest.approx(
        0.0, abs=0.05
    )


def test_a_robot_that_still_drives_on_stops_first() -> None:
    class Turns(Backs):
        def decide(self, observation: Observation, /) -> Decision:
            if observation.time < 0.95:
                return Decision(observation.heading, 0.4)
            return safety_filter(self.decision, observation)

    scenario = open_field(3.0)
    ticks = run_with(Turns(scenario.start_heading() + math.pi / 2.0), scenario).ticks
    rolls = (ticks.time > 1.0) & (ticks.speed > 0.1)
    assert rolls.sum() > 5
    assert np.abs(ticks.turn_rate[rolls]).max() < 0.05
    assert ticks.speed[-1] < -0.1


def test_it_is_on_record_and_in_the_file_only_where_it_happens(tmp_path: Path) -> None:
    scenario = open_field(1.0)
    record = run_with(Backs(math.pi), scenario)
    record.save(tmp_path / "back.npz")
    again = Trajectory.load(tmp_path / "back.npz")
    assert again.digest() == record.digest()
    assert set(again.decisions.backward.tolist()) == {1.0}
    assert "backward" in again.csv("decisions").splitlines()[0].split(",")
    forward = run_with(Wanders(0, 0.0), scenario)
    assert forward.decisions.backward is None
    assert "backward" not in forward.csv("decisions").splitlines()[0]
