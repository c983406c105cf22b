"""The example of a planner of one's own, through the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import Call

EXAMPLE = Path(__file__).parent.parent / "examples" / "extend" / "planner.py"
WORLD = """\
name: own
arena: {size: [4.0, 3.0]}
start: {position: [0.6, 1.5]}
goal: {position: [3.2, 1.5]}
planner: {name: greedy, room: 0.4}
obstacles: [{shape: cylinder, position: [1.8, 1.4], radius: 0.25}]
expect: {min_clearance: 0.0}
"""


@pytest.fixture
def world(tmp_path: Path) -> Path:
    path = tmp_path / "own.yaml"
    path.write_text(WORLD)
    return path


def test_a_run_and_a_check_take_the_planner_of_a_plugin(world: Path, fuzzyq: Call) -> None:
    assert len(EXAMPLE.read_text(encoding="utf-8").splitlines()) <= 60
    done = fuzzyq(*("run", world, "--plugin", EXAMPLE, "--no-video", "--json"), cwd=world.parent)
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert (result["planner"], result["outcome"]) == ("greedy", "goal")
    assert result["path_length_m"] > result["shortest_path_m"]
    checked = fuzzyq("check", world, "--plugin", EXAMPLE, "--jobs", 1, "--json")
    assert checked.returncode == 0, checked.stderr
    assert json.loads(checked.stdout)["passed"] == 1


def test_a_key_that_it_does_not_have_is_the_users_mistake(world: Path, fuzzyq: Call) -> None:
    world.write_text(WORLD.replace("room: 0.4", "rooms: 1"))
    done = fuzzyq("validate", world, "--plugin", EXAMPLE)
    assert done.returncode == 2
    assert "own.yaml:5: planner.rooms: " in done.stderr
