"""An expectation of a user's own: one file, read and held to by every command."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from fuzzyq_bullet import Trajectory
from fuzzyq_bullet.scenario import Expect, register_expectation
from fuzzyq_bullet.scenario.expectations import unmet_expectations
from tests.helpers.commands import SHORT

if TYPE_CHECKING:
    from tests.helpers.commands import Call

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "extend" / "expectation.py"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two scenarios, one of which nobody can drive turning so little."""
    folder = tmp_path_factory.mktemp("expected")
    for name, most in (("calm", 20.0), ("dizzy", 0.001)):
        text = SHORT.replace("name: short", f"name: {name}").replace("0.6]}", "0.6], heading: 0.9}")
        (folder / f"{name}.yaml").write_text(f"{text}expect: {{max_turning: {most}}}\n")
    return folder


@pytest.mark.slow
def test_check_holds_runs_to_the_example(fuzzyq: Call, folder: Path) -> None:
    done = fuzzyq("check", folder, "--plugin", EXAMPLE, "--json")
    assert done.returncode == 1, done.stderr
    calm, dizzy = json.loads(done.stdout)["scenarios"]
    assert calm["status"] == "passed"
    assert calm["expect"]["max_turning"] == 20.0
    assert dizzy["status"] == "failed"
    turned = dizzy["result"]["turning_rad"]
    assert dizzy["why"] == [f"turned {turned:.2f} rad, expected 0.001 rad or less"]


def test_run_and_the_record_know_it(fuzzyq: Call, folder: Path, tmp_path: Path) -> None:
    dizzy = folder / "dizzy.yaml"
    done = fuzzyq("run", dizzy, "--plugin", EXAMPLE, "--no-video", "--out", tmp_path)
    assert done.returncode == 1
    assert "not as expected: turned" in done.stderr
    # The record can be read by who has no such expectation.
    assert Trajectory.load(tmp_path / "dizzy.npz").scenario.expect == Expect()


@pytest.mark.slow
def test_pytest_holds_runs_to_it(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "pytest.ini").write_text(
        f"[pytest]\nfuzzyq_scenarios = {folder}\nfuzzyq_plugins = {EXAMPLE}\n"
    )
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-c", "pytest.ini"]
    done = subprocess.run([*command, folder], cwd=tmp_path, capture_output=True, text=True)
    assert "1 failed, 1 passed" in done.stdout, done.stdout
    assert "rad, expected 0.001 rad or less" in done.stdout


def test_mistakes_are_told_with_line_and_key(fuzzyq: Call, tmp_path: Path) -> None:
    mistakes = {
        "max_turning: -1": "max_turning: must be more than 0, got -1",
        "max_turning: much": "max_turning: expected a number, got 'much'",
        "max_turnin: 1": "max_turnin: unknown key; did you mean 'max_turning'? "
        "allowed: outcome, min_clearance, max_time, pass_rate, max_turning",
    }
    files = [tmp_path / f"{number}.yaml" for number in range(len(mistakes))]
    for file, written in zip(files, mistakes, strict=True):
        file.write_text(f"{SHORT}expect: {{{written}}}\n")
    done = fuzzyq("validate", *files, "--plugin", EXAMPLE)
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        f"error: {file}:8: expect.{said}"
        for file, said in zip(files, mistakes.values(), strict=True)
    ]


def test_without_the_plugin_the_key_is_unknown(inside: Call, folder: Path) -> None:
    with pytest.raises(Exception, match=r"expect\.max_turning: unknown key; .*pass_rate$"):
        inside("validate", folder / "calm.yaml")


@pytest.mark.parametrize("name", ["max_time", "outcome", "model_fields"])
def test_a_name_is_given_once(name: str) -> None:
    with pytest.raises(ValueError, match="registered already"):
        register_expectation(name, sense="at most", said="{}")


@pytest.mark.parametrize("name", ["max-time", "", "_x", "a b"])
def test_a_name_is_a_plain_key(name: str) -> None:
    with pytest.raises(ValueError, match="cannot be named"):
        register_expectation(name, sense="at most", said="{}")


class Figures:
    """Stands for a result, with one figure."""

    def __init__(self, time_s: Any) -> None:
        self.outcome, self.min_clearance_m, self.time_s = "goal", None, time_s


@pytest.mark.parametrize("figure", [None, float("nan"), 60.1, float("inf")])
def test_what_is_missing_or_no_number_or_too_much_meets_nothing(figure: float | None) -> None:
    assert len(unmet_expectations(Expect(max_time=60.0), Figures(figure))) == 1
    assert unmet_expectations(Expect(), Figures(figure)) == []
    assert unmet_expectations(Expect(max_time=60.0), Figures(60.0)) == []
