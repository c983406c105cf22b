"""The pool of workers: what one order leaves behind is not blamed on the next."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from fuzzyq_bullet.errors import MachineError, UserError
from fuzzyq_bullet.files import temporary_folder
from fuzzyq_bullet.workers import WorkerPool

kept: list[bytes] = []


def keep(megabytes: int) -> int:
    """Hold memory for good, and return the number of the process."""
    kept.append(b"x" * (megabytes * 2**20))
    return os.getpid()


@pytest.mark.slow
@pytest.mark.parametrize(("megabytes", "processes"), [(1, 1), (450, 2)])
def test_a_worker_that_holds_much_memory_makes_way_for_a_fresh_one(
    megabytes: int, processes: int
) -> None:
    with WorkerPool(1, memory_mb=1000) as pool:
        answers = [answer for _, answer in pool.run(keep, [megabytes, 1])]
    assert len({answer.value for answer in answers}) == processes
    assert not any(answer.died or answer.failed for answer in answers)


def die_in_a_temporary_folder(_: object) -> None:
    """Be killed where a body is loaded from a file, as by the kernel when memory is short."""
    with temporary_folder():
        os.kill(os.getpid(), signal.SIGKILL)


def stay_in_a_temporary_folder(_: object) -> None:
    with temporary_folder():
        time.sleep(600.0)


@pytest.mark.slow
def test_a_killed_worker_leaves_no_temporary_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    with WorkerPool(1) as pool:
        ((_, answer),) = pool.run(die_in_a_temporary_folder, [None])
        assert "killed" in answer.died
        assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").exists(), reason="Linux alone tells what is there")
def test_nor_does_one_whose_command_is_killed(tmp_path: Path) -> None:
    code = (
        "from fuzzyq_bullet.workers import WorkerPool\n"
        "from tests.workers.test_workers import stay_in_a_temporary_folder as stay\n"
        "with WorkerPool(1) as pool:\n    list(pool.run(stay, [None]))\n"
    )
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    command = subprocess.Popen(
        [sys.executable, "-c", code], env=environment, cwd=Path(__file__).parents[2]
    )
    _wait_for(lambda: bool(list(tmp_path.iterdir())))
    command.kill()
    command.wait()
    _wait_for(lambda: not list(tmp_path.iterdir()))


def find_the_disk_full(_: object) -> None:
    raise MachineError("/tmp/body.urdf: cannot be written: No space left on device")


@pytest.mark.slow
def test_a_machine_that_fails_ends_the_work_and_is_no_answer() -> None:
    with WorkerPool(1) as pool, pytest.raises(UserError, match="No space left"):
        list(pool.run(find_the_disk_full, [None, None]))


def _wait_for(what: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 60.0
    while not what():
        assert time.monotonic() < deadline
        time.sleep(0.02)
