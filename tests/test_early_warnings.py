"""What is allowed and yet hardly meant is told before a run, and changes no verdict."""

from __future__ import annotations

import importlib.machinery
import importlib.util
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.early_warnings import early_warnings
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario import bundled_scenarios, find_scenario, load_scenario, realise
from tests.helpers.commands import Call

HEAD = "name: doubtful\nstart: {position: [1.0, 5.0]}\ngoal: {position: [9.0, 5.0]}\n"
WALL = "obstacles:\n  - {shape: box, position: [5.0, 5.0], size: [0.2, 10.0]}\n"


def warnings_of(text: str, folder: Path) -> list[str]:
    path = folder / "s.yaml"
    path.write_text(text)
    scenario = load_scenario(path)
    warnings = early_warnings(str(path), scenario, realise(scenario))
    return [warning.removeprefix(f"{path}:") for warning in warnings]


def test_no_way_at_all_is_told(tmp_path: Path) -> None:
    (line,) = warnings_of(HEAD + WALL, tmp_path)
    assert line.startswith("3: goal: there is no way from the start to the goal")
    assert warnings_of(HEAD + WALL.replace("10.0]}", "9.0]}"), tmp_path) == []


def test_who_expects_no_goal_is_told_of_no_way(tmp_path: Path) -> None:
    assert warnings_of(HEAD + WALL + "expect: {outcome: timeout}\n", tmp_path) == []


@pytest.mark.parametrize(
    ("more", "place"),
    [
        ("limits: {time: 12.9}\n", "4: limits.time: 12.9 s is too short"),
        ("expect: {max_time: 12.9}\n", "4: expect.max_time: 12.9 s is too short"),
        ("robot: {max_speed: 0.05}\n", "1: limits.time: 120 s is too short"),
    ],
)
def test_a_limit_shorter_than_the_straight_line_is_told(
    more: str, place: str, tmp_path: Path
) -> None:
    (line,) = warnings_of(HEAD + more, tmp_path)
    assert line.startswith(place)
    assert "the straight line of 7.8 m to the goal takes" in line
    assert warnings_of(HEAD + more.replace("12.9", "13.1").replace("0.05", "0.5"), tmp_path) == []
    assert warnings_of(HEAD + more + "drive: kinematic\n", tmp_path) == []


@given(st.floats(-100.0, 100.0))
def test_an_angle_beyond_a_full_turn_looks_like_degrees(
    tmp_path_factory: pytest.TempPathFactory, angle: float
) -> None:
    text = HEAD.replace("5.0]}\ngoal", f"5.0], heading: {angle:.6f}}}\ngoal")
    lines = warnings_of(text, tmp_path_factory.mktemp("angle"))
    if abs(round(angle, 6)) <= math.tau:
        assert lines == []
    else:
        (line,) = lines
        assert line.startswith("2: start.heading: ")
        assert f"did you mean {round(math.radians(float(f'{angle:.6f}')), 2):g}?" in line


def test_every_kind_of_angle_is_looked_at(tmp_path: Path) -> None:
    text = HEAD + "obstacles:\n  - {shape: box, position: [5, 8], size: [1, 1], yaw: 45}\n"
    text += "random: {layout: semicircle, direction: 90}\n"
    lines = warnings_of(text, tmp_path)
    assert [line.split(" ")[1] for line in lines] == ["obstacles[0].yaw:", "random.direction:"]


@pytest.mark.parametrize("name", bundled_scenarios())
def test_nothing_is_doubtful_about_what_is_bundled(name: str) -> None:
    scenario = load_scenario(name)
    assert early_warnings(str(find_scenario(name)), scenario, realise(scenario)) == []


def test_degrees_that_no_angle_can_be_are_refused_as_such(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"at most 100, got 180; radians are meant: 3.14\?"):
        warnings_of(HEAD.replace("5.0]}\ngoal", "5.0], heading: 180}\ngoal"), tmp_path)


