"""Ctrl-C and ``kill`` at any moment: the right exit code, one line, nothing half-written."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.helpers.commands import FUZZYQ

if TYPE_CHECKING:
    from collections.abc import Callable

OLD = b"an older, good video"


@pytest.fixture
def long(tmp_path: Path) -> Path:
    """A scenario that keeps driving for longer than anybody waits."""
    path = tmp_path / "long.yaml"
    path.write_text(
        "name: long\narena: {size: [900.0, 3.0]}\nstart: {position: [1.0, 1.5]}\n"
        "goal: {position: [899.0, 1.5]}\nlimits: {time: 3600.0, steps: 1000000}\n"
    )
    return path


def start(*args: object) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [FUZZYQ, *map(str, args)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def wait_for(what: Callable[[], bool], process: subprocess.Popen[str]) -> None:
    deadline = time.monotonic() + 60
    while not what():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.005)


def ends(process: subprocess.Popen[str], signum: signal.Signals) -> None:
    """Send a signal, twice as an impatient person does, and check how the process takes it."""
    process.send_signal(signum)
    process.send_signal(signum)
    stdout, stderr = process.communicate(timeout=30)
    assert (process.returncode, stdout, stderr) == (128 + signum, "", "error: interrupted\n")


def maps(process: subprocess.Popen[str], library: str) -> bool:
    """Tell whether a library is loaded into a process."""
    try:
        return library in Path(f"/proc/{process.pid}/maps").read_text()
    except OSError:
        return False


@pytest.mark.slow
@pytest.mark.parametrize(
    ("library", "signum"),
    [
        ("_pydantic_core", signal.SIGINT),
        ("_multiarray_umath", signal.SIGTERM),
        ("pybullet", signal.SIGINT),
    ],
)
def test_while_libraries_are_loaded(
    library: str, signum: signal.Signals, short: Path, tmp_path: Path
) -> None:
    process = start("run", short, "--out", tmp_path / "out", "--no-video")
    wait_for(lambda: maps(process, library), process)
    ends(process, signum)
    assert not [*tmp_path.rglob("*.part")]


@pytest.mark.slow
def test_while_a_module_is_loaded_that_makes_another_error_of_it(
    short: Path, tmp_path: Path
) -> None:
    (tmp_path / "slow.py").write_text(
        "import pathlib, time\n"
        f"pathlib.Path({str(tmp_path / 'begun')!r}).touch()\n"
        "try:\n    time.sleep(0.3)\nexcept BaseException:\n    raise ImportError('as numpy does')\n"
    )
    process = start("check", short, "--plugin", tmp_path / "slow.py")
    wait_for((tmp_path / "begun").exists, process)
    ends(process, signal.SIGINT)


@pytest.mark.slow
@pytest.mark.parametrize("signum", [signal.SIGINT, signal.SIGTERM])
def test_while_driving(signum: signal.Signals, long: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = start("run", long, "--out", out, "--json")
    wait_for(lambda: maps(process, "pybullet"), process)
    time.sleep(0.5)
    ends(process, signum)
    assert not list(out.iterdir())


@pytest.mark.slow
def test_while_filming(filmed: Path, tmp_path: Path) -> None:
    record, video = tmp_path / "short.npz", tmp_path / "short-0.1x.mp4"
    record.write_bytes((filmed / "short.npz").read_bytes())
    video.write_bytes(OLD)
    process = start("replay", record, "--speed", "0.1")

    def half_written() -> bool:
        return any(path.stat().st_size > 0 for path in tmp_path.glob(".*.part/*"))

    wait_for(half_written, process)
    ends(process, signal.SIGTERM)
    assert video.read_bytes() == OLD
    assert sorted(path.name for path in tmp_path.iterdir()) == ["short-0.1x.mp4", "short.npz"]
    assert not encoders_of(tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("delay", [0.0, 0.01, 0.04])
def test_while_the_encoder_starts(delay: float, filmed: Path, tmp_path: Path) -> None:
    record = tmp_path / "short.npz"
    record.write_bytes((filmed / "short.npz").read_bytes())
    process = start("replay", record, "--speed", "0.1")
    wait_for(lambda: has_child(process), process)
    time.sleep(delay)
    ends(process, signal.SIGINT)
    time.sleep(0.3)  # for an encoder that was left behind to write its file
    assert [path.name for path in tmp_path.iterdir()] == ["short.npz"]
    assert not encoders_of(tmp_path)


@pytest.mark.slow
def test_a_job_in_the_background_of_a_script_ignores_ctrl_c_as_jobs_do(
    filmed: Path, tmp_path: Path
) -> None:
    def ignoring() -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)

    command = [FUZZYQ, "replay", filmed / "short.npz", "--out", tmp_path, "--speed", "4"]
    process = subprocess.Popen(command, preexec_fn=ignoring, stdout=subprocess.DEVNULL)
    while process.poll() is None:
        os.kill(process.pid, signal.SIGINT)
        time.sleep(0.02)
    assert process.returncode == 0
    assert (tmp_path / "short-4x.mp4").exists()


def has_child(process: subprocess.Popen[str]) -> bool:
    try:
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text()
    except OSError:
        return False
    return bool(children.strip())


def encoders_of(folder: Path) -> list[str]:
    """Return the commands of all processes that were told to write into a folder."""
    commands = []
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # it has ended meanwhile
            commands.append((entry / "cmdline").read_bytes().replace(b"\0", b" ").decode())
    return [command for command in commands if str(folder) in command]


def test_while_a_destructor_runs_that_lets_nothing_through() -> None:
    code = """
import os, signal, time
from fuzzyq_bullet.cli.process import guard

class Deaf:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)

def command():
    deaf = Deaf()
    del deaf
    time.sleep(5)
    return 0

guard(command)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "error: interrupted\n")
