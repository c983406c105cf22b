"""A sweep ends in the same table whatever happens to it on the way."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeAlias

import pytest

from fuzzyq_bullet import Trajectory, UserError, run
from fuzzyq_bullet.cli.app import call
from fuzzyq_bullet.errors import MachineError
from fuzzyq_bullet.ground_truth import feasible
from fuzzyq_bullet.planning import ImprovedFuzzySettings, settings_for
from fuzzyq_bullet.scenario import Limits, realise
from fuzzyq_bullet.studies.episodes import Environment, Job, Row, as_csv
from fuzzyq_bullet.studies.storage import Folder, Journal
from fuzzyq_bullet.studies.sweep import State, local_pool, run_job, sweep
from fuzzyq_bullet.workers import Pool, WorkerPool
from tests.helpers.commands import FUZZYQ, Call, no_workers

FAST = ImprovedFuzzySettings(weights=(1.0, 1.0))
CONTRACT = (
    "planner,drive,count,run,seed,feasible,outcome,steps,time_s,path_length_m,shortest_path_m,spl,"
    "min_clearance_m,collisions,digest"
)


def jobs_for(count: int, runs: int, *, seconds: float = 60.0) -> list[Job]:
    return [
        Job(
            Environment.of("scatter", count, number, 7),
            "improved-fuzzy",
            FAST,
            "kinematic",
            Limits(time=seconds),
        )
        for number in range(runs)
    ]


Order: TypeAlias = dict[str, Any]
KILLED = "its worker process died twice: its process ended by itself, with exit code 1"


def row_of(job: Job) -> Row:
    """Stand in for an episode: it takes no time, and depends on the job alone."""
    return Row(
        planner=job.planner,
        drive=job.drive,
        count=job.environment.count,
        run=job.environment.run,
        seed=job.environment.seed,
        layout=job.environment.layout,
        feasible=True,
        outcome="goal",
        time_s=job.environment.run / 3,
    )


def quick(order: Order) -> Order:
    return {"row": row_of(Job.of_order(order)).model_dump(mode="json"), "record": None}


def deadly(order: Order) -> Order:
    """End the worker without a word on run 2, as a crash in a library does."""
    if order["environment"]["run"] == 2:
        os._exit(1)
    return quick(order)


def hanging(order: Order) -> Order:
    """Never come back from run 2."""
    while order["environment"]["run"] == 2:
        time.sleep(0.01)
    return quick(order)


def telling_where(order: Order) -> Order:
    row = Row.model_validate(quick(order)["row"]).model_copy(update={"steps": os.getpid()})
    return {"row": row.model_dump(mode="json"), "record": None}


# What a row is


def test_the_table_has_the_columns_that_scripts_rely_on() -> None:
    assert as_csv([]).startswith(CONTRACT + ",")


def test_a_table_is_sorted_by_number_not_by_text_and_does_not_depend_on_the_order_of_rows() -> None:
    rows = [row_of(job) for job in (*jobs_for(5, 3), *jobs_for(25, 12))]
    text = as_csv(rows)
    assert text == as_csv(rows[::-1])
    assert [line.split(",")[2:4] for line in text.splitlines()[1:]] == [
        *(["5", str(k)] for k in range(3)),
        *(["25", str(k)] for k in range(12)),
    ]


def test_every_planner_and_drive_meets_the_same_environments() -> None:
    where = Environment.of("scatter", 25, 3, 1)
    one = Job(where, "a", FAST, "wheels", Limits())
    other = Job(where, "b", ImprovedFuzzySettings(guard=False), "kinematic", Limits(time=9.0))
    ours, theirs = realise(one.scenario()), realise(other.scenario())
    assert ours.obstacles == theirs.obstacles
    assert (ours.start, ours.goal, ours.seed) == (theirs.start, theirs.goal, 1_000_003)
    assert (ours.drive, theirs.drive) == ("wheels", "kinematic")
    assert one.key != other.key


def test_a_row_is_what_the_run_says_and_a_failure_comes_with_its_record(tmp_path: Path) -> None:
    job = jobs_for(50, 1)[0]
    done = run_job(job)
    trajectory = run(job.scenario())
    assert done.row.outcome == "goal"
    assert done.row.digest == trajectory.digest()
    assert done.row.feasible is feasible(trajectory.scenario, 0.22) is True
    assert done.row.shortest_path_m is not None
    assert done.record is None

    too_short = run_job(jobs_for(50, 1, seconds=1.0)[0])
    assert (too_short.row.outcome, too_short.row.spl) == ("timeout", 0.0)
    assert too_short.record is not None
    (tmp_path / "record.npz").write_bytes(too_short.record)
    assert Trajectory.load(tmp_path / "record.npz").digest() == too_short.row.digest


# Errors and deaths


def test_a_planner_that_lacks_what_it_needs_is_refused_where_it_is_still_to_drive(
    here: Pool, tmp_path: Path
) -> None:
    lacking = settings_for("process").model_validate({"name": "process"})
    jobs = [replace(job, settings=lacking) for job in jobs_for(5, 2)]
    # The workers of a cluster may have what this machine lacks.
    done = sweep("far", jobs[:1], tmp_path, {}, pool=here, work=quick)
    with pytest.raises(UserError, match=r"^planner process: "):
        sweep("far", jobs, tmp_path, {}, pool=here, work=quick, here=True)
    assert sweep("far", jobs[:1], tmp_path, {}, pool=here, work=quick, here=True).rows == done.rows


class Crashing:
    def decide(self, observation: object, /) -> object:
        raise RuntimeError(f"lost\nin {object()!r}")


def test_a_crashing_planner_is_a_row_with_its_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fuzzyq_bullet.episode.build_planner", lambda settings, rng: Crashing())
    row = run_job(jobs_for(5, 1)[0]).row
    assert row.outcome == "error"
    # One line, and the same each time: no address.
    what = "stopped by RuntimeError: lost in <object object at 0x…>, after 0.00 s"
    assert (row.error or "").startswith(f"planner improved-fuzzy: {what} ({__file__}:")
    assert row.feasible is True
    assert row.steps is row.digest is row.collisions is None


def test_an_environment_that_cannot_be_built_is_a_row_with_its_error() -> None:
    job = Job(Environment("scatter", 20_000, 0, 0), "p", FAST, "kinematic", Limits())
    row = run_job(job).row
    assert (row.outcome, row.feasible) == ("error", None)
    assert "10000" in (row.error or "")


@pytest.mark.slow
def test_a_worker_that_dies_costs_one_row_and_not_the_sweep(tmp_path: Path) -> None:
    with local_pool(2) as pool:
        done = sweep("t", jobs_for(5, 5), tmp_path, {}, pool=pool, work=deadly)
        assert [row.error for row in done.rows] == [None, None, KILLED, None, None]
        again = sweep("t", jobs_for(5, 5), tmp_path, {}, pool=pool, work=deadly)
    assert (again.state.ran, again.rows) == (0, done.rows)


@pytest.mark.slow
def test_a_worker_that_hangs_costs_one_row_and_is_not_tried_again(tmp_path: Path) -> None:
    with WorkerPool(1, timeout=1.0) as pool:
        done = sweep("t", jobs_for(5, 4), tmp_path, {}, pool=pool, work=hanging)
    late = "cut after 1 s of wall-clock time"
    assert [row.error for row in done.rows] == [None, None, late, None]


def test_a_single_worker_too_is_a_process_of_its_own(tmp_path: Path) -> None:
    with local_pool(1) as pool:
        (row,) = sweep("t", jobs_for(5, 1), tmp_path, {}, pool=pool, work=telling_where).rows
    assert row.steps not in (None, os.getpid())


def test_a_full_disk_is_no_row_which_would_never_be_done_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def full(path: Path, text: str) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    job = replace(jobs_for(5, 1, seconds=1.0)[0], drive="wheels")
    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(MachineError, match=r"body\.urdf: cannot be written: No space left"):
        run_job(job)
    monkeypatch.undo()
    assert run_job(job).row.outcome == "timeout"


# Going on


def test_rows_are_on_disk_as_they_come_and_a_torn_line_is_done_again(tmp_path: Path) -> None:
    rows = [row_of(job) for job in jobs_for(5, 3)]
    path = tmp_path / "journal.jsonl"
    with Journal(path) as journal:
        journal.append(rows[0])
        assert path.read_bytes().count(b"\n") == 1
        journal.append(rows[1])
    whole = path.read_bytes()
    second = whole.index(b"\n") + 1
    for length in (second, second + 1, second + 99, len(whole) - 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        with Journal(path) as journal:
            assert journal.rows == rows[:1]
            journal.append(rows[2])
        with Journal(path) as journal:
            assert journal.rows == [rows[0], rows[2]]


def test_a_line_of_nonsense_is_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    row = row_of(jobs_for(5, 1)[0])
    path.write_bytes(b"\0\0\n{}\n" + row.model_dump_json().encode() + b"\n")
    with Journal(path) as journal:
        assert journal.rows == [row]


def test_only_what_is_left_is_run_and_progress_counts_all(here: Pool, tmp_path: Path) -> None:
    sweep("t", jobs_for(5, 2), tmp_path, {}, pool=here, work=quick)
    seen: list[tuple[int, int, int]] = []

    def note(state: State) -> None:
        seen.append((state.done, state.ran, state.successes))

    done = sweep("t", jobs_for(5, 4), tmp_path, {}, pool=here, work=quick, progress=note)
    assert seen == [(2, 0, 2), (3, 1, 3), (4, 2, 4)]
    assert done.table.read_text() == as_csv(row_of(job) for job in jobs_for(5, 4))


def test_another_setting_is_refused_by_name(tmp_path: Path) -> None:
    settings = {"runs": 1, "seed": 0, "planners": {"a": {"guard": True}, "b": {"guard": True}}}
    Folder(tmp_path).claim(settings)
    asked = {"runs": 2, "seed": 0, "planners": {"a": {"guard": False}}}
    with pytest.raises(UserError) as caught:
        Folder(tmp_path).claim(asked)
    (line,) = caught.value.problems
    assert "runs 1, asked for 2" in line
    assert "planners.a.guard true, asked for false" in line
    assert "planners.b something, asked for nothing" in line
    assert "seed" not in line


def test_two_sweeps_at_a_time_in_one_folder_are_refused(tmp_path: Path) -> None:
    with (
        Journal(tmp_path / "journal.jsonl"),
        pytest.raises(UserError, match="another sweep is at work"),
        Journal(tmp_path / "journal.jsonl"),
    ):
        pass


def test_two_jobs_of_one_key_are_a_mistake_of_the_caller(here: Pool, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="same key"):
        sweep("t", jobs_for(5, 1) * 2, tmp_path, {}, pool=here)


# The whole of it, as people call it

ESCAPE = (
    *("bench", "escape", "--drive", "kinematic", "--runs", "3", "--counts", "5,25"),
    *("--traps", "2", "--rectangles", "none", "--seed", "3"),
)
ROWS = 8


@pytest.fixture(scope="module")
def undisturbed(inside: Call, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep that nobody disturbed, one job after the other here, and what it printed."""
    folder = tmp_path_factory.mktemp("sweep")
    with no_workers():
        done = inside(*ESCAPE, "--out", folder, "--json")
    assert done.returncode in (0, 1), done.stderr
    (folder / "stdout").write_text(done.stdout)
    return folder


