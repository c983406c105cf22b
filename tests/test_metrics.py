"""Figures of a run that are arithmetic over its record."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fuzzyq_bullet import Trajectory, result_of
from fuzzyq_bullet.scenario import with_options
from tests.helpers.synthetic import drive


def with_speeds(speeds: np.ndarray) -> Trajectory:
    record = drive(seconds=2.0, outcome="timeout")
    return replace(record, ticks=replace(record.ticks, speed=speeds[: len(record.ticks.time)]))


def test_the_jerk_is_the_change_of_the_acceleration_whichever_its_sign() -> None:
    time = drive(seconds=2.0, outcome="timeout").ticks.time
    steady = 0.5 * 0.3 * time**2  # 0.3 m/s³
    assert result_of(with_speeds(steady)).mean_jerk == pytest.approx(0.3)
    assert result_of(with_speeds(1.0 - steady)).mean_jerk == pytest.approx(0.3)
    assert result_of(with_speeds(0.2 * time)).mean_jerk == pytest.approx(0.0, abs=1e-6)


def test_the_last_tick_which_may_be_a_short_one_counts_for_no_jerk() -> None:
    time = drive(seconds=2.0, outcome="timeout").ticks.time
    speeds = 0.2 * time
    speeds[-1] = 50.0
    assert result_of(with_speeds(speeds)).mean_jerk == pytest.approx(0.0, abs=1e-6)


def test_a_point_robot_has_no_jerk() -> None:
    record = drive(seconds=2.0, outcome="timeout")
    scenario = with_options(record.scenario, drive="kinematic")
    assert result_of(replace(record, scenario=scenario)).mean_jerk is None
