"""A soak notices what is lost: it could fail."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from fuzzyq_bullet.studies import study_names
from fuzzyq_bullet.studies.storage import rows_in
from fuzzyq_bullet.studies.sweep import sweep
from fuzzyq_bullet.workers import Pool
from tests.helpers.commands import Call
from tests.soak.disturbed import PLUGIN, Ledger, planned
from tests.soak.soak_study import Soak, work
from tests.soak.verified import (
    faults_of_digests,
    faults_of_leftovers,
    faults_of_records,
    faults_of_rows,
    memory,
)

STUDY = Soak(episodes=3, seed=0)
JOBS = STUDY.plan().jobs(STUDY.planner_set())


@pytest.fixture(scope="module")
def whole(here: Pool, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three episodes that nobody disturbed."""
    folder = tmp_path_factory.mktemp("soak")
    (folder / "tmp").mkdir()
    sweep("soak", JOBS, folder, {}, pool=here, work=work)
    return folder


@pytest.fixture
def broken(whole: Path, tmp_path: Path) -> Path:
    """A copy of them, to be broken."""
    shutil.copytree(whole, tmp_path / "copy")
    return tmp_path / "copy"


def faults(folder: Path) -> list[str]:
    rows = {row.key: row for row in rows_in(folder / "journal.jsonl")}
    return [
        *faults_of_rows(folder, STUDY),
        *faults_of_records(folder, [job for job in JOBS if job.key in rows], rows),
        *faults_of_leftovers([folder], folder / "tmp", "nobody's mark"),
    ]


@pytest.mark.slow
def test_nothing_is_wrong_where_nothing_was_lost(whole: Path) -> None:
    assert faults(whole) == []
    rows = {row.key: row for row in rows_in(whole / "journal.jsonl")}
    assert list(faults_of_digests(JOBS, rows, 0)) == []


@pytest.mark.slow
def test_a_row_that_is_lost_or_there_twice_is_told(broken: Path) -> None:
    journal = broken / "journal.jsonl"
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines[:2]))
    assert any("1 episodes have no row" in fault for fault in faults(broken))
    journal.write_bytes(b"".join([*lines, lines[0]]))
    assert any("4 lines for 3 episodes" in fault for fault in faults(broken))


@pytest.mark.slow
def test_a_record_that_is_torn_missing_or_another_runs_is_told(broken: Path) -> None:
    one, two, three = sorted((broken / "records").iterdir())
    one.write_bytes(one.read_bytes()[:1000])
    shutil.copyfile(two, three)
    two.unlink()
    told = "\n".join(faults(broken))
    assert len(told.splitlines()) == 3
    assert all(path.name in told for path in (one, two, three))
    assert "is of another run" in told


@pytest.mark.slow
def test_a_row_of_another_run_and_what_is_left_behind_are_told(broken: Path) -> None:
    journal = broken / "journal.jsonl"
    rows = {row.key: row for row in rows_in(journal)}
    key = JOBS[1].key
    rows[key] = rows[key].model_copy(update={"digest": "0" * 32})
    (told,) = faults_of_digests(JOBS, rows, 0)
    assert JOBS[1].name in told
    (broken / ".soak.csv.01234567.part").mkdir()
    (broken / "tmp" / "fuzzyq-0123").mkdir()
    assert [fault.rpartition("/")[2] for fault in faults(broken)] == [
        ".soak.csv.01234567.part: left behind",
        "fuzzyq-0123: left behind",
    ]


def test_memory_that_grows_is_told_apart_from_ups_and_downs_and_one_step(tmp_path: Path) -> None:
    flat, grown = Ledger(tmp_path / "flat"), Ledger(tmp_path / "grown")
    for ledger, growth in ((flat, 0.0), (grown, 0.05)):
        ledger.note("life", 0)
        for rows in range(0, 1000, 10):
            held = 100.0 + growth * rows + (rows // 10) % 2 + (20.0 if rows > 780 else 0.0)
            told = {"life": 1, "rows": rows, "command": held, "workers": {"7": held}}
            ledger.note("sample", told)
        ledger.note("life", 1000)  # started again when all was done: nothing is measured there
    for name in ("command", "workers"):
        assert abs(memory(flat, 1000)[name]["growth"] or 0.0) < 5.0
        assert 45.0 < (memory(grown, 1000)[name]["growth"] or 0.0) < 55.0


def test_what_happens_is_the_same_for_the_same_seed_and_ends_before_the_quiet_part() -> None:
    told = planned(2000, 3, disk=True)
    assert told == planned(2000, 3, disk=True) != planned(2000, 4, disk=True)
    kinds = [one.kind for one in told]
    assert [kinds.count(kind) for kind in ("worker", "command", "disk")] == [80, 4, 1]
    assert all(0 < one.rows < 1500 for one in told)


def test_the_study_is_registered_for_no_other_test_that_runs_in_this_process() -> None:
    assert STUDY.name not in study_names()


@pytest.mark.slow
def test_its_plugin_makes_it_a_command_whose_workers_find_it(fuzzyq: Call, tmp_path: Path) -> None:
    command = ("bench", "soak", "--plugin", PLUGIN, "--episodes", 2, "--jobs", 1)
    done = fuzzyq(*command, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    rows = rows_in(tmp_path / "out" / "journal.jsonl")
    assert [row.error for row in rows] == [None, None]