@pytest.mark.slow
def test_killed_it_goes_on_and_ends_in_the_same_bytes(
    undisturbed: Path, fuzzyq: Call, tmp_path: Path
) -> None:
    journal = tmp_path / "journal.jsonl"
    process = subprocess.Popen(
        [FUZZYQ, *ESCAPE, "--jobs", "2", "--out", tmp_path], stderr=subprocess.PIPE
    )
    wait_for(lambda: rows_in(journal) > 1, process)
    workers = children_of(process.pid)
    process.kill()
    process.communicate()
    assert rows_in(journal) < ROWS
    assert not (tmp_path / "escape.csv").exists()
    deadline = time.monotonic() + 10
    while any(Path(f"/proc/{pid}").exists() for pid in workers):
        assert time.monotonic() < deadline, "workers outlive a killed sweep"
        time.sleep(0.05)
    done = fuzzyq(*ESCAPE, "--jobs", "2", "--out", tmp_path)
    assert done.returncode in (0, 1), done.stderr
    assert "were there already" in done.stderr
    ours, theirs = (folder / "escape.csv" for folder in (tmp_path, undisturbed))
    assert ours.read_bytes() == theirs.read_bytes()
    assert len(ours.read_text().splitlines()) == 1 + ROWS
    for folder in (tmp_path, tmp_path / "records"):
        assert not list(folder.glob(".*"))


