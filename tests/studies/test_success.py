"""Fig. 13 and Table 5 are plain arithmetic over rows; made by hand, the answer is known."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Callable
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from fuzzyq_bullet import UserError
from fuzzyq_bullet.cli.app import call
from fuzzyq_bullet.cli.study import printed
from fuzzyq_bullet.studies import FieldsPlan, Swept
from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.options import GUARDED, PAPER, described
from fuzzyq_bullet.studies.plan import LIMITS, M_S
from fuzzyq_bullet.studies.selection import Weights
from fuzzyq_bullet.studies.statistics import share
from fuzzyq_bullet.studies.steps.study import Steps, contenders, roles
from fuzzyq_bullet.studies.steps.table import PAPER_STEPS
from fuzzyq_bullet.studies.steps.table import summary_of as steps_of
from fuzzyq_bullet.studies.success.picture import LOOKS, success_picture
from fuzzyq_bullet.studies.success.study import COUNTS, RUNS, Success
from fuzzyq_bullet.studies.success.table import summary_of
from tests.helpers.commands import Call, no_workers

PAIR = Weights(1.5, 0.5, 1.0)


def row(planner: str, count: int, run: int, **more: object) -> Row:
    given = {
        "planner": planner,
        "drive": "kinematic",
        "count": count,
        "run": run,
        "seed": run,
        "layout": "scatter",
        "feasible": True,
        "outcome": "goal",
        "steps": 50,
        "time_s": 20.0,
        "collisions": 0,
    }
    return Row.model_validate(given | more)


def rows_by(
    wins: Callable[[str, int, int], bool], counts: tuple[int, ...] = (5, 50), runs: int = 10
) -> list[Row]:
    return [
        row(name, count, run, outcome="goal" if wins(name, count, run) else "collision")
        for name in PAPER
        for count in counts
        for run in range(runs)
    ]


# Wilson's interval


@pytest.mark.parametrize(
    ("number", "of", "low", "high"),
    [  # Newcombe 1998, Statistics in Medicine 17, Table I, method 3
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_the_interval_is_that_of_the_literature(
    number: int, of: int, low: float, high: float
) -> None:
    found = share(number, of)
    assert found is not None
    assert (round(found.low, 4), round(found.high, 4)) == (low, high)
    mirrored = share(of - number, of)
    assert mirrored is not None
    assert mirrored.low == pytest.approx(1.0 - found.high, abs=1e-12)


def test_where_all_succeed_the_interval_still_has_a_width_and_nothing_has_no_share() -> None:
    whole = share(50, 50)
    assert whole is not None
    assert (whole.value, whole.high) == (1.0, 1.0)
    assert 0.9 < whole.low < 0.95
    assert share(0, 0) is None
    with pytest.raises(ValueError, match="no share"):
        share(3, 2)


# Fig. 13


def test_by_default_it_is_the_papers_experiment_and_the_direct_planners_once_more() -> None:
    assert (COUNTS[0], COUNTS[-1], len(COUNTS), RUNS) == (5, 125, 25, 50)
    study = Success()
    jobs = study.plan().jobs(study.planner_set())
    assert len(jobs) == 7 * 1250
    assert {job.limits for job in jobs} == {LIMITS}
    assert PAPER_STEPS["fuzzy"] < M_S
    for number in range(0, len(jobs), 7):  # the same environments for every planner
        assert len({job.environment for job in jobs[number : number + 7]}) == 1


def test_success_is_counted_over_all_and_over_those_that_have_a_way() -> None:
    rows = [
        row("fuzzy", 5, 0),
        row("fuzzy", 5, 1, outcome="timeout", steps=M_S),
        row("fuzzy", 5, 2, feasible=False, outcome="stuck"),
        row("fuzzy", 5, 3, feasible=None, outcome="error"),
    ]
    summary = summary_of(rows)
    (line,) = summary.lines
    cell = line.cells["fuzzy"]
    assert (line.environments, line.feasible) == (4, 3)  # an error excuses nothing
    assert (cell.all.number, cell.all.of) == (1, 4)
    assert cell.feasible is not None
    assert (cell.feasible.number, cell.feasible.of) == (1, 3)
    assert cell.outcomes == {"error": 1, "goal": 1, "stuck": 1, "timeout": 1}
    assert summary.total.cells["fuzzy"] == cell


def test_a_planner_without_a_row_for_each_environment_is_a_mistake_of_the_caller() -> None:
    with pytest.raises(ValueError, match="every environment"):
        summary_of(rows_by(lambda *_: True)[:-1])


def test_orders_of_the_paper_that_are_not_seen_are_named() -> None:
    strength = dict(zip(PAPER, (1, 7, 5, 5, 7), strict=True))
    rows = rows_by(lambda name, _, run: run < strength[name])
    summary = summary_of(rows)
    assert [one.reproduced for one in summary.claims] == [True, False]  # a draw is no highest
    study = Success(counts="5,50", runs=10)
    console = Console(width=study.width, file=StringIO())
    results = {"success": Swept(study.plan(), tuple(rows))}
    console.print(printed(study.findings(results)))
    shown = console.file.getvalue()
    assert max(map(len, shown.splitlines())) <= study.width
    assert "NOT seen" in shown
    assert "0.10 [0.02, 0.40]" in shown
    assert "M_s is 3000" in " ".join(shown.split())


def test_the_picture_tells_planners_apart_without_colour_and_shows_every_share() -> None:
    summary = summary_of(rows_by(lambda name, count, run: run * len(name) > count))
    figure = success_picture(summary, "made by hand")
    above, below = figure.axes
    assert len({look.mark for look in LOOKS.values()}) == len(LOOKS)
    assert len({look.colour for look in LOOKS.values()}) == len(LOOKS)
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert set(PAPER) < set(words)
    for axes in (above, below):
        assert len(axes.containers) == len(PAPER)
    drawn = {
        tuple(np.round(np.asarray(box[0].get_ydata(), dtype=float), 9)) for box in above.containers
    }
    assert drawn == {
        tuple(round(line.cells[name].all.value, 9) for line in summary.lines) for name in PAPER
    }


# Table 5


def test_a_failure_has_no_steps_or_m_s_of_them_and_the_table_tells_which() -> None:
    extra = roles(PAIR)
    rows = [
        row(name, 50, run, steps=40 + 10 * run)
        for name in (*PAPER, *extra)
        for run in range(3)
        if (name, run) != ("fuzzy", 2)
    ]
    rows.append(row("fuzzy", 50, 2, outcome="collision", collisions=1, steps=4))
    summary = steps_of(rows, extra, M_S, np.random.default_rng(0))
    fuzzy = summary.lines[0]
    assert (fuzzy.paper, fuzzy.reached, fuzzy.runs, fuzzy.collisions) == (2342, 2, 3, 1)
    assert fuzzy.steps is not None
    assert fuzzy.steps.value == 45.0
    assert fuzzy.punished == pytest.approx((40 + 50 + M_S) / 3)
    assert summary.common == 3  # of the planners with ways out: fuzzy does not shrink it
    assert [line.role for line in summary.lines[5:]] == [
        *("q-learning with ways out", "q-lambda with ways out"),
        *("q-learning, by place", "q-lambda, by place"),
        *("fixed 1/1", "best pair 1.5/0.5"),
    ]
    assert all(line.paper is None for line in summary.lines[5:])
    console = Console(width=Steps.width, file=StringIO())
    told = described(contenders(PAIR))
    plan = FieldsPlan(sweep="steps steps", planners=told, counts=(50,), runs=3)
    console.print(printed(Steps().findings({"steps": Swept(plan, tuple(rows))})))
    shown = console.file.getvalue()
    assert max(map(len, shown.splitlines())) <= Steps.width
    assert "counting as 3000" in " ".join(shown.split())


def test_orders_of_steps_are_compared_where_both_arrived() -> None:
    ours = {name: 10 * place for place, name in enumerate(sorted(PAPER_STEPS))}
    rows = [row(name, 50, run, steps=ours[name]) for name in PAPER for run in range(2)]
    rows[0] = rows[0].model_copy(update={"outcome": "timeout"})
    summary = steps_of(rows, {}, M_S, np.random.default_rng(0))
    assert len(summary.orders) == 10
    for one in summary.orders:
        assert one.environments == (1 if "fuzzy" in (one.fewer, one.more) else 2)
        assert one.reproduced == (ours[one.fewer] < ours[one.more])


def test_if_one_and_one_is_the_best_pair_it_is_one_row() -> None:
    best = Weights(1.0, 1.0, 1.0)
    assert len(contenders(best)) == 10
    assert list(roles(best).values())[4:] == ["fixed 1/1, the best pair"]
    assert len(contenders(PAIR)) == 11


# As people call it

SUCCESS = (
    *("bench", "success", "--planners", "fuzzy,fuzzy-q-lambda", "--counts", "5,10"),
    *("--runs", "1", "--jobs", "1", "--seed", "2"),
)


@pytest.mark.slow
def test_the_command_writes_rows_summary_and_picture(fuzzyq: Call, tmp_path: Path) -> None:
    done = fuzzyq(*SUCCESS, "--out", tmp_path, "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told == json.loads((tmp_path / "success.json").read_text())
    assert told["settings"]["limits"]["steps"] == M_S
    assert len(told["settings"]["planners"]["fuzzy-q-lambda"]["policy"]) == 32
    with (tmp_path / "success.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [(one["planner"], one["count"]) for one in rows] == [
        *(("fuzzy", count) for count in ("5", "10")),
        *(("fuzzy-q-lambda", count) for count in ("5", "10")),
    ]
    assert (tmp_path / "success.png").stat().st_size > 10_000


def test_the_steps_of_all_are_in_the_table_beside_the_papers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ("--pair", "2,0.5", "--runs", "1", "--count", "5", "--json", "--out", str(tmp_path))
    monkeypatch.setattr(sys, "argv", ["fuzzyq", "bench", "steps", *given])
    with no_workers():
        assert call() == 0
    told = json.loads(capsys.readouterr().out)
    assert told == json.loads((tmp_path / "steps.json").read_text())
    assert [(line["role"], line["paper"]) for line in told["lines"]] == [
        *((name, PAPER_STEPS[name]) for name in PAPER),
        *(("q-learning with ways out", None), ("q-lambda with ways out", None)),
        *(("q-learning, by place", None), ("q-lambda, by place", None)),
        *(("fixed 1/1", None), ("best pair 2/0.5", None)),
    ]
    assert told["settings"]["search"] is None
    with (tmp_path / "table" / "steps.csv").open() as file:
        assert len(list(csv.DictReader(file))) == 11


MISTAKES = {
    ("success", "--planners", "fuzy"): ["--planners", "did you mean 'fuzzy'?"],
    ("success", "--planners", ""): ["--planners", "allowed"],
    ("success", "--counts", "5,-1"): ["--counts", "'-1'"],
    ("success", "--counts", "10001"): ["--counts", "0 to 10000"],
    ("success", "--counts", "none"): ["--counts", "nothing to run"],
    ("success", "--runs", "0"): ["--runs"],
    ("success", "--drive", "both"): ["--drive", "one at a time"],
    ("success", "--seed", "-1"): ["--seed", "-1"],
    ("success", "--backend", "dusk"): ["--backend", "dask"],
    ("success", "--backend", "dask"): ["--scheduler"],
    ("success", "--scheduler", "tcp://localhost:1"): ["--backend dask"],
    ("success", "--out", "/dev/null"): ["/dev/null"],
    ("steps", "--pair", "1"): ["--pair"],
    ("steps", "--pair", "1,90"): ["--pair", "less than or equal to 20"],
    ("steps", "--count", "10001"): ["--count"],
}


@pytest.mark.parametrize("options", MISTAKES, ids=lambda one: " ".join(one)[:40])
def test_a_mistake_is_one_line_and_nothing_is_run(
    options: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["fuzzyq", "bench", *options])
    with pytest.raises(UserError) as caught:
        call()
    (line,) = caught.value.problems
    assert "\n" not in line
    assert all(word in line for word in MISTAKES[options])
    assert not list(tmp_path.iterdir())


def test_more_planners_than_fit_stand_in_a_second_table(inside: Call, tmp_path: Path) -> None:
    planners = ",".join((*PAPER, *GUARDED))
    given = ("--counts", "3", "--runs", 1, "--planners", planners, "--out", tmp_path)
    with no_workers():
        shown = inside("bench", "success", *given).stdout
    head = [line for line in shown.splitlines() if "obstacles" in line and "runs" in line]
    assert len(head) == 4  # over all, and over those that have a way, each in two
    assert all(sum(name in line.split() for line in head) == 2 for name in (*PAPER, *GUARDED))
