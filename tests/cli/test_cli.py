"""``fuzzyq`` as its users and their scripts rely on it: what it writes, prints and returns."""

from __future__ import annotations

import json
import os
import pty
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import jsonschema
import pytest
import yaml
from typer.testing import CliRunner

from fuzzyq_bullet import __version__
from fuzzyq_bullet.cli.app import app
from fuzzyq_bullet.recording.metrics import collision_text
from fuzzyq_bullet.recording.trajectory import Collision, Trajectory
from tests.helpers.commands import FUZZYQ, Call

RESULT_KEYS = [
    "scenario",
    "planner",
    "drive",
    "seed",
    "outcome",
    "steps",
    "decisions",
    "time_s",
    "path_length_m",
    "shortest_path_m",
    "spl",
    "min_clearance_m",
    "collisions",
    "turning_rad",
    "mean_jerk",
    "modes",
    "rules_turn",
    "digest",
    "version",
]


@pytest.mark.slow
def test_a_run_writes_its_video_its_record_and_its_result_and_nothing_else(filmed: Path) -> None:
    written = {path.name for path in filmed.iterdir()} - {"stdout", "stderr"}
    assert written == {"short.mp4", "short.npz", "short.json"}
    assert (filmed / "short.mp4").read_bytes()[4:8] == b"ftyp"


def test_json_is_alone_on_stdout_and_is_the_result_that_was_written(filmed: Path) -> None:
    printed = (filmed / "stdout").read_text()
    assert printed == (filmed / "short.json").read_text()
    result = json.loads(printed)
    assert list(result) == RESULT_KEYS
    assert result["scenario"] == "short"
    assert result["outcome"] == "goal"
    assert result["version"] == __version__
    assert result["decisions"] == sum(result["modes"].values()) > 0


def test_the_summary_goes_to_stderr_a_line_for_the_run_and_one_for_each_file(filmed: Path) -> None:
    first, *files = (filmed / "stderr").read_text().splitlines()
    assert first.startswith("short: goal after ")
    assert files == [f"  {filmed / 'short'}{ending}" for ending in (".mp4", ".npz", ".json")]


@pytest.mark.slow
def test_the_same_scenario_planner_and_seed_give_the_same_digest_in_another_process(
    installed: Call, short: Path, filmed: Path, tmp_path: Path
) -> None:
    again = installed("run", short, "--out", tmp_path, "--no-video", "--json")
    assert json.loads(again.stdout) == json.loads((filmed / "stdout").read_text())
    assert not (tmp_path / "short.mp4").exists()