@pytest.mark.slow
@pytest.mark.parametrize("moment", ["while workers start", "while they work"])
def test_ctrl_c_ends_a_sweep_in_good_order(moment: str, tmp_path: Path) -> None:
    process = subprocess.Popen(
        [FUZZYQ, *ESCAPE, "--jobs", "2", "--out", tmp_path],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    if moment == "while they work":
        wait_for(lambda: rows_in(tmp_path / "journal.jsonl") > 0, process)
    else:
        wait_for(lambda: len(children_of(process.pid)) > 1, process)
        time.sleep(0.1)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers too
    stdout, stderr = process.communicate(timeout=30)
    assert (process.returncode, stdout, stderr) == (130, "", "error: interrupted\n")
    assert not (tmp_path / "escape.csv").exists()


def test_json_is_alone_on_stdout_and_a_finished_sweep_is_only_read_again(
    undisturbed: Path, inside: Call
) -> None:
    first = json.loads((undisturbed / "stdout").read_text())
    done = inside(*ESCAPE, "--out", undisturbed, "--json")
    again = json.loads(done.stdout)
    assert "0 episodes" in done.stderr
    assert again["rows"] == first["rows"]
    assert [(line["family"], line["count"]) for line in again["rows"]] == [
        ("scatter", 5),
        ("scatter", 25),
        ("traps", None),
    ]
    assert all(line["drives"]["kinematic"]["collisions"] == 0 for line in again["rows"])


def test_the_table_fits_a_terminal_and_says_with_what_it_was_made(
    undisturbed: Path, inside: Call
) -> None:
    shown = inside(*ESCAPE, "--out", undisturbed).stdout
    assert max(map(len, shown.splitlines())) <= 80
    assert "improved-fuzzy with weights (1, 1); seed 3" in shown
    assert "scatter 25" in shown


def test_the_folder_of_another_sweep_is_refused_and_stays_as_it_is(
    undisturbed: Path, inside: Call
) -> None:
    before = {path: path.read_bytes() for path in undisturbed.iterdir() if path.is_file()}
    with pytest.raises(UserError) as caught:
        inside(*ESCAPE, "--out", undisturbed, "--weights", "0.5,1", "--runs", "7")
    (line,) = caught.value.problems
    assert all(word in line for word in (str(undisturbed), "runs 3, asked for 7", "weights"))
    assert {path: path.read_bytes() for path in before} == before


@pytest.mark.parametrize("name", ["escape.csv", "escape.json"])
def test_what_no_sweep_has_made_is_replaced_only_when_asked_to(
    name: str, undisturbed: Path, inside: Call, tmp_path: Path
) -> None:
    (tmp_path / name).write_text("mine\n")
    for _ in range(2):  # what is refused makes nothing its own
        with pytest.raises(UserError, match=rf"{name}: is there already, .* --replace"):
            inside(*ESCAPE, "--out", tmp_path)
        assert [path.name for path in tmp_path.iterdir()] == [name]
    with no_workers():
        assert inside(*ESCAPE, "--out", tmp_path, "--replace").returncode in (0, 1)
    assert (tmp_path / "escape.csv").read_bytes() == (undisturbed / "escape.csv").read_bytes()
    json.loads((tmp_path / "escape.json").read_text())
    assert "0 episodes" in inside(*ESCAPE, "--out", tmp_path).stderr


MISTAKES = {
    ("--counts", "5,-1"): ["--counts", "'-1'", "0 to 10000"],
    ("--counts", "10001"): ["--counts", "0 to 10000"],
    ("--counts", "9" * 5000): ["--counts", "0 to 10000"],
    ("--counts", "1e3"): ["--counts", "'1e3'"],
    ("--rectangles", ""): ["--rectangles", "none"],
    ("--counts", "none", "--rectangles", "none", "--traps", "0"): ["nothing to run"],
    ("--runs", "0"): ["--runs"],
    ("--jobs", "0"): ["--jobs"],
    ("--drive", "wheel"): ["--drive", "did you mean 'wheels'?", "both"],
    ("--planner", "fuzzi"): ["--planner", "did you mean 'fuzzy'?"],
    ("--weights", "1"): ["--weights"],
    ("--weights", "1,90"): ["--weights", "less than or equal to 20"],
    ("--weights", "one,two"): ["--weights", "1,1"],
    ("--seed", "-1"): ["--seed", "-1"],
    ("--out", "/proc/sweep"): ["/proc/sweep"],
    ("--out", "/dev/null"): ["/dev/null"],
}


@pytest.mark.parametrize("options", MISTAKES, ids=lambda one: " ".join(one)[:40])
def test_a_mistake_is_one_line_and_nothing_is_run(
    options: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["fuzzyq", "bench", "escape", *options])
    with pytest.raises(UserError) as caught:
        call()
    (line,) = caught.value.problems
    assert "\n" not in line
    assert all(word in line for word in MISTAKES[options])
    assert not list(tmp_path.iterdir())


def rows_in(journal: Path) -> int:
    return journal.read_bytes().count(b"\n") if journal.exists() else 0


def wait_for(what: Callable[[], bool], process: subprocess.Popen[Any]) -> None:
    deadline = time.monotonic() + 60
    while not what():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.002)


def children_of(pid: int) -> list[int]:
    text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    return [int(child) for child in text.split()]
