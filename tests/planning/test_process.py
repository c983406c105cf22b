"""The planner ``process``: a program that answers, or does not, and never outlives its run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fuzzyq_bullet import load_scenario, run
from fuzzyq_bullet.errors import PlannerError, UserError
from fuzzyq_bullet.scenario import parse_scenario
from tests.helpers.commands import FUZZYQ, Call

CONTROLLERS = Path(__file__).parents[2] / "examples" / "controllers"
LOOP = "import sys, json, time, os\nsys.stdin.readline()\nfor line in sys.stdin:\n "
AHEAD = LOOP + "print(json.dumps({'twist': [0.5, 0.0]}), flush=True)"
WORLD = """\
name: own
arena: {{size: [4.0, 3.0]}}
start: {{position: [0.6, 1.5]}}
goal: {{position: [1.4, 1.5]}}
drive: {drive}
planner: {{name: process, time_limit: 0.5, command: [{python}, ./mine.py], {more}}}
"""


def scenario_of(folder: Path, program: str, more: str = "", drive: str = "wheels") -> Path:
    (folder / "mine.py").write_text(program)
    path = folder / "own.yaml"
    path.write_text(WORLD.format(python=sys.executable, more=more, drive=drive))
    return path


def alive(folder: Path) -> list[str]:
    """Return the processes that have the folder in their command."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            command = (entry / "cmdline").read_text().replace("\0", " ")
        except OSError:
            continue
        if str(folder / "mine.py") in command and entry.name.isdigit():
            found.append(f"{entry.name} {command}")
    return found


def test_a_program_drives_to_the_goal_and_a_run_is_the_same_each_time(tmp_path: Path) -> None:
    path = scenario_of(tmp_path, AHEAD, "rate: 10, guard: true")
    one, two = run(load_scenario(path)), run(load_scenario(path))
    assert one.outcome == "goal"
    assert one.digest() == two.digest()
    assert set(one.decisions.twist_speed.tolist()) == {0.5}
    assert one.decisions.lengths.min() > 0.0
    assert alive(tmp_path) == []


@pytest.mark.parametrize(
    ("answer", "blamed"),
    [
        ("print('left!', flush=True)", "answered 'left!': which is no JSON (it was still running)"),
        ("print('{\"twist\": [NaN, 0]}', flush=True)", "NaN is no number"),
        ("print('{\"twist\": [1e999, 0]}', flush=True)", "twist.0: "),
        ("print('{\"turn\": 1}', flush=True)", "turn: unknown; allowed: heading, step, twist"),
        ("print('{\"heading\": 1}', flush=True)", "needs heading and step, or twist, or wheels"),
        ("print('[]', flush=True)", "which is no JSON object"),
        ("print('[' * 60000, flush=True)", "which is no JSON"),
        ("print('x' * 10**6, flush=True)", "longer than 65536 bytes"),
        ("print('{\"wheels\": [1, 1]}\\n' * 3, flush=True)", "before it was asked"),
        ("os.write(2, b'no map\\n'); os._exit(3)", "ended (exit status 3; its last words: 'no map"),
        ("os.kill(os.getpid(), 9)", "ended (exit status -9)"),
        ("time.sleep(60)", "gave no answer within 0.5 s (it was still running)"),
        ("os.write(1, b'{'); time.sleep(60)", "within 0.5 s, having said '{'"),
    ],
)
def test_what_a_program_does_wrong_is_one_line(tmp_path: Path, answer: str, blamed: str) -> None:
    path = scenario_of(tmp_path, LOOP + answer, "start_limit: 0.5")
    if "sleep" not in answer:
        path.write_text(path.read_text().replace("start_limit: 0.5", "start_limit: 10.0"))
    with pytest.raises(PlannerError) as caught:
        run(load_scenario(path))
    [line] = caught.value.problems
    assert "\n" not in line
    assert line.startswith("planner process: ")
    if "sleep" not in answer or "0.5 s (it" in line:  # else it had not begun yet
        assert blamed.replace("'", "") in line.replace("'", "").replace('"', "") or blamed in line
    assert alive(tmp_path) == []


