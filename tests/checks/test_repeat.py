"""``fuzzyq check --repeat``: one verdict on all seeds, the worst run, and what reports show."""

from __future__ import annotations

import io
import json
import shlex
from pathlib import Path

import pytest
from lxml import etree

from fuzzyq_bullet.checks.group import allow, group_lines, group_of, worst_of
from fuzzyq_bullet.checks.reports import junit_xml
from fuzzyq_bullet.checks.verdict import Status, Verdict
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.recording.metrics import Result
from fuzzyq_bullet.scenario import register_expectation
from tests.checks.test_check import SCHEMA
from tests.helpers.commands import Call

FIELD = """\
name: field
arena: {size: [4.0, 4.0]}
start: {position: [0.5, 2.0]}
goal: {position: [3.5, 2.0]}
planner: {name: fuzzy, weights: [1.0, 1.0]}
drive: kinematic
random: {layout: scatter, count: 4, radius: 0.2}
expect: {pass_rate: RATE, max_time: 6.2}
"""
PLANNER = '''\
"""A planner that drives into the wall with every other seed or so, or raises."""

from typing import Literal

from fuzzyq_bullet import Decision, PlannerSettings, register_planner


class Settings(PlannerSettings):
    name: Literal["by-chance"] = "by-chance"


class ByChance:
    def __init__(self, settings, rng):
        self.drawn = rng.uniform()

    def decide(self, seen):
        if self.drawn > 0.7:
            raise ValueError("no way")
        return Decision(heading=1.5 if self.drawn > 0.4 else 0.0, step=0.3)


register_planner("by-chance", Settings, ByChance)
'''


def run_of(
    seed: int,
    status: Status = "passed",
    outcome: str = "goal",
    clearance: float = 0.2,
    time_s: float = 5.0,
    rate: float = 1.0,
) -> Verdict:
    modes = {"routine": 0, "breakout": 0, "following": 0}
    figures = dict.fromkeys(Result.model_fields, 0) | {
        "scenario": "field",
        "planner": "fuzzy",
        "drive": "wheels",
        "version": "1",
        "outcome": outcome,
        "seed": seed,
        "time_s": time_s,
        "min_clearance_m": clearance,
        "modes": modes,
        "digest": f"{seed:032x}",
        "no_shortest_path": None,
    }
    result = None if status in ("broken", "invalid") else Result.model_validate(figures)
    return Verdict(
        name=f"field-seed-{seed}",
        file="field.yaml",
        status=status,
        result=result,
        why=[] if status == "passed" else ["why"],
        expect=None if result is None else {"pass_rate": rate},
        replay=f"fuzzyq run field.yaml --seed {seed}",
    )


def several(passed: int, of: int, rate: float) -> list[Verdict]:
    return [run_of(i, "passed" if i < passed else "failed", rate=rate) for i in range(of)]


@pytest.mark.parametrize(
    ("passed", "rate", "status", "told", "note"),
    [
        (20, 1.0, "passed", "20 of 20 pass, 95 % interval 0.84 to 1.00", ""),
        (20, 0.95, "passed", "20 of 20 pass", "the interval begins at 0.84; 73 runs that all"),
        (19, 0.95, "passed", "flaky: 19 of 20 pass, 95 % interval 0.76 to 0.99", "more runs"),
        (17, 0.95, "failed", "flaky: 17 of 20 pass, 95 % interval 0.64 to 0.95", ""),
        (18, 0.95, "failed", "flaky: 18 of 20 pass", "rule out 0.95: the interval ends at 0.97"),
        (19, 1.0, "failed", "flaky: 19 of 20 pass", ""),
        (0, 0.05, "failed", "broken: 0 of 20 pass, 95 % interval 0.00 to 0.16", "rule out 0.05"),
    ],
)
def test_a_group_passes_by_its_share_and_a_wide_interval_is_a_note(
    passed: int, rate: float, status: str, told: str, note: str
) -> None:
    group = group_of("field", several(passed, 20, rate))
    assert group.status == status
    assert told in group_lines(group)[0]
    assert (note in " ".join(group.notes)) if note else not group.notes


