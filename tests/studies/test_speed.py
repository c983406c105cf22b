"""Ratios of times: what else goes on in a machine must not decide them."""

import json

import pytest

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.studies.speed import (
    Row,
    as_json,
    as_table,
    interleaved,
    median_ratio,
)
from fuzzyq_bullet.studies.speed.polygons import polygons


def test_the_median_is_that_of_the_pairs_of_a_round():
    assert median_ratio([1.0, 9.0, 3.0], [2.0, 1.0, 4.0]) == 0.75


@pytest.mark.slow
def test_works_take_turns_and_each_time_is_its_own():
    done, now = [], iter(range(100))
    works = [lambda: done.append("a"), lambda: done.append("b")]
    times = interleaved(works, 3, clock=lambda: next(now) ** 2)
    assert "".join(done) == "ababab"
    assert times == [[1, 9, 17], [5, 13, 21]]


def test_a_rate_that_the_physics_cannot_keep_is_refused(inside):
    with pytest.raises(UserError, match="--rate: must divide 240 and be from 1 to 80, got 7"):
        inside("bench", "speed", "--rate", 7)


def test_the_table_says_what_was_measured_what_is_aimed_at_and_whether_it_is_met():
    rows = [
        Row("quick enough", 45.0, 40.0, "at least", "so"),
        Row("too slow", 1.2, 1.15, "at most", "so"),
        Row("unknown", None, 80.0, "at least", "not installed"),
    ]
    assert [row.met for row in rows] == [True, False, True]
    assert [one["met"] for one in json.loads(as_json(rows))] == [True, False, True]
    verdicts = [list(column.cells) for column in as_table(rows).columns]
    assert verdicts[1] == ["45.00", "1.20", "not measured"]
    assert verdicts[3] == ["met", "MISSED", ""]


@pytest.mark.slow
def test_a_large_map_is_read_asked_for_a_way_and_driven_in():
    driven, loaded, asked = polygons(1, 20)
    assert all(row.figure > 0.0 for row in (driven, loaded, asked))
    assert "3024 polygons" in driven.what
    assert asked.detail == "there is one"