@pytest.mark.slow
def test_a_replay_makes_the_same_video_to_the_byte(
    inside: Call, filmed: Path, tmp_path: Path
) -> None:
    done = inside("replay", filmed / "short.npz", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{tmp_path / 'short.mp4'}\n"
    assert (tmp_path / "short.mp4").read_bytes() == (filmed / "short.mp4").read_bytes()


@pytest.mark.slow
def test_a_replay_lies_beside_its_record_and_may_be_quicker(
    fuzzyq: Call, filmed: Path, tmp_path: Path
) -> None:
    shutil.copy(filmed / "short.npz", tmp_path)
    done = fuzzyq("replay", "short.npz", "--speed", "8", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "short-8x.mp4\n"), done.stderr
    assert (tmp_path / "short-8x.mp4").stat().st_size < (filmed / "short.mp4").stat().st_size


@pytest.mark.slow
def test_a_film_at_another_speed_replaces_none(
    inside: Call, short: Path, filmed: Path, tmp_path: Path
) -> None:
    shutil.copy(filmed / "short.npz", tmp_path)
    (tmp_path / "short.mp4").write_bytes(b"the film in real time")
    for args in (("replay", tmp_path / "short.npz"), ("run", short, "--out", tmp_path)):
        assert inside(*args, "--speed", "20").returncode == 0
        assert (tmp_path / "short.mp4").read_bytes() == b"the film in real time"
        assert (tmp_path / "short-20x.mp4").read_bytes()[4:8] == b"ftyp"
        (tmp_path / "short-20x.mp4").unlink()


def test_a_film_of_an_earlier_run_is_kept_and_said_to_be_that(
    inside: Call, short: Path, tmp_path: Path
) -> None:
    older = [tmp_path / name for name in ("short-4x.mp4", "short.mp4")]
    for path in (*older, tmp_path / "shorter.mp4", tmp_path / "short-cut.mp4"):
        path.write_bytes(b"an older one")
    done = inside("run", short, "--no-video", "--out", tmp_path)
    said = [line for line in done.stderr.splitlines() if "of an earlier run" in line]
    assert said == [f"{path} is of an earlier run" for path in older]
    assert all(path.read_bytes() == b"an older one" for path in older)


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


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_a_collision_says_what_was_touched_where_and_when(
    drive: str, inside: Call, tmp_path: Path
) -> None:
    (tmp_path / "crash.yaml").write_text(CRASH)
    done = inside("run", "crash.yaml", "--drive", drive, "--no-video", cwd=tmp_path)
    assert done.returncode == 1
    summary, contact, *_ = done.stderr.splitlines()
    assert "least clearance 0.000 m" in summary
    place = r"\(2\.\d\d, \d\.\d\d\) after \d+\.\d\d s"
    assert re.fullmatch(rf"touched the box obstacles\[1\] at {place}", contact)


@pytest.mark.parametrize(
    ("obstacle", "listed", "what"),
    [
        (1, 2, "touched the box obstacles[1] at (0.00, 2.50) after 9.31 s"),
        (0, 0, "touched the cylinder obstacles[0] (drawn) at (0.00, 2.50) after 9.31 s"),
        (-1, 2, "touched a wall at (0.00, 2.50) after 9.31 s"),
    ],
)
def test_what_was_touched_is_named(obstacle: int, listed: int, what: str, filmed: Path) -> None:
    record = Trajectory.load(filmed / "short.npz")
    collision = Collision(time=9.31, point=(-1e-9, 2.5), obstacle=obstacle, normal_force=1.0)
    assert collision_text(replace(record, collision=collision), listed) == what
    assert collision_text(record, listed) == ""


def test_options_take_the_place_of_what_the_scenario_says(
    inside: Call, short: Path, tmp_path: Path
) -> None:
    options = ("--planner", "fuzzy", "--seed", "7", "--drive", "kinematic")
    done = inside("run", short, *options, "--out", tmp_path, "--no-video", "--json")
    result = json.loads(done.stdout)
    assert (result["planner"], result["seed"], result["drive"]) == ("fuzzy", 7, "kinematic")


def test_a_missed_expectation_is_exit_code_1_with_everything_written(
    inside: Call, short: Path, tmp_path: Path
) -> None:
    hasty = tmp_path / "hasty.yaml"
    hasty.write_text(short.read_text() + "expect: {max_time: 0.5}\nlimits: {time: 1.0}\n")
    done = inside("run", hasty, "--out", tmp_path, "--no-video", "--json")
    assert done.returncode == 1
    assert json.loads(done.stdout)["outcome"] == "timeout"
    misses = [line for line in done.stderr.splitlines() if line.startswith("not as expected: ")]
    assert len(misses) == 2
    assert (tmp_path / "short.json").exists()
    assert (tmp_path / "short.npz").exists()


def test_validate_accepts_files_and_bundled_names_and_tells_every_mistake(
    fuzzyq: Call, inside: Call, short: Path, tmp_path: Path
) -> None:
    done = inside("validate", short, "mixed")
    assert (done.returncode, done.stdout) == (0, "")
    assert done.stderr == f"{short}: ok\nmixed: ok\n"
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(short.read_text() + "gaol: 1\nseed: yes\n")
    done = fuzzyq("validate", wrong, short)
    assert done.returncode == 2
    assert f"{short}: ok" in done.stderr
    errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    assert [line.split(": ")[1:3] for line in errors] == [
        [f"{wrong}:8", "gaol"],
        [f"{wrong}:9", "seed"],
    ]


def test_schema_is_one_that_the_bundled_scenarios_fulfil(fuzzyq: Call) -> None:
    schema = json.loads(fuzzyq("schema").stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    from fuzzyq_bullet.platforms import data_folder

    for path in data_folder("scenarios").glob("*.yaml"):
        validator.validate(yaml.safe_load(path.read_text()))


def test_the_reference_tells_of_every_key_of_the_schema(fuzzyq: Call) -> None:
    page = Path(__file__).parents[2] / "docs" / "reference" / "scenario.md"
    told = fuzzyq("schema", "--markdown").stdout
    assert told == page.read_text(), f"fuzzyq schema --markdown > {page} makes it anew"
    schema = json.loads(fuzzyq("schema").stdout)
    keys = [*schema["properties"], *schema["$defs"]["Robot"]["properties"]]
    keys += schema["$defs"]["Cylinder"]["properties"]
    for key in keys:
        assert f"\n| `{key}` | " in told, key


def test_the_reference_tells_how_many_items_a_list_may_have(fuzzyq: Call) -> None:
    schema, rows = json.loads(fuzzyq("schema").stdout), {}
    for line in fuzzyq("schema", "--markdown").stdout.splitlines():
        if line.startswith("| `points` | "):
            rows[line.split(" | ")[1]] = line
    for kind, model in (("patrol", "Patrol"), ("polygon", "Polygon")):
        points = schema["$defs"][model]["properties"]["points"]
        least, most = points["minItems"], points["maxItems"]
        assert f" a list of {least} to {most}; each: 2 × number" in rows[kind]
    assert schema["properties"]["via"]["maxItems"] == 100
    assert " | a list of at most 100; each: " in fuzzyq("schema", "--markdown").stdout


def test_the_schema_knows_what_plugins_add(fuzzyq: Call) -> None:
    extend = Path(__file__).parents[2] / "examples" / "extend"
    kinds = ("shape", "motion", "layout", "robot", "planner", "sensor", "expectation")
    told = fuzzyq(
        "schema", *(word for kind in kinds for word in ("--plugin", extend / f"{kind}.py"))
    )
    assert told.returncode == 0, told.stderr
    validator = jsonschema.Draft202012Validator(json.loads(told.stdout))
    pillar = {"shape": "pillar", "position": [1.2, 0.4], "radius": 0.2}
    scenario = {
        "name": "room",
        "start": {"position": [0.6, 0.6]},
        "goal": {"position": [1.8, 0.7]},
        "obstacles": [{**pillar, "motion": {"kind": "swing", "angle": 0.0}}],
        "random": {"layout": "orchard", "spacing": 1.0},
        "robot": {"model": "mouse"},
        "planner": {"name": "greedy", "room": 0.4},
        "sensor": {"model": "rounded", "step": 0.1},
        "expect": {"max_turning": 20.0},
    }
    validator.validate(scenario)
    wrong = {"obstacles": [{**pillar, "sides": 2}], "planner": {"name": "greedy", "rooms": 1}}
    wrong |= {"random": {"layout": "orchard", "spacing": 0.1}, "robot": {"model": "mole"}}
    for key, value in wrong.items():
        assert not validator.is_valid({**scenario, key: value}), key


def test_list_names_every_bundled_scenario(inside: Call) -> None:
    table, data = inside("list"), json.loads(inside("list", "--json").stdout)
    assert [line.split()[0] for line in table.stdout.splitlines()] == list(data)
    assert {"boxes", "mixed"} <= set(data)


def test_the_command_alone_and_a_group_alone_show_their_help(fuzzyq: Call) -> None:
    for args, word in (((), "replay"), (("bench",), "speed"), (("-h",), "replay")):
        done = fuzzyq(*args)
        assert done.returncode == 0
        assert word in done.stdout
        assert done.stderr == ""


def test_the_help_of_a_study_is_whole_and_flows(fuzzyq: Call) -> None:
    lines = fuzzyq("bench", "field", "--help").stdout.splitlines()
    options = next(number for number, line in enumerate(lines) if "╭" in line)
    told = " ".join(" ".join(lines[options:]).replace("│", " ").split())
    assert "q-lambda, fuzzy-q-lambda, dwa, vfh, apf, tangent-bug" in told
    prose = [line.strip() for line in lines[:options]]
    assert min(len(line) for line, after in pairwise(prose) if line and after) > 50


def test_the_version_is_that_of_the_package_and_the_module_runs_too(installed: Call) -> None:
    assert installed("--version").stdout == f"{__version__}\n"
    module = [sys.executable, "-m", "fuzzyq_bullet", "--version"]
    assert subprocess.run(module, capture_output=True, text=True).stdout == f"{__version__}\n"


@pytest.mark.slow
def test_help_and_mistakes_load_neither_the_physics_nor_the_plots(tmp_path: Path) -> None:
    code = (
        "import sys\n"
        "from fuzzyq_bullet.cli import main\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "print([n for n in ('pybullet', 'matplotlib') if n in sys.modules], file=sys.stderr)\n"
    )
    for args in (["--help"], ["run", "nowhere"], ["validate", "mixed"]):
        command = [sys.executable, "-c", code, *args]
        done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
        assert done.stderr.splitlines()[-1] == "[]"


def test_numpy_is_not_loaded_for_help_nor_scipy_to_know_what_a_scenario_is() -> None:
    code = (
        "import sys, fuzzyq_bullet.cli.app; print('numpy' in sys.modules)\n"
        "import fuzzyq_bullet.scenario; print('scipy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout == "False\nFalse\n"


@pytest.mark.slow
def test_an_output_that_nobody_reads_to_its_end_changes_nothing(
    short: Path, tmp_path: Path
) -> None:
    run = f"run {short} --no-video --json --out {tmp_path}"
    for call in (f"{run} | true", "validate mixed 2>&1 >/dev/null | true", f"{run} >&- 2>&-"):
        script = f'"$0" {call}; echo "${{PIPESTATUS[0]}}"'
        command = ["bash", "-c", script, str(FUZZYQ)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.stdout == "0\n", call
        assert "rror" not in done.stderr


def test_a_full_stdout_is_told_in_one_line(fuzzyq: Call) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([FUZZYQ, "schema"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr == "error: stdout: cannot be written: No space left on device\n"


def test_a_locale_without_the_signs_of_a_page_is_no_reason_to_fail(installed: Call) -> None:
    done = installed("explain", "1", "-0.8", env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_a_progress_bar_is_shown_on_a_terminal_and_gone_at_the_end(
    short: Path, tmp_path: Path
) -> None:
    ours, theirs = pty.openpty()
    command = [FUZZYQ, "run", short, "--no-video", "--out", tmp_path]
    env = {**os.environ, "TERM": "xterm", "COLUMNS": "60"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=theirs, env=env) as process:
        os.close(theirs)
        shown = b""
        try:
            while piece := os.read(ours, 65536):
                shown += piece
        except OSError:  # the other end is closed
            pass
    os.close(ours)
    assert process.returncode == 0
    assert b"driving" in shown
    assert b"m to go" in shown
    # The summary is longer than the terminal is wide, and still one line.
    (summary,) = (line for line in shown.split(b"\r\n") if b"short: goal after" in line)
    assert b"seed 0)" in summary


def test_every_command_explains_itself() -> None:
    commands = "run", "replay", "validate", "schema", "list", "explain", "figure"
    for name in (*commands, "bench speed", "bench escape"):
        shown = CliRunner().invoke(app, [*name.split(), "--help"], prog_name="fuzzyq").stdout
        assert f"Usage: fuzzyq {name}" in shown
        assert "--help" in shown
        assert not re.search("Raises|Args:|UserError", shown)