def test_73_runs_that_all_pass_show_095_and_72_do_not() -> None:
    assert not group_of("field", several(73, 73, 0.95)).notes
    assert group_of("field", several(72, 72, 0.95)).notes


def test_the_worst_run_failed_worst_then_touched_then_came_nearest_then_took_longest() -> None:
    order = [
        run_of(9, "broken"),
        run_of(8, "failed", "collision", clearance=-0.01),
        run_of(7, "failed", "collision", clearance=0.0),
        run_of(6, "failed", "stuck", clearance=0.01),
        run_of(5, "failed", "timeout", clearance=0.01),
        run_of(4, "failed", clearance=0.0),
        run_of(3, clearance=0.1),
        run_of(2, clearance=0.2, time_s=9.0),
        run_of(1, clearance=0.2, time_s=8.0),
        run_of(0, clearance=0.2, time_s=8.0),
    ]
    for i in range(len(order) - 2):
        assert worst_of([*order[:i:-1], order[i]]) is order[i]
    assert worst_of(order[-1:-3:-1]) is order[-1], "of equals, the first seed"


def test_a_crash_is_allowed_by_no_pass_rate_and_what_cannot_run_is_a_mistake() -> None:
    runs = [*several(9, 10, 0.5), run_of(10, "broken")]
    group = group_of("field", runs)
    allow(group, runs)
    assert group.status == "broken"
    assert "1 run of 11 crashed" in group.why[0]
    assert runs[9].status == "failed"
    assert group_of("field", [*runs, run_of(11, "invalid")]).status == "invalid"


def test_pass_rate_is_no_name_for_an_expectation_of_ones_own() -> None:
    with pytest.raises(ValueError, match="'pass_rate' is registered already"):
        register_expectation("pass_rate", sense="at least", said="{}")


def test_the_junit_report_has_a_suite_for_each_group_and_what_is_allowed_is_skipped() -> None:
    good, bad = several(9, 10, 0.9), several(5, 10, 0.9)
    for verdict in bad:
        verdict.file = "other.yaml"
    groups = [group_of("good", good), group_of("bad", bad)]
    for group, runs in zip(groups, (good, bad), strict=True):
        allow(group, runs)
    report = etree.fromstring(junit_xml([*good, *bad], ["a mistake"], 1.0, groups).encode())
    etree.XMLSchema(etree.parse(io.BytesIO(SCHEMA.encode()))).assertValid(report)
    counts = [
        [suite.get(key) for key in ("name", "tests", "failures", "errors", "skipped")]
        for suite in report
    ]
    assert counts == [
        ["good", "11", "0", "0", "1"],
        ["bad", "11", "6", "0", "0"],
        ["fuzzyq check", "1", "0", "1", "0"],
    ]
    assert report.find(".//skipped").get("message") == "allowed by the pass rate: why"
    last = report.findall("testsuite")[1].findall("testcase")[-1]
    assert last.get("name") == "all 10 runs"
    assert "flaky: 5 of 10 pass" in last.find("failure").get("message")


def checked(inside: Call, folder: Path, rate: str, *more: str) -> tuple[int, str, str]:
    (folder / "field.yaml").write_text(FIELD.replace("RATE", rate))
    options = ["--seed", "3", "--repeat", "8", *more]
    done = inside("check", "field.yaml", *options, cwd=folder)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.slow
@pytest.mark.usefixtures("in_this_process")
def test_from_seeds_to_verdict_film_and_replay(inside: Call, tmp_path: Path) -> None:
    code, out, err = checked(inside, tmp_path, "0.2", "--json", "--video", "failed", "--out", "o")
    told = json.loads(out)
    (group,), runs = told["groups"], told["scenarios"]
    assert code == 0, err
    assert [run["result"]["seed"] for run in runs] == list(range(3, 11))
    assert 2 <= group["passed"] < 8
    assert {run["status"] for run in runs} == {"passed", "allowed"}
    assert (told["passed"], told["failed"]) == (group["passed"], 0)
    assert told["allowed"] == 8 - group["passed"]
    # Only the worst is filmed, and its command drives it again.
    assert [run["name"] for run in runs if run["video"]] == [group["worst"]]
    assert {path.stem for path in (tmp_path / "o").iterdir()} == {group["worst"]}
    command = shlex.split(group["replay"])
    assert group["worst"] == f"field-seed-{command[-1]}"
    assert command[-2] == "--seed"
    again = inside(*command[1:], "--no-video", "--json", cwd=tmp_path)
    (worst,) = [run for run in runs if run["name"] == group["worst"]]
    assert json.loads(again.stdout)["digest"] == worst["result"]["digest"]


