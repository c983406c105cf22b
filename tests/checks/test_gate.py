"""No verdict passes by accident: whatever goes wrong is red, and says so.

The scenarios here would pass if what is wrong went unnoticed: they expect no more than that the
robot gets stuck somewhere, half a metre from everything.
"""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from fuzzyq_bullet import Decision, Scenario, run
from fuzzyq_bullet.errors import PlannerError
from fuzzyq_bullet.planning.decision import DecisionError, checked
from fuzzyq_bullet.recording.metrics import result_of
from fuzzyq_bullet.scenario import Expect, parse_scenario
from fuzzyq_bullet.scenario.expectations import unmet_expectations
from tests.helpers.commands import FUZZYQ, Call

PLUGIN = Path(__file__).with_name("planners_gone_wrong.py")

WRONG = """\
name: {how}
start: {{position: [2.0, 5.0]}}
goal: {{position: [8.0, 5.0]}}
arena: {{walls: false}}
drive: {drive}
planner: {{name: wrong, how: {how}}}
limits: {{time: 20.0}}
obstacles: [{{shape: cylinder, position: [5.0, 9.0], radius: 0.2}}]
expect: {{outcome: {outcome}, min_clearance: 0.5}}
"""

WAYS = {
    "nan": "decided the heading nan, which must be from -1e+06 to 1e+06, after 0.00 s",
    "infinite": "decided the heading inf",
    "huge": "decided the heading 1e+300",
    "text": "decided the heading 'left'",
    "step-nan": "decided the step nan, which must be from 0 to 1000",
    "step-infinite": "decided the step inf",
    "backwards": "decided the step -0.2",
    "reach-nan": "decided the reach nan, which must be from 0 to 1e+06 or infinite",
    "reach-negative": "decided the reach -1.0",
    "mode": "decided the mode: no mode 'flying'; did you mean",
    "lines": "explained its decision by the lines [0.0, 1.0], which must be of size 3",
    "rules": "explained its decision by the rules a list of 4, which must be of size 5",
    "weights": "explained its decision by the weights 'a', which is no number",
    "turn": "explained its decision by the turn 1e+300, which is no number",
    "hopeless": "decided hopeless 'perhaps', not True or False",
    "backward": "decided backward 1, not True or False",
    "overflow": "decided the step",
    "cancels": "stopped by CancelledError, after 0.00 s",
    "forks": "returned None instead of a Decision",
    "none": "returned None instead of a Decision",
    "tuple": "returned a tuple instead of a Decision",
    "raises": "stopped by ValueError: no idea ::error::where to go, after 0.00 s",
    "unspeakable": "stopped by UnspeakableError, after 0.00 s",
    "exits": "tried to exit, after 0.00 s",
    "interrupts": "stopped by KeyboardInterrupt, after 0.00 s",
    "recursion": "stopped by RecursionError: maximum recursion depth exceeded",
    "senses-nan": "stopped by ValueError: a heading must be a finite number, got nan",
    "senses-text": "stopped by ValueError: a heading must be a finite number, got 'ahead'",
    "looks-nan": "stopped by ValueError: a heading must be a finite number, got inf",
    "looks-too-far": "stopped by ValueError: 20000 headings at once; at most 1000 are allowed",
    "built-none": "was built as a NoneType, which has no method decide",
    "built-exit": "tried to exit, while it was built",
    "built-raise": "stopped by RuntimeError: out of order, while it was built",
}
"""What each planner is told to do wrong, and what is said of it."""
PROCESSES = {
    "memory": "ran out of the memory that it may use (--memory)",
    "dies": "its process ended by itself, with exit code 0",
    "hangs": "cut after 4 s of wall-clock time",
}


def written(folder: Path, how: str, *, outcome: str = "stuck", drive: str = "kinematic") -> Path:
    path = folder / f"{how}.yaml"
    path.write_text(WRONG.format(how=how, outcome=outcome, drive=drive))
    return path


