"""What a run comes to, to the last bit, is what it was: a rebuilt house changes nothing for users.

A change of behaviour that is meant is recorded anew, and CHANGELOG.md tells of it::

    python tests/test_unchanged.py

Only Linux on x86-64 is compared: elsewhere the last bit of a sine may differ. The scenarios of the
figures are run, and compared, by figures/test_figure_panels.py.
"""

from __future__ import annotations

import hashlib
import json
import platform
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from fuzzyq_bullet import Scenario, Trajectory, load_scenario, run, with_options
from fuzzyq_bullet.cli import app
from fuzzyq_bullet.scenario import bundled_scenarios, random_task
from fuzzyq_bullet.version import __version__

KNOWN = Path(__file__).with_name("unchanged.json")
VERSION = __version__.encode()
"""A policy names the version that learned it; a release teaches nothing else."""
SAME_SINES = (sys.platform, platform.machine()) == ("linux", "x86_64")
KINDS = [
    (planner, drive)
    for planner in ("improved-fuzzy", "fuzzy-q-lambda", "fuzzy")
    for drive in ("wheels", "kinematic")
]
TRAIN = ("train", "fuzzy-q-lambda", "--episodes", "5", "--seed", "3", "--out", "policy.json")
SWEEP = ("bench", "success", "--counts", "10,40", "--runs", "2", "--jobs", "1", "--out", "sweep")


def task(number: int) -> Scenario:
    """Return one of 20 random tasks; every planner has its turn, in both drives."""
    planner, drive = KINDS[number % len(KINDS)]
    if number % 4 == 3:
        drawn = random_task(7000 + number, count=None, layout=("arc", "u-shape")[number // 4 % 2])
    else:
        layout = "rectangles" if number % 4 == 2 else "scatter"
        drawn = random_task(7000 + number, count=30 + 10 * (number % 3), layout=layout)
    return with_options(drawn, planner=planner, drive=drive)


def bytes_of(command: tuple[str, ...], file: str) -> bytes:
    """Return a file that a command writes in a folder of its own."""
    with TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(sys, "argv", ["fuzzyq", *command])
        app.call()
        return Path(file).read_bytes()


def known(case: str) -> str:
    """Return what a case came to."""
    return str(json.loads(KNOWN.read_text())[case])


def told(trajectory: Trajectory) -> str:
    """Return all that is compared of a run."""
    return f"{trajectory.outcome} {trajectory.digest()}"


def digest(scenario: Scenario) -> str:
    return told(run(scenario))


def sha(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:32]


CASES: dict[str, Callable[[], str]] = {
    **{name: lambda name=name: digest(load_scenario(name)) for name in bundled_scenarios()},
    **{f"task {number}": lambda number=number: digest(task(number)) for number in range(20)},
    "train": lambda: sha(bytes_of(TRAIN, "policy.json").replace(VERSION, b"VERSION")),
    "sweep": lambda: sha(bytes_of(SWEEP, "sweep/success.csv")),
}


@pytest.mark.slow
@pytest.mark.skipif(not SAME_SINES, reason="sines differ elsewhere")
@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("case", [case for case in CASES if not case.startswith("figure-")])
def test_it_comes_to_the_same_as_ever(case: str) -> None:
    assert CASES[case]() == known(case)


if __name__ == "__main__":
    KNOWN.write_text(json.dumps({name: case() for name, case in CASES.items()}, indent=1) + "\n")
