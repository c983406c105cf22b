"""A sweep over a Dask cluster ends in the same table as at home; skipped without the extra."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from fuzzyq_bullet import UserError
from fuzzyq_bullet.workers.cluster import cluster
from tests.helpers.commands import SHORT, Call

pytest.importorskip("distributed", reason="needs the extra cluster")

SWEEP = (
    *("bench", "success", "--planners", "fuzzy,improved-fuzzy", "--counts", "5,10"),
    *("--runs", "2", "--seed", "5"),
)


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a real scheduler with two worker processes."""
    folder = tmp_path_factory.mktemp("dask")
    known = folder / "scheduler.json"
    dask = [sys.executable, "-m", "dask"]
    where = ("--scheduler-file", str(known), "--no-dashboard")
    started: list[subprocess.Popen[bytes]] = []
    with (folder / "log").open("wb") as log:
        try:
            for command in (
                ("scheduler", "--host", "127.0.0.1", "--port", "0", *where),
                ("worker", *where, "--nworkers", "2", "--nthreads", "1", "--host", "127.0.0.1"),
            ):
                started.append(
                    subprocess.Popen([*dask, *command], cwd=folder, stdout=log, stderr=log)
                )
                deadline = time.monotonic() + 60
                while not known.exists() or not known.read_text().strip():
                    assert started[0].poll() is None, (folder / "log").read_text()
                    assert time.monotonic() < deadline
                    time.sleep(0.05)
            yield json.loads(known.read_text())["address"]
        finally:
            for process in reversed(started):
                process.terminate()
                try:
                    process.wait(20)
                except subprocess.TimeoutExpired:
                    process.kill()


def test_two_workers_of_a_cluster_write_the_same_table_as_one_process_here(
    scheduler: str, fuzzyq: Call, tmp_path: Path
) -> None:
    afar = fuzzyq(*SWEEP, "--out", tmp_path / "afar", "--backend", "dask", "--scheduler", scheduler)
    assert afar.returncode == 0, afar.stderr
    assert "8 episodes" in afar.stderr
    here = fuzzyq(*SWEEP, "--out", tmp_path / "here", "--jobs", "1")
    assert here.returncode == 0, here.stderr
    for name in ("success.csv", "success.json"):
        assert (tmp_path / "afar" / name).read_bytes() == (tmp_path / "here" / name).read_bytes()


def test_worlds_of_this_machine_go_to_the_workers_of_a_cluster(
    scheduler: str, fuzzyq: Call, tmp_path: Path
) -> None:
    worlds = tmp_path / "worlds"
    worlds.mkdir()
    (worlds / "a.yaml").write_text(SHORT)
    (worlds / "b.yaml").write_text(SHORT.replace("short", "other").replace("1.4, 0.7", "1.3, 0.9"))
    sweep = ("bench", "field", "--planners", "improved-fuzzy", "--worlds", worlds)
    afar = fuzzyq(*sweep, "--out", tmp_path / "afar", "--backend", "dask", "--scheduler", scheduler)
    assert afar.returncode == 0, afar.stderr
    here = fuzzyq(*sweep, "--out", tmp_path / "here", "--jobs", "1")
    assert here.returncode == 0, here.stderr
    table = (tmp_path / "here" / "worlds.csv").read_bytes()
    assert table.count(b",goal,") == 4
    assert (tmp_path / "afar" / "worlds.csv").read_bytes() == table


def test_a_scheduler_that_is_not_there_is_one_line(fuzzyq: Call, tmp_path: Path) -> None:
    with socket.socket() as taken:  # bound, and not listening: nobody answers
        taken.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{taken.getsockname()[1]}"
        done = fuzzyq(
            *SWEEP, "--out", tmp_path / "out", "--backend", "dask", "--scheduler", address
        )
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert address in line
    assert "no Dask scheduler" in line
    assert not (tmp_path / "out").exists()


def test_an_address_of_no_kind_that_there_is_is_told_at_once() -> None:
    with (
        pytest.raises(UserError, match="nonsense://x: no Dask scheduler"),
        cluster("nonsense://x", None),
    ):
        pass
