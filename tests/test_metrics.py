"""Figures of a run that are arithmetic over its record."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from fuzzyq_bullet import Result, Trajectory, load_scenario, result_of, run, with_options
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


def test_results_are_rows_of_a_table() -> None:
    runs = [
        run(with_options(load_scenario(name), drive="kinematic")) for name in ("boxes", "sparse")
    ]
    results = [result_of(one) for one in runs]
    table = pd.DataFrame([one.to_dict() for one in results])
    names = [name for name in Result.model_fields if name != "modes"]
    modes = ["modes_routine", "modes_breakout", "modes_following"]
    assert sorted(table.columns) == sorted([*names, *modes])
    assert table["scenario"].tolist() == ["boxes", "sparse"]
    assert table["time_s"].tolist() == [one.time_s for one in results]
    assert table[modes].sum(axis=1).tolist() == [one.decisions for one in results]
    assert table["mean_jerk"].isna().all()  # null in the kinematic drive
    cells = [cell for one in results for cell in one.to_dict().values()]
    assert all(cell is None or isinstance(cell, str | int | float) for cell in cells)