@pytest.fixture(scope="module")
def checked_all(fuzzyq: Call, tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict]:
    """The verdicts of one check over all of them, and over a scenario that is well."""
    folder = tmp_path_factory.mktemp("gate")
    for how in (*WAYS, *PROCESSES):
        written(folder, how)
    (folder / "well.yaml").write_text(
        "name: well\nstart: {position: [2, 5]}\ngoal: {position: [3, 5]}\n"
    )
    done = fuzzyq(
        "check", folder, "--plugin", PLUGIN, "--timeout", 4, "--json", "--junit", folder / "j.xml"
    )
    assert done.returncode == 1
    told = json.loads(done.stdout)
    assert (told["passed"], told["broken"]) == (1, len(WAYS) + len(PROCESSES))
    suite = ET.parse(folder / "j.xml").getroot()[0]
    assert int(suite.attrib["errors"]) == len(WAYS) + len(PROCESSES)
    return {one["name"]: one for one in told["scenarios"]}


@pytest.mark.slow
@pytest.mark.parametrize("how", [*WAYS, *PROCESSES])
def test_a_check_fails_what_a_planner_does_wrong_and_says_so(
    how: str, checked_all: dict[str, dict]
) -> None:
    verdict = checked_all[how]
    said = WAYS.get(how) or PROCESSES[how]
    assert verdict["status"] == "broken"
    assert said in verdict["why"][0]
    if how in WAYS:
        assert verdict["why"][0].startswith("planner wrong: ")
        assert f"{PLUGIN}:" in verdict["why"][0] or how == "built-none"


@pytest.mark.slow
def test_the_others_go_on(checked_all: dict[str, dict]) -> None:
    assert checked_all["well"]["status"] == "passed"


@pytest.mark.parametrize(
    ("how", "drive"),
    [("backwards", "wheels"), ("exits", "kinematic"), ("interrupts", "wheels")],
)
def test_a_run_ends_with_one_line_and_leaves_nothing(
    how: str, drive: str, fuzzyq: Call, tmp_path: Path
) -> None:
    path = written(tmp_path, how, drive=drive)
    done = fuzzyq("run", path, "--plugin", PLUGIN, "--json", "--out", tmp_path / "out")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"error: planner wrong: {WAYS[how]}")
    assert done.stderr.count("\n") == 1
    assert list((tmp_path / "out").iterdir()) == []


def test_the_line_names_the_place_in_the_users_own_file(tmp_path: Path) -> None:
    def lost(self: object, observation: object) -> Decision:
        raise LookupError("somewhere")

    line = lost.__code__.co_firstlineno + 1
    scenario = parse_scenario(SIMPLE)
    with pytest.raises(PlannerError, match=rf"\({__file__}:{line}, in lost\)$"):
        run_with(type("Own", (), {"decide": lost})(), scenario)


SIMPLE = "name: simple\nstart: {position: [2, 5]}\ngoal: {position: [8, 5]}\ndrive: kinematic\n"


def run_with(planner: object, scenario: Scenario) -> None:
    from fuzzyq_bullet.episode import run_in
    from fuzzyq_bullet.physics.sensor_world import SensorWorld

    with SensorWorld(scenario.obstacles, scenario.arena) as world:
        run_in(world, scenario, planner)  # type: ignore[arg-type]


def test_ctrl_c_while_a_planner_thinks_is_the_persons_own() -> None:
    def interrupted(self: object, observation: object) -> Decision:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_with(type("Own", (), {"decide": interrupted})(), parse_scenario(SIMPLE))


def test_what_is_told_of_a_decision_cannot_be_changed_afterwards() -> None:
    lengths = [1.0, 2.0, 3.0]
    decision = checked(Decision(heading=0.0, step=0.1, lengths=lengths))
    lengths[0] = 9.0
    assert decision.lengths == (1.0, 2.0, 3.0)


def test_whole_numbers_and_those_of_numpy_are_numbers() -> None:
    import numpy as np

    decision = Decision(heading=np.float32(0.5), step=1, reach=np.int64(2), near=np.zeros(5))
    assert checked(decision).near == (0.0,) * 5
    with pytest.raises(DecisionError, match="heading"):
        checked(Decision(heading=np.zeros(2), step=1))


