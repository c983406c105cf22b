"""``fuzzyq bench robust``: what disturbs a planner is what its label says, in the same fields."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fuzzyq_bullet import UserError
from fuzzyq_bullet.studies.episodes import Job, from_csv
from fuzzyq_bullet.studies.robust.study import NAMES, Robust, strengths
from tests.helpers.commands import Call

SMALL = ("--runs", "1", "--count", "4", "--jobs", "1")


@pytest.mark.parametrize("name", NAMES)
def test_each_disturbance_reaches_the_scenario_and_grows(name: str) -> None:
    asked = Robust(disturbances=name, runs=1)
    jobs = asked.plan().jobs(asked.planner_set())
    assert [job.planner.split(".")[1:] for job in jobs] == [
        ["none"],
        *([name, str(level)] for level in (1, 2, 3, 4)),
    ]
    before: dict[str, float] = {}
    for level, job in enumerate(jobs):
        scenario = Job.of_order(job.as_order()).scenario()
        told = {**scenario.sensor.model_dump(), **scenario.robot.model_dump()}
        set_to = {key: told[key] for key in strengths(name, 4)}
        assert {key: value for key, value in set_to.items() if value} == strengths(name, level)
        assert all(set_to[key] > value for key, value in before.items())
        before = set_to


def test_the_table_compares_with_the_undisturbed_planner(inside: Call, tmp_path: Path) -> None:
    out = tmp_path / "robust"
    said = inside(
        "bench", "robust", *SMALL, "--levels", "2", "--disturbances", "noise", "--out", out
    )
    assert said.returncode == 0
    rows = from_csv((out / "robust.csv").read_text())
    assert [row.planner for row in rows] == ["fuzzy-q-lambda.noise.2", "fuzzy-q-lambda.none"]
    told = json.loads((out / "robust.json").read_text())
    plain, noisy = told["lines"]
    assert (plain["disturbance"], noisy["strength"]) == ("none", "0.01 m")
    assert plain["time_ratio"] == 1.0
    times = {row.planner: row.time_s for row in rows}
    ratio = times["fuzzy-q-lambda.noise.2"] / times["fuzzy-q-lambda.none"]
    assert noisy["time_ratio"] == pytest.approx(ratio)
    assert (out / "robust.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("option", "value"), [("--disturbances", "fog"), ("--levels", "5"), ("--planners", "nobody")]
)
def test_what_does_not_exist_is_one_line(inside: Call, option: str, value: str) -> None:
    with pytest.raises(UserError, match=f"^{option}: ") as error:
        inside("bench", "robust", *SMALL, option, value)
    assert len(error.value.problems) == 1
