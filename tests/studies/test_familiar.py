"""``fuzzyq bench familiar``: who crosses the same field again, and what the table says of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning import settings_for
from fuzzyq_bullet.planning.escape.exploration import WaysOut
from fuzzyq_bullet.scenario import realise
from fuzzyq_bullet.studies.episodes import Environment, Job, Row
from fuzzyq_bullet.studies.familiar.drivers import keep_map_and_drive, learn_and_drive, work
from fuzzyq_bullet.studies.familiar.kept_map import KeptMap
from fuzzyq_bullet.studies.familiar.study import Familiar
from fuzzyq_bullet.studies.familiar.table import ALL, FIRST, Line, lines_of, targets_of
from fuzzyq_bullet.studies.plan import PATIENT
from tests.helpers.commands import Call
from tests.helpers.exploring import observe
from tests.studies.test_escape import row

WHO = (FIRST, "learned-50", "true-exits")


def seen(who: str, run: int, time: float, **changes: Any) -> Row:
    return row(run, planner=who, time_s=time, **changes)


def line(rows: list[Row], who: str, family: str = "scatter 25") -> Line:
    (one,) = [one for one in lines_of(rows, WHO) if (one.family, one.who) == (family, who)]
    return one


def test_times_are_compared_field_by_field_where_both_reached_the_goal() -> None:
    rows = [
        *(seen(FIRST, run, time) for run, time in enumerate((20.0, 60.0, 30.0))),
        *(seen("learned-50", run, time) for run, time in enumerate((22.0, 18.0, 25.0))),
        *(seen("true-exits", run, time) for run, time in enumerate((20.0, 20.0))),
        seen("true-exits", 2, 600.0, outcome="timeout"),
        *(seen(who, 3, 5.0, feasible=False) for who in WHO),  # no way, by a hair's breadth
    ]
    learned = line(rows, "learned-50")
    assert (learned.feasible, learned.found) == (3, 3)
    assert learned.of_first is not None
    assert learned.of_first.value == pytest.approx(65.0 / 110.0)
    assert learned.of_exits is not None
    assert learned.of_exits.value == pytest.approx(40.0 / 40.0)
    assert learned.worst == pytest.approx(1.1)
    assert [one.what.split()[0] for one in targets_of(learned) if not one.met] == ["worst"]
    assert line(rows, FIRST).of_first is None


def test_a_contact_in_any_run_misses_a_target_and_all_families_come_together() -> None:
    rows = [
        *(seen(who, 0, 20.0) for who in WHO),
        *(seen(who, 0, 40.0, layout="u-shape", count=None) for who in (FIRST, "true-exits")),
        seen("learned-50", 0, 9.0, layout="u-shape", count=None, outcome="collision", collisions=1),
    ]
    assert line(rows, "learned-50").collisions == 0
    both = line(rows, "learned-50", ALL)
    assert (both.feasible, both.found, both.collisions) == (2, 1, 1)
    missed = [str(one) for one in targets_of(both) if not one.met]
    assert "environments with a contact 1, wanted exactly 0" in missed
    assert "environments that only the first run crossed 1, wanted exactly 0" in missed


def job(who: str, run: int = 4, drive: Any = "kinematic") -> Job:
    settings = settings_for("fuzzy-q-lambda").model_validate({"name": "fuzzy-q-lambda"})
    return Job(Environment.of("scatter", 75, 9000 + run, 0), who, settings, drive, PATIENT)


def test_crossing_a_field_again_is_never_slower_and_here_much_faster() -> None:
    first, learned, kept = (
        Row.model_validate(work(job(who).as_order())["row"])
        for who in (FIRST, "learned-4", "kept-map-4")
    )
    assert first.success
    assert first.time_s is not None
    for again in (learned, kept):
        assert again.success
        assert again.collisions == 0
        assert again.time_s is not None
        assert again.time_s < 0.8 * first.time_s


def test_a_kept_map_tries_an_unknown_way_once_and_only_where_it_looks_much_shorter() -> None:
    kept = KeptMap()
    seen = observe(Field(), (0.0, 0.0), goal=(9.0, 0.0))
    points = [(1.0, 1.0), (1.0, -1.0), (9.0, 0.0)]

    def best(*lengths: float) -> int:
        costs = list(kept.graph.judge(WaysOut(seen, points, (1.4, 1.4, 12.0), lambda: lengths)))
        return costs.index(min(costs))

    assert best(10.0, 10.0, 0.0) == 2  # 11.4 m at least, if at all, against 12 m for certain
    assert best(8.0, 8.5, 0.0) == 0
    kept.begin_again()
    assert best(8.0, 8.5, 0.0) == 1
    kept.begin_again()
    assert best(8.0, 8.5, 0.0) == 2


def test_a_single_crossing_is_the_first_run() -> None:
    scenario = realise(job(FIRST).scenario())
    assert learn_and_drive(scenario, 1).digest() == keep_map_and_drive(scenario, 1).digest()


@pytest.mark.parametrize("crossings", ["none", "0", "3,0", "x", "101", "9999999999999"])
def test_a_field_must_be_crossed_to_be_learned(crossings: str) -> None:
    with pytest.raises(UserError, match="--crossings: "):
        Familiar(crossings=crossings).plan()


@pytest.mark.slow
def test_the_command_compares_all_of_them(inside: Call, tmp_path: Path) -> None:
    asked = ("--runs", 1, "--counts", "75", "--traps", 1, "--crossings", "2,3", "--seed", 7)
    done = inside(
        "bench", "familiar", *asked, "--drive", "kinematic", "--jobs", 1, "--json", cwd=tmp_path
    )
    told = json.loads(done.stdout)
    assert done.returncode == (0 if all(one["met"] for one in told["targets"]) else 1)
    who = [one["who"] for one in told["rows"] if one["family"] == ALL]
    assert who == [FIRST, "learned-2", "learned-3", "kept-map-10", "true-exits", "true-path"]
    assert all(one["collisions"] == 0 for one in told["rows"])
    assert (tmp_path / "out/familiar/familiar.csv").read_text().count("\n") == 13