@pytest.mark.usefixtures("in_this_process")
def test_all_commands_tell(inside: Call, tmp_path: Path) -> None:
    path = tmp_path / "s.yaml"
    path.write_text(HEAD + WALL + "limits: {time: 0.5}\n")
    for command in (("validate",), ("run", "--no-video", "--out", tmp_path / "o"), ("check",)):
        done = inside(command[0], path, *command[1:])
        said = done.stdout + done.stderr
        assert "there is no way from the start to the goal" in said
        assert "0.5 s is too short" in said
        assert done.returncode == (0 if command == ("validate",) else 1)
        lines = done.stdout.splitlines()
    assert "no way" in lines[1]
    assert lines[2].strip() == "outcome timeout, expected goal"
    assert sum("no way" in line for line in lines) == 1


@pytest.mark.usefixtures("in_this_process")
def test_github_is_told_at_the_line(inside: Call, tmp_path: Path) -> None:
    path = tmp_path / "s.yaml"
    path.write_text(HEAD.replace("5.0]}\ngoal", "5.0], heading: 90}\ngoal"))
    done = inside("check", path, "--github", "--drive", "kinematic")
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("::warning")]
    assert ",line=2," in line


def test_a_tip_too_sharp_for_the_sensor_is_told(tmp_path):
    file = tmp_path / "tip.yaml"
    file.write_text(
        "name: tip\nstart: {position: [1.0, 1.0]}\ngoal: {position: [9.0, 9.0]}\nobstacles:\n"
        "  - {shape: polygon, points: [[4.0, 4.0], [5.0, 4.0], [5.0, 5.0], [4.0, 5.0]]}\n"
        "  - {shape: polygon, points: [[3.0, 3.0], [4.0, 3.05], [4.0, 2.95]]}\n"
    )
    scenario = load_scenario(file)
    [line] = early_warnings(str(file), scenario, scenario)
    assert line.startswith(f"{file}:6: obstacles[1]: has a sharp tip")


@pytest.mark.parametrize(
    ("planner", "line"),
    [
        ("{name: dwa, interval: 0.02}", "4: planner.interval: 0.02 s is shorter than the 0.05 s "),
        ("{name: apf, escape: false, patience: 2}", "4: planner.patience: is of no effect: escape"),
        ("{name: vfh, goal_cost: 4}", "4: planner.goal_cost: 4 is not greater than turn_cost + "),
        ("{name: dwa, guard: false, closing_speed: 0.4}", "4: planner.closing_speed: the safety f"),
        ("{name: q-lambda, closing_speed: 0.4}", "4: planner.closing_speed: the safety filter rec"),
    ],
)
def test_settings_of_the_planner_that_are_hardly_meant_are_told(
    planner: str, line: str, tmp_path: Path
) -> None:
    (told,) = warnings_of(f"{HEAD}planner: {planner}\n", tmp_path)
    assert told.startswith(line)


@pytest.mark.parametrize(
    "planner",
    [
        "{name: improved-fuzzy, guard: false, closing_speed: 0.4}",
        "{name: dwa, rate: 2}",
        "{name: dwa, interval: 0.05}",
        "{name: apf, patience: 2}",
        "vfh",
    ],
)
def test_settings_that_may_be_meant_are_not_told(planner: str, tmp_path: Path) -> None:
    assert warnings_of(f"{HEAD}planner: {planner}\n", tmp_path) == []


def test_a_planner_whose_package_is_missing_is_told_with_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = importlib.machinery.ModuleSpec("navground", None)
    for spec, told in ((None, 1), (found, 0)):
        monkeypatch.setattr(importlib.util, "find_spec", lambda name, spec=spec: spec)
        lines = warnings_of(f"{HEAD}planner: navground\n", tmp_path)
        assert len(lines) == told
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    (line,) = warnings_of(f"{HEAD}planner: navground\n", tmp_path)
    assert line == (
        "4: planner: a run would fail: the package navground is not installed: "
        "pip install 'fuzzyq_bullet[peers]'"
    )
