"""``fuzzyq bench robust``: what disturbs a planner is what its label says, in the same fields."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from fuzzyq_bullet import UserError
from fuzzyq_bullet.scenario import realise
from fuzzyq_bullet.studies.episodes import Environment, Job, Row, from_csv
from fuzzyq_bullet.studies.robust.study import NAMES, Robust, strengths
from fuzzyq_bullet.studies.robust.table import MOVING, Line, lines_of, targets_of
from tests.helpers.commands import Call

SMALL = ("--runs", "1", "--count", "4", "--jobs", "1")


@pytest.mark.parametrize("name", [name for name in NAMES if name != MOVING])
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


def test_what_moves_wanders_among_the_same_standing_obstacles() -> None:
    asked = Robust(disturbances=MOVING, runs=1, count=25)
    jobs = asked.plan().jobs(asked.planner_set())
    fields = [realise(Job.of_order(job.as_order()).scenario()) for job in jobs]
    assert [len(field.movers) for field in fields] == [0, 5, 10, 20, 40]
    assert [field.standing for field in fields] == [fields[0].obstacles] * 5
    assert len(fields[0].obstacles) == 25
    most = fields[-1]
    wanderers = [most.obstacles[i] for i in most.movers]
    assert {one.radius for one in wanderers} == {0.25}
    assert {one.motion.kind for one in wanderers} == {"wander"}
    speeds = [one.motion.speed for one in wanderers]
    assert 0.1 <= min(speeds) < 0.2 < 0.4 < max(speeds) <= 0.5
    assert not strengths("all", 2).keys() & {MOVING}


def row(planner: str, run: int, **more: object) -> Row:
    given = {"outcome": "goal", "steps": 1, "time_s": 20.0, "collisions": 0, "feasible": True}
    where = Environment.of("scatter", 25, run, 0)
    told = {"planner": planner, "drive": "wheels", **vars(where)}
    return Row.model_validate({**told, **given, **more})


def line_of(*rows: Row, name: str = MOVING, level: int = 1) -> Line:
    plain = [row("p.none", one.run, time_s=10.0 + one.run) for one in rows]
    labels = [("p.none", "p", "none", 0), (f"p.{name}.{level}", "p", name, level)]
    return lines_of([*plain, *rows], labels, strengths)[1]


def test_a_line_counts_faults_and_compares_times_field_by_field() -> None:
    hit = {"outcome": "collision", "collisions": 1}
    line = line_of(
        row("p.moving.1", 0, time_s=20.0),
        row("p.moving.1", 1, time_s=5.5),
        row("p.moving.1", 2, **hit, at_fault=True),
        row("p.moving.1", 3, **hit, at_fault=False),
        row("p.moving.1", 4, **hit),  # of a version that did not tell
    )
    assert (line.contacts, line.at_fault, line.reached) == (3, 2, 2)
    assert line.time_ratio == pytest.approx(1.0)  # twice the time, and half of it
    assert line.strength == "5 wander"


@pytest.mark.parametrize(
    ("level", "reached", "aim"), [(1, 98, 0.98), (2, 95, 0.95), (3, 90, 0.90), (4, 10, None)]
)
def test_targets_of_what_moves_are_for_the_least_success(
    level: int, reached: int, aim: float | None
) -> None:
    told = {"strength": "n wander", "feasible": 100, "contacts": 100 - reached, "errors": 0}
    line = Line(
        "p",
        MOVING,
        level,
        at_fault=0,
        reached=reached,
        least_clearance_m=0.0,
        time_ratio=1.5,
        **told,
    )
    targets = list(targets_of(line, 25))
    assert [one.bound for one in targets] == ([] if aim is None else [0, aim, 1.5])
    assert all(one.met for one in targets)
    worse = replace(line, at_fault=1, reached=reached - 1, time_ratio=1.51)
    assert not any(one.met for one in targets_of(worse, 25))
    assert list(targets_of(worse, 50)) == []


def test_targets_of_noise_allow_no_contact_at_all() -> None:
    fine = line_of(row("p.all.2", 0), name="all", level=2)
    assert [one.met for one in targets_of(fine, 50)] == [True, True]
    hit = line_of(
        row("p.all.2", 0, outcome="collision", collisions=1, at_fault=False), name="all", level=2
    )
    assert [one.met for one in targets_of(hit, 50)] == [False, False]
    assert list(targets_of(replace(hit, level=3), 50)) == []


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
    assert " at fault " in said.stdout
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
