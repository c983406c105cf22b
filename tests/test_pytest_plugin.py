"""The pytest plugin: scenario files as tests of somebody else's project."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path
from typing import TypeAlias
from xml.etree import ElementTree

import pytest

from tests.helpers.commands import SHORT

CRASH = """\
name: crash
arena: {size: [4.0, 4.0]}
start: {position: [2.0, 2.0]}
goal: {position: [3.5, 2.0]}
planner: {name: fuzzy, weights: [2.0, 2.0]}
obstacles:
  - {shape: cylinder, position: [3.5, 3.5], radius: 0.1}
  - {shape: box, position: [2.6, 1.6], size: [0.4, 1.2]}
"""
BY_HAND = """\
import sys

loaded = sys.modules.copy()

from typing import Literal

from fuzzyq_bullet import Decision, PlannerSettings, register_planner



def test_nothing_that_takes_time_is_imported_to_collect_scenarios():
    heavy = {"pybullet", "numpy", "pydantic", "fuzzyq_bullet.scenario"}
    assert not heavy & loaded.keys()


def test_by_hand(run_scenario):
    good, bad = run_scenario("fields/short.yaml", seed=4), run_scenario("crash.scenario.yaml")
    assert good.passed and good.result.seed == 4, good.explanation
    assert not bad.passed
    assert "touched the box obstacles[1]" in bad.explanation
    assert bad.trajectory.collision.obstacle == 1
    assert "again: fuzzyq run crash.scenario.yaml" in bad.explanation


class Settings(PlannerSettings):
    name: Literal["own"] = "own"


class Ahead:
    def decide(self, seen):
        return Decision(heading=0.0, step=0.4)


def test_with_a_planner_that_only_this_file_knows(run_scenario):
    register_planner("own", Settings, lambda settings, rng: Ahead())
    bad = run_scenario("crash.scenario.yaml", planner="own")
    test = "test_by_hand.py::test_with_a_planner_that_only_this_file_knows"
    assert bad.explanation.endswith(f"again: pytest {test}"), bad.explanation
"""

Done: TypeAlias = "subprocess.CompletedProcess[str]"


def pytest_in(folder: Path, *args: str) -> Done:
    """Run pytest with this plugin and xdist, whatever else is installed."""
    plugins = ["-p", "fuzzyq_bullet.pytest_plugin", "-p", "xdist"]
    return subprocess.run(
        [sys.executable, "-m", "pytest", *plugins, *args],
        cwd=folder,
        env={**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTEST_ADDOPTS": ""},
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("project")
    (folder / "pytest.ini").write_text("[pytest]\nfuzzyq_scenarios = fields\n")
    (folder / "fields").mkdir()
    (folder / "elsewhere").mkdir()
    (folder / "fields" / "short.yaml").write_text(SHORT)
    (folder / "elsewhere" / "compose.yaml").write_text("services: {}\n")
    (folder / "crash.scenario.yaml").write_text(CRASH)
    (folder / "test_by_hand.py").write_text(BY_HAND)
    return folder


@pytest.fixture(scope="module")
def ran(project: Path) -> Done:
    return pytest_in(project, "-n", "2", "--junitxml=junit.xml", "-rA")


@pytest.mark.slow
def test_scenarios_are_tests_like_others_with_two_workers(ran: Done, project: Path) -> None:
    assert ran.returncode == 1, ran.stdout + ran.stderr
    assert "1 failed, 4 passed" in ran.stdout
    assert "PASSED fields/short.yaml::short" in ran.stdout
    cases = ElementTree.parse(project / "junit.xml").iter("testcase")
    assert {case.get("name"): case.find("failure") is not None for case in cases} == {
        "short": False,
        "crash": True,
        "test_by_hand": False,
        "test_with_a_planner_that_only_this_file_knows": False,
        "test_nothing_that_takes_time_is_imported_to_collect_scenarios": False,
    }


def test_a_failure_is_explained_without_a_traceback(ran: Done) -> None:
    assert "outcome collision, expected goal\ntouched the box obstacles[1] (" in ran.stdout
    assert "again: fuzzyq run crash.scenario.yaml" in ran.stdout
    assert "crash.scenario.yaml::crash - outcome collision, expected goal" in ran.stdout
    assert "pytest_plugin.py" not in ran.stdout + ran.stderr
    assert "Traceback" not in ran.stdout + ran.stderr


@pytest.mark.slow
def test_the_last_failures_are_known_and_names_choose(ran: Done, project: Path) -> None:
    again = pytest_in(project, "--lf", "-n", "0", "--collect-only", "-q")
    assert "crash.scenario.yaml::crash" in again.stdout
    assert "short" not in again.stdout
    chosen = pytest_in(project, "-k", "short", "--collect-only", "-q")
    assert chosen.stdout.startswith("fields/short.yaml::short\n")
    assert "1/5 tests collected" in chosen.stdout


def test_it_is_installed_as_a_plugin_and_takes_nothing_else(project: Path) -> None:
    (entry,) = entry_points(group="pytest11", name="fuzzyq")
    assert entry.value == "fuzzyq_bullet.pytest_plugin"
    nothing = pytest_in(project / "elsewhere")
    assert nothing.returncode == pytest.ExitCode.NO_TESTS_COLLECTED


CHATTY = """\
from typing import Literal
from fuzzyq_bullet import Decision, PlannerSettings, register_planner
class Settings(PlannerSettings):
    name: Literal["configured"] = "configured"