JUMP = """\
name: jump
start: {position: [2, 5]}
goal: {position: [22, 5]}
arena: {size: [40, 10]}
drive: kinematic
obstacles: [{shape: cylinder, position: [9, 5.45], radius: 0.2}]
"""


def test_a_jump_is_as_near_to_things_as_its_whole_way() -> None:
    class Jumper:
        def decide(self, observation: object) -> Decision:
            return Decision(heading=0.0, step=20.0)

    from fuzzyq_bullet.episode import run_in
    from fuzzyq_bullet.physics.sensor_world import SensorWorld

    scenario = parse_scenario(JUMP)
    with SensorWorld(scenario.obstacles, scenario.arena) as world:
        result = result_of(run_in(world, scenario, Jumper()))  # type: ignore[arg-type]
    assert (result.outcome, result.steps, result.min_clearance_m) == ("goal", 1, 0.05)
    assert unmet_expectations(Expect(min_clearance=0.06), result)


def test_a_planner_that_ends_the_process_of_a_run_is_no_success(
    fuzzyq: Call, tmp_path: Path
) -> None:
    path = written(tmp_path, "dies")
    done = fuzzyq("run", path, "--plugin", PLUGIN, "--json", "--out", tmp_path / "out")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "error: nothing came of it: its process ended by itself, with exit code 0\n"
    )


# Plugins


@pytest.mark.parametrize(
    ("at_end", "more", "status"), [("", "", 0), ("os._exit, 0", "expect: {max_time: 1}", 1)]
)
def test_what_a_plugin_does_at_the_end_changes_no_verdict(
    at_end: str, more: str, status: int, fuzzyq: Call, tmp_path: Path
) -> None:
    (tmp_path / "p.py").write_text(f"import atexit, os\natexit.register({at_end or 'print'})\n")
    (tmp_path / "s.yaml").write_text(SIMPLE + more)
    done = fuzzyq("check", "s.yaml", "--plugin", "p.py", cwd=tmp_path)
    assert done.returncode == status


FOR_EVER = "threading.Event().wait"


@pytest.mark.slow
@pytest.mark.parametrize(
    "plugin",
    [f"threading.Thread(target={FOR_EVER}).start()", f"atexit.register({FOR_EVER})"],
    ids=["a thread", "a function at the end"],
)
def test_a_plugin_that_never_ends_keeps_no_verdict(
    plugin: str, installed: Call, tmp_path: Path
) -> None:
    (tmp_path / "p.py").write_text(f"import atexit, threading\n{plugin}\n")
    (tmp_path / "s.yaml").write_text(SIMPLE + "expect: {max_time: 1}\n")
    done = installed("check", "s.yaml", "--plugin", "p.py", cwd=tmp_path, timeout=30)
    assert (done.returncode, done.stdout[:4]) == (1, "FAIL")
    wrong = installed("run", "nowhere", "--plugin", "p.py", cwd=tmp_path, timeout=30)
    assert (wrong.returncode, wrong.stderr[:6]) == (2, "error:")


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="Windows has other signals")
def test_an_interrupt_reaches_a_command_with_plugins(tmp_path: Path) -> None:
    (tmp_path / "p.py").write_text("import time\nprint('loading', flush=True)\ntime.sleep(60)\n")
    process = subprocess.Popen(
        [FUZZYQ, "run", "boxes", "--plugin", "p.py"],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    assert process.stderr.readline() == "loading\n"
    process.send_signal(signal.SIGTERM)
    assert process.communicate()[1] == "error: interrupted\n"
    assert process.returncode == 143


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("import sys; sys.exit(0)", "tried to exit"),
        ("raise KeyboardInterrupt", "KeyboardInterrupt"),
        ("raise SystemExit", "tried to exit"),
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("def", "SyntaxError"),
        ("import fuzzyq_bullet; fuzzyq_bullet.register_planner('a/b', None, None)", "named 'a/b'"),
    ],
)
@pytest.mark.parametrize(
    "command",
    [
        ("run", "boxes"),
        ("check", "boxes"),
        ("validate", "boxes"),
        ("bench", "escape"),
        ("bench", "success"),
        ("bench", "steps"),
        ("train", "q-learning"),
        ("figure", "4"),
    ],
    ids=" ".join,
)
def test_a_plugin_that_fails_or_exits_is_one_line(
    text: str, said: str, command: tuple[str, ...], inside: Call, tmp_path: Path
) -> None:
    from fuzzyq_bullet.errors import UserError

    (tmp_path / "gone_wrong.py").write_text(text)
    before = _without_ctrl_c()
    try:
        with pytest.raises(
            UserError, match=f"--plugin: gone_wrong.py cannot be imported: .*{said}"
        ):
            inside(*command, "--plugin", "gone_wrong.py", cwd=tmp_path)
    finally:
        before()
    left = {path.name for path in tmp_path.iterdir()}
    assert left - {"__pycache__"} == {"gone_wrong.py"}


