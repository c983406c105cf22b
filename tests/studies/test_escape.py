"""``fuzzyq bench escape``: tables are arithmetic over rows made by hand; bounds know more."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import ImprovedFuzzySettings, settings_for
from fuzzyq_bullet.scenario import realise
from fuzzyq_bullet.studies.episodes import Job, Row
from fuzzyq_bullet.studies.escape.comparison import BESIDE, SUM, compare
from fuzzyq_bullet.studies.escape.study import Escape, EscapePlan
from fuzzyq_bullet.studies.escape.table import TRAPS, Line, score_of, table_of
from tests.helpers.commands import Call


def row(run: int = 0, **changes: Any) -> Row:
    """A success: 11 m driven in 18 s where 10 m are the shortest, at 0.6 m/s."""
    plain = {
        "planner": "p",
        "drive": "wheels",
        "layout": "scatter",
        "count": 25,
        "run": run,
        "seed": run,
        "feasible": True,
        "outcome": "goal",
        "steps": 1,
        "time_s": 18.0,
        "path_length_m": 11.0,
        "shortest_path_m": 10.0,
        "spl": 10 / 11,
        "min_clearance_m": 0.1,
        "collisions": 0,
        "digest": "d",
    }
    return Row(**{**plain, **changes})


def stuck(run: int, **changes: Any) -> Row:
    return row(run, **{"outcome": "stuck", "spl": 0.0, **changes})


def only(*rows: Row) -> Line:
    (line,) = table_of(rows)
    return line


def missed(line: Line, drive: str = "wheels") -> list[str]:
    return [target.what for target in line.missed_by(drive)]


def test_shares_are_of_the_feasible_and_of_all() -> None:
    line = only(row(0), row(1), stuck(2), stuck(3, feasible=False, shortest_path_m=None, spl=None))
    figures = line.drives["wheels"]
    assert (line.environments, line.feasible) == (4, 3)
    assert figures.found == pytest.approx(2 / 3)
    assert figures.found_of_all == pytest.approx(2 / 4)
    assert missed(line) == ["found"]


def test_the_path_is_a_mean_and_the_time_a_median_over_the_successes_alone() -> None:
    line = only(
        row(0, path_length_m=10.0, time_s=20.0),
        row(1, path_length_m=12.0, time_s=40.0),
        row(2, path_length_m=17.0, time_s=500.0),
        stuck(3, path_length_m=900.0, time_s=600.0),
    )
    figures = line.drives["wheels"]
    assert figures.path_ratio == pytest.approx((1.0 + 1.2 + 1.7) / 3)
    assert figures.time_ratio == pytest.approx(40.0 / (10.0 / 0.6))
    assert figures.mean_time_ratio == pytest.approx((20.0 + 40.0 + 500.0) / 3 / (10.0 / 0.6))
    assert missed(line) == ["found", "path ratio", "time ratio"]


@pytest.mark.parametrize(
    ("count", "driven", "targets"),
    [
        (25, 11.0, []),
        (25, 11.1, ["path ratio"]),
        (50, 12.5, []),
        (50, 12.6, ["path ratio"]),
        (75, 90.0, []),
        (125, 16.0, []),
        (125, 16.1, ["path ratio"]),
    ],
)
def test_how_long_a_path_may_be_depends_on_the_count(
    count: int, driven: float, targets: list[str]
) -> None:
    assert missed(only(row(count=count, path_length_m=driven))) == targets


@pytest.mark.parametrize(("count", "most"), [(25, 1.09), (50, 1.16), (75, 1.38), (125, 2.2)])
def test_how_long_it_may_take_on_wheels_depends_on_the_count_too(count: int, most: float) -> None:
    def at(ratio: float, drive: str = "wheels") -> list[str]:
        return missed(only(row(count=count, time_s=ratio * 10.0 / 0.6, drive=drive)), drive)

    assert at(most - 0.001) == at(most + 1.0, "kinematic") == []
    assert at(most + 0.001) == ["time ratio"]


def cellular(time: float, **changes: Any) -> Row:
    """A corridor with a shortest path of 9 m to the goal disc, so 10 m to its centre: OT = 6 s."""
    return row(layout="cellular", count=None, shortest_path_m=9.0, time_s=time, **changes)


@pytest.mark.parametrize(
    ("time", "score"), [(5.0, 0.5), (12.0, 0.5), (24.0, 0.25), (48.0, 0.125), (500.0, 0.125)]
)
def test_the_score_is_the_optimal_time_over_the_time_within_bounds(
    time: float, score: float
) -> None:
    assert score_of(cellular(time)) == pytest.approx(score)
    assert score_of(cellular(time, outcome="stuck")) == 0.0
    assert score_of(row()) is None


def test_a_cellular_field_is_driven_at_its_own_speed_and_has_a_score_to_reach() -> None:
    line = only(cellular(12.0), cellular(24.0, run=1))
    figures = line.drives["wheels"]
    assert (line.family, figures.score) == ("cellular", pytest.approx(0.375))
    assert figures.mean_time_ratio == pytest.approx(18.0 / 9.0)  # 1 m/s
    assert missed(line) == ["score"]


def test_a_collision_counts_where_there_is_no_way_too() -> None:
    line = only(row(0), stuck(1, outcome="collision", feasible=False, collisions=1))
    assert line.drives["wheels"].collisions == 1
    assert missed(line) == ["collisions"]


def test_an_error_excuses_nothing() -> None:
    blank = dict.fromkeys(("steps", "time_s", "path_length_m", "shortest_path_m", "spl", "digest"))
    gone = row(1, outcome="error", feasible=None, collisions=None, error="E: lost", **blank)
    line = only(row(0), gone)
    assert line.drives["wheels"].found == 0.5
    assert missed(line) == ["found", "errors"]


def test_where_nothing_can_be_found_no_share_is_made_up() -> None:
    line = only(stuck(0, feasible=False, shortest_path_m=None, min_clearance_m=None))
    figures = line.drives["wheels"]
    assert figures.found is figures.path_ratio is figures.time_ratio is figures.clearance is None
    assert missed(line) == []


def test_the_least_clearance_is_that_of_any_run() -> None:
    assert only(row(0), stuck(1, min_clearance_m=0.02)).drives["wheels"].clearance == 0.02


def test_drives_stand_beside_each_other_over_the_same_environments() -> None:
    line = only(row(0), row(1), row(0, drive="kinematic"), stuck(1, drive="kinematic"))
    assert list(line.drives) == ["wheels", "kinematic"]
    assert (line.environments, line.feasible) == (2, 2)
    assert missed(line, "wheels") == []
    assert missed(line, "kinematic") == ["found"]


def test_traps_are_one_family_and_lines_come_in_order() -> None:
    traps = [row(k, layout=layout, count=None) for k, layout in enumerate(TRAPS)]
    others = [row(layout="rectangles", count=30), row(count=125), row(count=5)]
    lines = table_of([*others, cellular(12.0), *traps])
    assert [(line.family, line.count, line.environments) for line in lines] == [
        ("scatter", 5, 1),
        ("scatter", 125, 1),
        ("traps", None, 4),
        ("rectangles", 30, 1),
        ("cellular", None, 1),
    ]


def test_a_plan_takes_traps_in_turn_and_every_environment_with_every_drive() -> None:
    fuzzy = settings_for("fuzzy").model_validate({"name": "fuzzy"})
    told = fuzzy.model_dump(mode="json")
    plan = EscapePlan(sweep="escape", planner=told, runs=2, counts=(5,), traps=6, rectangles=(30,))
    jobs = plan.jobs({"fuzzy": fuzzy})
    assert len(jobs) == plan.total
    assert len(jobs) == len({job.key for job in jobs}) == 2 * (2 + 6 + 2)
    traps = [where.layout for where in plan.environments() if where.count is None]
    assert traps == [*TRAPS, *TRAPS[:2]]


def test_contenders_are_compared_where_both_arrived() -> None:
    ours = [row(k, mean_jerk=1.0, turning_rad=11.0, rules_turn=0.5) for k in range(3)]
    slow = [row(k, planner="no-memory", time_s=36.0) for k in range(2)]
    lost = stuck(2, planner="no-memory", time_s=600.0)
    first, second = compare([*ours, *slow, lost], ("p", "no-memory"))
    assert (first.planner, first.of_planners) == ("p", None)
    assert (first.jerk, first.turning, first.rules_turn) == (1.0, pytest.approx(1.0), 0.5)
    assert second.of_planners is not None
    assert (second.of_planners.value, second.of_planners.pairs) == (pytest.approx(2.0), 2)
    assert second.found == pytest.approx(2 / 3)


def test_scattered_fields_of_all_counts_are_compared_together_too() -> None:
    families = {one.family for one in compare([row(count=25), row(count=50)], ("p",))}
    assert families == {"scatter 25", "scatter 50", SUM}


def test_what_runs_beside_a_planner_has_the_first_drive_alone() -> None:
    fuzzy = settings_for("improved-fuzzy")()
    told = fuzzy.model_dump(mode="json")
    plan = EscapePlan(
        sweep="escape",
        planner=told,
        runs=1,
        counts=(5,),
        traps=0,
        rectangles=(),
        beside=("true-path",),
    )
    drives = [
        (job.planner, job.drive) for job in plan.jobs({"improved-fuzzy": fuzzy, "true-path": fuzzy})
    ]
    assert drives == [
        ("improved-fuzzy", "wheels"),
        ("improved-fuzzy", "kinematic"),
        ("true-path", "wheels"),
    ]


def test_cellular_corridors_of_all_densities_take_turns() -> None:
    told = settings_for("fuzzy")().model_dump(mode="json")
    plan = EscapePlan(sweep="escape", planner=told, counts=(), traps=0, rectangles=(), cellular=12)
    tasks = [job.scenario() for job in plan.jobs({"fuzzy": settings_for("fuzzy")()})]
    drawn = {(task.random.fill, task.random.smoothing) for task in tasks if task.random}
    assert len(drawn) == 12
    task = realise(tasks[0])
    assert (task.robot.max_speed, task.goal.radius, task.arena.walls) == (1.0, 1.0, False)
    assert all(obstacle.radius == 0.075 for obstacle in task.obstacles)


@pytest.mark.slow
def test_what_knows_the_truth_is_told_beside_a_planner(tmp_path: Path, inside: Call) -> None:
    few = ("--counts", "100", "--runs", "1", "--seed", "9", "--traps", "0", "--rectangles", "none")
    command = ("bench", "escape", *few, "--drive", "kinematic", "--beside", "--json")
    done = inside(*command, "--planner", "improved-fuzzy", "--out", tmp_path)
    told = json.loads(done.stdout)
    paths = {one["planner"]: one["path_ratio"] for one in told["compared"]}
    assert set(paths) == {"improved-fuzzy", *BESIDE}
    # What knows more drives less: here at least, where the planner goes wrong once.
    assert 1.0 <= paths["true-path"] < paths["true-exits"] < paths["improved-fuzzy"]
    assert len(told["rows"]) == 1  # the planner's own, as without --beside
    with pytest.raises(UserError, match="fuzzy has no controller and no memory to leave out"):
        inside(*command, "--planner", "fuzzy", "--out", tmp_path / "other")


def test_another_robot_drives_the_same_study_and_its_plan_tells_it_again():
    study = Escape(cellular=1, counts="none", traps=0, rectangles="none", runs=1)
    other = study.model_copy(update={"robot": "jackal", "max_speed": 2.0, "range": 3.0})
    job, *_ = other.plan().jobs({"improved-fuzzy": ImprovedFuzzySettings()})
    task = Job.of_order(job.as_order()).scenario()
    assert (task.robot.model, task.robot.max_speed, task.sensor_range) == ("jackal", 2.0, 3.0)
    assert Escape.recalled({"escape": other.plan()}).plan() == other.plan()
    usual, *_ = study.plan().jobs({"improved-fuzzy": ImprovedFuzzySettings()})
    assert (usual.scenario().robot.max_speed, usual.scenario().sensor_range) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("wrong", "option"),
    [({"robot": "x"}, "--robot"), ({"max_speed": 9.0}, "--max-speed"), ({"range": 0.3}, "--range")],
)
def test_a_robot_that_cannot_be_is_named_by_its_option(wrong, option):
    with pytest.raises(UserError, match=option):
        Escape(**wrong).plan()