class Ahead:
    def decide(self, seen):
        return Decision(heading=0.1, step=0.4)
register_planner("configured", Settings, lambda settings, rng: Ahead())
"""


@pytest.mark.slow
def test_a_test_by_hand_knows_the_planners_of_the_configuration(tmp_path: Path) -> None:
    (tmp_path / "pytest.ini").write_text("[pytest]\nfuzzyq_plugins = planners/own.py\n")
    (tmp_path / "planners").mkdir()
    (tmp_path / "planners" / "own.py").write_text(CHATTY)
    (tmp_path / "short.yaml").write_text(SHORT)
    (tmp_path / "test_it.py").write_text(
        "def test_it(run_scenario):\n"
        "    ran = run_scenario('short.yaml', planner='configured')\n"
        "    assert ran.passed, ran.explanation\n"
    )
    done = pytest_in(tmp_path)
    assert "1 passed" in done.stdout, done.stdout


@pytest.mark.slow
def test_a_scenario_that_is_no_file_is_a_failure_and_not_passed_over(tmp_path: Path) -> None:
    (tmp_path / "dead.scenario.yaml").symlink_to("nowhere")
    (tmp_path / "loop.scenario.yaml").symlink_to("loop.scenario.yaml")
    os.mkfifo(tmp_path / "pipe.scenario.yaml")
    done = pytest_in(tmp_path)
    assert done.returncode == 1
    assert "3 failed" in done.stdout
    assert "cannot be read: a link to nowhere, which is not there" in done.stdout
    assert "pipe.scenario.yaml: is not a regular file" in done.stdout


def test_a_folder_of_scenarios_that_is_not_there_is_no_pass(tmp_path: Path) -> None:
    (tmp_path / "pytest.ini").write_text("[pytest]\nfuzzyq_scenarios = scenarois\n")
    (tmp_path / "test_it.py").write_text("def test_it():\n    pass\n")
    done = pytest_in(tmp_path)
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    assert "scenarois: there is no such folder" in done.stderr + done.stdout


def test_a_folder_of_scenarios_may_lie_beside(tmp_path: Path) -> None:
    (tmp_path / "project").mkdir()
    (tmp_path / "shared").mkdir()
    (tmp_path / "shared" / "short.yaml").write_text(SHORT)
    (tmp_path / "project" / "pytest.ini").write_text("[pytest]\nfuzzyq_scenarios = ../shared\n")
    done = pytest_in(tmp_path / "project", "-c", "pytest.ini", "../shared", "--collect-only", "-q")
    assert "short.yaml::short" in done.stdout


@pytest.mark.slow
def test_a_repeated_scenario_is_a_test_for_each_seed_and_one_for_all(tmp_path: Path) -> None:
    (tmp_path / "pytest.ini").write_text("[pytest]\nfuzzyq_repeat = 4\n")
    text = (
        "name: lane\narena: {size: [4.0, 4.0]}\nstart: {position: [0.5, 2.0]}\n"
        "goal: {position: [3.5, 2.0]}\nplanner: {name: fuzzy, weights: [1.0, 1.0]}\n"
        "drive: kinematic\nseed: 5\nrandom: {layout: scatter, count: 4, radius: 0.2}\n"
        "expect: {max_time: 6.2, pass_rate: 0.5}\n"
    )
    (tmp_path / "lane.scenario.yaml").write_text(text)
    (tmp_path / "strict.scenario.yaml").write_text(text.replace("0.5}\n", "0.9}\n"))
    done = pytest_in(tmp_path, "-rA", "--junitxml=junit.xml")
    assert done.returncode == 1, done.stdout + done.stderr
    # Seeds 5 and 7 are quick enough, 6 and 8 are not.
    assert "1 failed, 5 passed, 4 xfailed" in done.stdout
    assert "PASSED lane.scenario.yaml::lane\n" in done.stdout
    assert "XFAIL lane.scenario.yaml::lane[seed+1] - took 6.7 s, expected 6.2 s" in done.stdout
    assert "FAIL  strict  flaky: 2 of 4 pass, 95 % interval 0.15 to 0.85\n" in done.stdout
    assert "again: fuzzyq run strict.scenario.yaml --seed " in done.stdout
    cases = ElementTree.parse(tmp_path / "junit.xml").iter("testcase")
    failed = [case.get("name") for case in cases if case.find("failure") is not None]
    assert failed == ["strict"]
    # The group alone runs what it needs; another process of xdist may have run the rest.
    assert "1 passed" in pytest_in(tmp_path, "-k", "lane and not seed").stdout
    refused = pytest_in(tmp_path, "-o", "fuzzyq_repeat=0")
    assert refused.returncode == 4
    assert "fuzzyq_repeat: must be a whole number from 1 to 10000, got '0'" in refused.stderr