@pytest.mark.usefixtures("in_this_process")
def test_too_few_that_pass_fail_and_no_run_of_it_is_called_a_failure_before(
    inside: Call, tmp_path: Path
) -> None:
    code, out, _ = checked(inside, tmp_path, "1.0", "--github")
    assert code == 1
    assert "FAIL  field          flaky: 4 of 8 pass, " in out
    assert "miss  field-seed-" in out
    assert out.count("::error ") == 1
    (line,) = [line for line in out.splitlines() if line.startswith("      again: ")]
    assert "--seed" in line


@pytest.mark.usefixtures("in_this_process")
def test_a_group_is_compared_by_pass_rate_and_mean_time(inside: Call, tmp_path: Path) -> None:
    assert checked(inside, tmp_path, "0.2", "--record")[0] == 0
    assert "changed" not in checked(inside, tmp_path, "0.2", "--strict")[1]
    path = tmp_path / "check-record.json"
    record = json.loads(path.read_text())
    ((key, group),) = record["groups"].items()
    assert key == "field/fuzzy/kinematic/3+8"
    group["passed"] += 1
    group["mean_time_s"] /= 1.12
    path.write_text(json.dumps(record))
    code, out, _ = checked(inside, tmp_path, "0.2", "--strict")
    assert code == 1
    assert f"of 8 pass, recorded {group['passed']} of 8" in out
    assert "changed: mean time +12 %: " in out


@pytest.mark.usefixtures("in_this_process")
def test_repeating_what_the_seed_does_not_change_tells_nothing(
    inside: Call, tmp_path: Path
) -> None:
    listed = FIELD.replace("random: ", "description: '").replace("0.2}\n", "0.2}'\n")
    (tmp_path / "field.yaml").write_text(listed.replace("RATE", "0.9"))
    done = inside("check", "field.yaml", "--repeat", "2", cwd=tmp_path)
    assert "note: all 2 runs are the same: the seed changes nothing here" in done.stdout


@pytest.mark.usefixtures("in_this_process")
def test_one_run_is_one_of_one(inside: Call, tmp_path: Path) -> None:
    text = FIELD.replace("RATE", "0.01").replace("6.2", "0.5")
    (tmp_path / "field.yaml").write_text(text)
    done = inside("check", "field.yaml", cwd=tmp_path)
    assert done.returncode == 1
    assert "FAIL  field" in done.stdout


@pytest.mark.parametrize("rate", ["0", "1.01", ".nan", "95 %", "-1"])
def test_a_pass_rate_is_a_share(inside: Call, tmp_path: Path, rate: str) -> None:
    path = tmp_path / "field.yaml"
    path.write_text(FIELD.replace("RATE", rate))
    with pytest.raises(UserError, match=r"field.yaml:8: expect.pass_rate: (must be|expected) "):
        inside("validate", path)


@pytest.mark.slow
def test_a_planner_of_ones_own_that_raises_with_some_seeds_in_two_processes(
    fuzzyq: Call, tmp_path: Path
) -> None:
    (tmp_path / "field.yaml").write_text(FIELD.replace("RATE", "0.01"))
    (tmp_path / "mine.py").write_text(PLANNER)
    options = ["--plugin", "mine.py", "--planner", "by-chance", "--repeat", "8", "--jobs", "2"]
    done = fuzzyq("check", "field.yaml", *options, "--json", cwd=tmp_path)
    told = json.loads(done.stdout)
    (group,) = told["groups"]
    assert done.returncode == 1
    assert group["status"] == "broken"
    assert told["broken"] > 0
    assert [int(run["name"].rpartition("-")[2]) for run in told["scenarios"]] == list(range(8))
    assert group["replay"].startswith(
        "fuzzyq check field.yaml --plugin mine.py --planner by-chance"
    )
