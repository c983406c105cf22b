"""A file of one's own adds a study: it sweeps, resumes, prints, writes, and is in the report."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from fuzzyq_bullet.studies import Study, register_study
from tests.helpers.commands import Call

EXAMPLE = Path(__file__).parents[2] / "examples" / "extend" / "study.py"
COMMAND = ("bench", "turn-weight", "--plugin", EXAMPLE, "--runs", "2", "--counts", "5")


@pytest.mark.slow
def test_a_study_of_ones_own_is_a_command_that_goes_on_and_is_in_the_report(
    fuzzyq: Call, tmp_path: Path
) -> None:
    assert len(EXAMPLE.read_text().splitlines()) <= 60
    home = tmp_path / "own"
    first = fuzzyq(*COMMAND, "--jobs", "1", "--out", home)
    assert first.returncode == 0, first.stderr
    assert "arrived" in first.stdout
    assert "6 episodes" in first.stderr
    with (home / "turn-weight.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["planner"] for row in rows} == {"turn-0.25", "turn-0.5", "turn-1"}

    table = (home / "turn-weight.csv").read_bytes()
    journal = home / "journal.jsonl"
    journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:-2]))
    again = fuzzyq(*COMMAND, "--jobs", "1", "--out", home, "--json")
    assert "2 episodes" in again.stderr
    assert json.loads(again.stdout) == json.loads((home / "turn-weight.json").read_text())
    assert (home / "turn-weight.csv").read_bytes() == table

    unknown = fuzzyq("report", tmp_path, "--no-videos", "--no-figures")
    assert unknown.returncode == 2
    assert "no study 'turn-weight' is known; --plugin FILE adds it" in unknown.stderr
    shown = fuzzyq("report", tmp_path, "--plugin", EXAMPLE, "--no-videos", "--no-figures")
    assert shown.returncode == 0, shown.stderr
    page = (tmp_path / "report.html").read_text()
    assert "Weights of the turn" in page
    assert (
        f"fuzzyq bench turn-weight --counts 5 --runs 2 --seed 0 --out {home} --plugin {EXAMPLE}\n"
        f"fuzzyq report {tmp_path} --no-videos --no-figures --plugin {EXAMPLE}<"
    ) in page


def test_a_name_that_cannot_be_a_command_or_is_taken_is_refused() -> None:
    for name, told in (("speed", "speed"), ("Two Words", "small letters"), ("escape", "already")):
        with pytest.raises(ValueError, match=told):
            register_study(type("Own", (Study,), {"name": name, "__module__": __name__}))


PLANNER = """\
from typing import Literal
from fuzzyq_bullet import Decision, PlannerSettings, register_planner
class Settings(PlannerSettings):
    name: Literal["mine"] = "mine"
class Mine:
    def decide(self, observation):
        return Decision(heading=0.0, step=0.2)
register_planner("mine", Settings, lambda settings, rng: Mine())
"""


def test_a_planner_from_a_file_in_another_folder_is_swept(fuzzyq: Call, tmp_path: Path) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "pl.py").write_text(PLANNER)
    done = fuzzyq(
        *("bench", "escape", "--plugin", "../pl.py", "--planner", "mine", "--drive", "kinematic"),
        *("--runs", 1, "--counts", 5, "--traps", 0, "--rectangles", "none", "--jobs", 1, "--json"),
        cwd=tmp_path / "here",
    )
    (line,) = json.loads(done.stdout)["rows"]
    assert line["drives"]["kinematic"]["errors"] == 0
    assert "died" not in (tmp_path / "here" / "out" / "escape" / "escape.csv").read_text()


def test_a_study_whose_episodes_failed_says_why_the_first_did(fuzzyq: Call, tmp_path: Path) -> None:
    broken = PLANNER.replace("return Decision", "raise ValueError('lost'); return Decision")
    (tmp_path / "broken.py").write_text(broken)
    done = fuzzyq(
        *("bench", "escape", "--plugin", "broken.py", "--planner", "mine", "--drive", "kinematic"),
        *("--runs", 2, "--counts", 5, "--traps", 0, "--rectangles", "none", "--jobs", 1),
        cwd=tmp_path,
    )
    assert done.returncode == 1
    said = done.stderr.splitlines()
    told = next(k for k, line in enumerate(said) if line.startswith("2 episodes failed"))
    assert "planner mine: stopped by ValueError: lost, after 0.00 s (" in said[told + 1]


WORKING = """\
from fuzzyq_bullet.studies import (
    FieldsPlan, Findings, Study, described, planners_of, register_study
)
from fuzzyq_bullet.studies.sweep import work_for_row
def work(order):
    done = work_for_row(order)
    return {**done, "row": {**done["row"], "error": f"worked in {__name__}"}}
@register_study
class Working(Study):
    name = "working"
    def planner_set(self):
        return planners_of("fuzzy")
    def plan(self):
        told = described(self.planner_set())
        return FieldsPlan(sweep=self.name, planners=told, counts=(5,), runs=1)
    def work(self):
        return work
    def findings(self, results):
        return Findings((), {"said": results[self.name].rows[0].error})
"""


@pytest.mark.slow
def test_a_study_of_ones_own_may_say_itself_what_a_worker_does(
    fuzzyq: Call, tmp_path: Path
) -> None:
    """The plugin is the same module in the worker, though its folder is on the path there."""
    (tmp_path / "working.py").write_text(WORKING)
    done = fuzzyq("bench", "working", "--plugin", "working.py", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == {"said": "worked in working"}
