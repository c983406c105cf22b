"""The example of a planner of one's own, through the command line."""

from __future__ import annotations

import json
import shlex
import signal
import subprocess
import time
from pathlib import Path

import pytest

from tests.helpers.commands import FUZZYQ, Call

EXAMPLE = Path(__file__).parents[2] / "examples" / "extend" / "planner.py"
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


@pytest.mark.slow
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


LEARNS = EXAMPLE.with_name("policy.py")


@pytest.mark.slow
def test_a_planner_of_a_plugin_learns_and_uses_what_it_learned(
    world: Path, fuzzyq: Call, tmp_path: Path
) -> None:
    assert len(LEARNS.read_text(encoding="utf-8").splitlines()) <= 60
    policy = tmp_path / "policy.json"
    asked = ("train", "long-memory", "--plugin", LEARNS, "--episodes", 4, "--out", policy)
    done = fuzzyq(*asked, "--json")
    assert done.returncode == 0, done.stderr
    made = json.loads(policy.read_text())
    assert (made["planner"], made["parameters"]["trace_decay.start"]) == ("long-memory", 0.9)

    world.write_text(WORLD.replace("greedy, room: 0.4", "long-memory, policy: policy.json"))
    done = fuzzyq(*("run", world, "--plugin", LEARNS, "--no-video", "--json"), cwd=world.parent)
    assert done.returncode in (0, 1), done.stderr  # four episodes teach little
    assert json.loads(done.stdout)["planner"] == "long-memory"


@pytest.mark.slow
def test_a_training_that_is_interrupted_names_its_plugin_in_the_command_that_goes_on(
    fuzzyq: Call, tmp_path: Path
) -> None:
    asked = ("train", "long-memory", "--plugin", LEARNS, "--episodes", "12")
    command = [FUZZYQ, *asked, "--out", tmp_path / "policy.json"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while not (tmp_path / "policy.checkpoint.npz").exists():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.002)
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=60)
    again = shlex.split(stderr.partition("to go on: fuzzyq ")[2].splitlines()[0])
    assert again[again.index("--plugin") + 1] == str(LEARNS)
    assert again[-1] == "--resume"
    done = fuzzyq(*again)
    assert done.returncode == 0, done.stderr