def test_a_twist_needs_wheels(tmp_path: Path) -> None:
    with pytest.raises(PlannerError, match="needs the drive wheels, not kinematic"):
        run(load_scenario(scenario_of(tmp_path, AHEAD, drive="kinematic")))


@pytest.mark.parametrize(
    ("settings", "wrong"),
    [
        ("{name: process}", "own.yaml:5: planner: command: names no program"),
        ("{name: process, command: [./nobody]}", "planner.command: .*there is no such program"),
        (
            "{name: process, command: [sh, ./missing.py]}",
            "own.yaml:5: planner.command: '.*/missing.py': there is no such file",
        ),
        ("{name: process, command: [sh, ../missing]}", "planner.command: .*there is no such file"),
        ("{name: process, command: [sh, -u, gone.py]}", "planner.command: 'gone.py': there is no"),
        ("{name: process, command: [sh], rate: 7}", "planner.rate: .*240"),
        ("{name: process, command: [sh], time_limit: 0}", "planner.time_limit: "),
        ("{name: process, command: [sh], rays: {count: -1}}", "planner.rays.count: "),
    ],
)
def test_a_mistake_in_its_settings_is_told_with_its_line(
    tmp_path: Path, settings: str, wrong: str
) -> None:
    path = tmp_path / "own.yaml"
    head = WORLD.format(python="x", more="", drive="wheels").splitlines()[:4]
    path.write_text("\n".join([*head, f"planner: {settings}"]))
    with pytest.raises(UserError, match=wrong):
        load_scenario(path)


@pytest.mark.parametrize("words", ["-c, pass", "-, --log=./out.log", "./own.yaml, ./new.txt"])
def test_what_a_program_is_to_write_need_not_be_there(tmp_path: Path, words: str) -> None:
    path = tmp_path / "own.yaml"
    head = WORLD.format(python="x", more="", drive="wheels").splitlines()[:4]
    path.write_text("\n".join([*head, f"planner: {{name: process, command: [sh, {words}]}}"]))
    assert load_scenario(path).planner.name == "process"


def test_text_alone_means_the_same_whatever_programs_there_are() -> None:
    head = WORLD.format(python="x", more="", drive="wheels")
    assert parse_scenario(head).planner.name == "process"


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="looks into /proc")
@pytest.mark.parametrize("signum", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_nothing_is_left_behind_when_the_run_is_killed(tmp_path: Path, signum: int) -> None:
    # It has a child of its own, and neither notices that its input ends.
    program = "import os, time\nos.fork()\nwhile True: time.sleep(1)"
    path = scenario_of(tmp_path, program, "start_limit: 60.0")
    job = subprocess.Popen([FUZZYQ, "run", path, "--no-video"], cwd=tmp_path, stderr=-1)
    deadline = time.monotonic() + 60.0
    while len(alive(tmp_path)) < 2:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    time.sleep(0.5)  # what watches over it has begun
    os.kill(job.pid, signum)
    job.communicate(timeout=20)
    deadline = time.monotonic() + 5.0
    while alive(tmp_path) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert alive(tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gap", "wheels"])
def test_the_examples_reach_the_goal(name: str, fuzzyq: Call) -> None:
    done = fuzzyq("check", CONTROLLERS / f"{name}.yaml", "--jobs", 1)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("model", ["jackal", "husky"])
def test_the_example_in_python_leads_larger_robots_too(model: str, tmp_path: Path) -> None:
    text = (CONTROLLERS / "gap.yaml").read_text().replace("./gap.py", str(CONTROLLERS / "gap.py"))
    path = tmp_path / "gap.yaml"
    path.write_text(f"{text}robot: {{model: {model}}}\n")
    assert run(load_scenario(path)).outcome == "goal"