def _without_ctrl_c():
    """Make it as it is on the command line: an interrupt is no KeyboardInterrupt there."""
    import signal

    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    return lambda: signal.signal(signal.SIGINT, before)


def test_a_plugin_that_exits_drives_nothing_and_is_no_success(fuzzyq: Call, tmp_path: Path) -> None:
    (tmp_path / "p.py").write_text("import sys\nsys.exit(0)\n")
    for command in (("check", "boxes", "--junit", "j.xml"), ("run", "boxes")):
        done = fuzzyq(*command, "--plugin", "p.py", cwd=tmp_path)
        assert done.returncode == 2
        assert done.stderr == "error: --plugin: p.py cannot be imported: it tried to exit\n"
    assert not (tmp_path / "j.xml").exists()


CHATTY = """\
import atexit
from typing import Literal
from fuzzyq_bullet import Decision, PlannerSettings, register_planner
print("loaded")
atexit.register(print, "bye")
class Settings(PlannerSettings):
    name: Literal["chatty"] = "chatty"
class Chatty:
    def decide(self, observation):
        print("thinking")
        return Decision(heading=0.0, step=0.2)
register_planner("chatty", Settings, lambda settings, rng: Chatty())
"""


@pytest.mark.parametrize("command", ["run", "check"])
def test_what_a_plugin_prints_does_not_get_into_the_json(
    command: str, fuzzyq: Call, tmp_path: Path
) -> None:
    (tmp_path / "chatty.py").write_text(CHATTY)
    (tmp_path / "s.yaml").write_text(SIMPLE)
    options = ("--planner", "chatty", "--plugin", "chatty.py", "--json")
    video = ("--no-video",) if command == "run" else ()
    done = fuzzyq(command, "s.yaml", *options, *video, cwd=tmp_path)
    assert done.returncode == 0
    json.loads(done.stdout)
    told = {"loaded", "bye"} | ({"thinking"} if command == "run" else set())
    assert told <= set(done.stderr.splitlines())


def test_a_plugin_takes_the_place_of_no_other_module(fuzzyq: Call, tmp_path: Path) -> None:
    (tmp_path / "pm").mkdir()
    names = ("io", "json", "types", "numpy", "conftest")
    for name in names:
        (tmp_path / "pm" / f"{name}.py").write_text(CHATTY.replace("chatty", f"c-{name}"))
    (tmp_path / "s.yaml").write_text(SIMPLE)
    options = [word for name in names for word in ("--plugin", f"pm/{name}.py")]
    done = fuzzyq("check", "s.yaml", "--planner", "c-numpy", *options, cwd=tmp_path)
    assert done.returncode == 0, done.stderr


# Expectations


@pytest.mark.parametrize("clearance", [None, math.nan, -0.001, 0.0999])
def test_a_clearance_that_is_missing_or_no_number_or_negative_meets_nothing(
    clearance: float | None,
) -> None:
    result = result_of(run(parse_scenario(SIMPLE)))
    result = result.model_copy(update={"min_clearance_m": clearance})
    assert len(unmet_expectations(Expect(min_clearance=0.1), result)) == 1
    assert unmet_expectations(Expect(), result) == []


def test_a_time_that_is_no_number_meets_nothing() -> None:
    result = result_of(run(parse_scenario(SIMPLE))).model_copy(update={"time_s": math.nan})
    assert len(unmet_expectations(Expect(max_time=100.0), result)) == 1


@pytest.mark.usefixtures("in_this_process")
def test_with_nothing_to_keep_clear_of_a_clearance_is_not_met(inside: Call, tmp_path: Path) -> None:
    text = SIMPLE + "arena: {walls: false}\nexpect: {min_clearance: 0.0}\n"
    (tmp_path / "s.yaml").write_text(text)
    done = inside("check", tmp_path / "s.yaml")
    assert done.returncode == 1
    assert "no clearance, as there is nothing to keep clear of" in done.stdout


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_an_overlap_is_a_negative_clearance(drive: str) -> None:
    text = SIMPLE.replace("kinematic", drive) + "planner: {name: fuzzy}\nobstacles:\n"
    text += "  - {shape: box, position: [5, 5], size: [0.3, 4]}\n"
    trajectory = run(parse_scenario(text))
    assert trajectory.outcome == "collision"
    assert -1e-3 < trajectory.ticks.clearance.min() < (0.0 if drive == "wheels" else 1e-9)


@pytest.mark.usefixtures("in_this_process")
def test_nothing_to_drive_is_no_success(inside: Call, tmp_path: Path) -> None:
    from fuzzyq_bullet.errors import UserError

    (tmp_path / "empty").mkdir()
    os.mkfifo(tmp_path / "fifo.yaml")
    (tmp_path / "dead.yaml").symlink_to("nowhere")
    (tmp_path / "well.yaml").write_text(SIMPLE)
    for what in ("empty", "fifo.yaml", "dead.yaml", "*.scenario.yaml", ""):
        with pytest.raises(UserError):
            inside("check", what, cwd=tmp_path)
    # The one that is sound is driven, and the others are mistakes nevertheless.
    assert inside("check", "*.yaml", cwd=tmp_path).returncode == 2


def test_a_folder_that_is_linked_is_looked_into_once() -> None:
    import tempfile

    from fuzzyq_bullet.checks.plan import discover

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "real").mkdir()
        (folder / "real" / "a.yaml").write_text(SIMPLE)
        (folder / "real" / "back").symlink_to("..")
        (folder / "tests").mkdir()
        (folder / "tests" / "link").symlink_to("../real")
        found = discover([str(folder / "tests")])
        assert [file.name for file in found.files] == ["a.yaml"]
        assert found.problems == []


@pytest.mark.parametrize(
    ("command", "field", "said"),
    [
        ("check", "    gains: object = object()", "its settings cannot be written as JSON"),
        (
            "run",
            "    @pydantic.field_validator('how')\n"
            "    def _no(cls, value): raise RuntimeError('no')",
            "its settings cannot be made: RuntimeError: no",
        ),
    ],
)
def test_settings_that_fail_are_one_line(
    command: str, field: str, said: str, fuzzyq: Call, tmp_path: Path
) -> None:
    (tmp_path / "odd.py").write_text(
        "import pydantic\nfrom typing import Literal\n"
        "from fuzzyq_bullet import PlannerSettings, register_planner\n"
        "class Odd(PlannerSettings):\n"
        "    model_config = pydantic.ConfigDict(arbitrary_types_allowed=True)\n"
        f"    name: Literal['odd'] = 'odd'\n    how: str = ''\n{field}\n"
        "register_planner('odd', Odd, lambda settings, rng: None)\n"
    )
    (tmp_path / "s.yaml").write_text(SIMPLE + "planner: {name: odd, how: x}\n")
    done = fuzzyq(command, "s.yaml", "--plugin", "odd.py", cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert "Traceback" not in done.stderr
