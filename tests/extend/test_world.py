"""Shape, robot, motion, layout, importer of a user's own: each is one file that works at once."""

from __future__ import annotations

import inspect
import json
import textwrap
from pathlib import Path

import numpy as np
import pytest

from fuzzyq_bullet import UserError, load_scenario, register_planner
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.robots import register_robot
from fuzzyq_bullet.scenario import register_expectation
from fuzzyq_bullet.scenario.importers import register_importer
from fuzzyq_bullet.scenario.layouts import register_layout
from fuzzyq_bullet.sensors import register_sensor
from fuzzyq_bullet.shapes import register_motion, register_shape
from fuzzyq_bullet.studies import register_study
from fuzzyq_bullet.video import register_panel
from tests.helpers.commands import Call

EXTEND = Path(__file__).parents[2] / "examples" / "extend"
ROOM = """\
name: room
arena: {size: [3.0, 2.0]}
start: {position: [0.6, 0.6]}
goal: {position: [1.8, 0.7]}
"""


@pytest.fixture
def room(tmp_path: Path) -> Path:
    return tmp_path / "room.yaml"


@pytest.mark.slow
def test_a_shape_is_validated_driven_around_filmed_and_checked(
    fuzzyq: Call, inside: Call, room: Path
) -> None:
    plugin = ("--plugin", EXTEND / "shape.py")
    room.write_text(
        ROOM + "obstacles:\n"
        "  - {shape: pillar, position: [1.2, 0.4], radius: 0.2}\n"
        "  - {shape: pillar, position: [2.3, 1.4], radius: 0.3, sides: 3, yaw: 0.4}\n"
    )
    with pytest.raises(UserError, match="no shape 'pillar'; allowed: cylinder, box"):
        inside("validate", room)
    done = fuzzyq("run", room, *plugin, "--out", room.parent, "--json", "--speed", 8)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["outcome"] == "goal"
    assert 0.0 < told["min_clearance_m"] < 0.2  # it had to go round something
    assert 1.02 < told["shortest_path_m"] <= told["path_length_m"]
    assert (room.parent / "room-8x.mp4").stat().st_size > 10_000
    assert fuzzyq("check", room, *plugin).returncode == 0
    with pytest.raises(UserError) as missing:
        inside("replay", room.parent / "room.npz")
    assert missing.value.problems == (
        f"{room.parent}/room.npz: made with the shape 'pillar', not known here; "
        "--plugin FILE adds it",
    )

    room.write_text(room.read_text().replace("sides: 3", "sides: 2"))
    wrong = fuzzyq("validate", room, *plugin)
    assert "room.yaml:7: obstacles[1].sides: must be at least 3, got 2" in wrong.stderr


@pytest.mark.slow
def test_a_robot_drives_by_its_own_radius_and_limits(
    fuzzyq: Call, inside: Call, room: Path
) -> None:
    plugin = ("--plugin", EXTEND / "robot.py")
    # A gap of 0.38 m: the default robot, 0.4 m wide, cannot pass.
    room.write_text(
        ROOM + "robot: {model: mouse}\nobstacles:\n"
        "  - {shape: box, position: [1.2, 0.205], size: [0.2, 0.41]}\n"
        "  - {shape: box, position: [1.2, 1.395], size: [0.2, 1.21]}\n"
    )
    unknown = "room.yaml:5: robot.model: no robot 'mouse'; allowed: fuzzyq"
    with pytest.raises(UserError, match=unknown):
        inside("validate", room)

    done = fuzzyq("run", room, *plugin, "--out", room.parent, "--json", "--speed", "8")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["outcome"] == "goal"
    assert 0.0 < told["min_clearance_m"] <= 0.04
    record = np.load(room.parent / "room.npz")
    speeds = record["ticks.speed"] if "ticks.speed" in record else record["speed"]
    assert 0.3 < speeds.max() <= 0.42
    lengths = next(record[name] for name in record.files if name.endswith("lengths"))
    assert lengths.max() <= 0.75 + 1e-9  # 5·S_p
    with pytest.raises(UserError, match=r"npz: made with the robot 'mouse', .* --plugin FILE"):
        inside("replay", room.parent / "room.npz")

    room.write_text(room.read_text().replace("{model: mouse}", "{model: fuzzyq}"))
    assert "there is no way from the start" in inside("validate", room).stderr


def test_a_motion_is_known_and_its_keys_are_checked(fuzzyq: Call, room: Path) -> None:
    plugin = ("--plugin", EXTEND / "motion.py")
    box = "obstacles:\n  - {shape: box, position: [2.4, 1.4], size: [0.3, 0.2], motion: {MOTION}}\n"
    cases = [
        ("kind: still", 0, "ok"),
        ("kind: swing, angle: 0.0", 0, "ok"),
        ("kind: swing, angle: 0.5", 0, "ok"),
        ("kind: swing, angle: -0.5", 0, "ok"),
        ("kind: swing", 2, "obstacles[0].motion.angle: is required"),
        ("kind: swin, angle: 0.0", 2, "motion.kind: no kind 'swin'; did you mean 'swing'?"),
    ]
    files = [room.with_name(f"{i}.yaml") for i in range(len(cases))]
    for file, (motion, _, _) in zip(files, cases, strict=True):
        file.write_text(ROOM + box.replace("MOTION", motion))
    told = fuzzyq("validate", *files, *plugin)
    assert told.returncode == 2
    lines = (told.stdout + told.stderr).splitlines()
    for file, (_, code, words) in zip(files, cases, strict=True):
        [line] = [line for line in lines if f"{file}:" in line]
        assert words in line
        assert line.startswith("error: ") is (code == 2)


BROKEN = """
@register_motion
class Broken{number}(Motion):
    kind: Literal["broken-{number}"]
    def pose(self, time):
        return {pose}
    def top_speed(self, obstacle):
        return {speed}
"""


def test_a_motion_that_is_wrong_is_one_line(inside: Call, room: Path) -> None:
    need, say = (
        "must return Pose(x, y, yaw), three numbers below 1e+07",
        "must return a speed (m/s) or",
    )
    cases = [
        ("1", None, f"pose(0) {need}, not 1"),
        ("(0.0, 0.0)", None, f"pose(0) {need}, not [0.0, 0.0]"),
        ("Pose(float('nan'), 0, 0)", None, f"pose(0) {need}, not [nan, 0, 0]"),
        ("Pose(0, 0, 0) if time < 2 else None", None, f"pose(2) {need}, not nothing"),
        ("1 / 0", None, "stopped by ZeroDivisionError: division by zero, in pose(0)"),
        ("Pose(0, 0, 0)", "'fast'", f"top_speed {say} None, not 'fast'"),
        ("Pose(0, 0, 0)", "float('nan')", f"top_speed {say} None, not nan"),
        ("Pose(0, 0, 0)", "-1.0", f"top_speed {say} None, not -1.0"),
        ("Pose(0, 0, 0)", "1 / 0", "stopped by ZeroDivisionError: division by zero, in top_speed"),
        ("Pose(0.2 * time, 0, 0)", "0.1", "moves at 0.20 m/s, but its top_speed is 0.10 m/s"),
        ("Pose(0.2 * time, 0, 0)", "0.2", None),
    ]
    plugin = "from typing import Literal\nfrom fuzzyq_bullet.shapes import *\n"
    room.write_text(f"{ROOM}obstacles:\n")
    with room.open("a") as file:
        for number, (pose, speed, _) in enumerate(cases):
            plugin += BROKEN.format(number=number, pose=pose, speed=speed)
            where = f"shape: box, position: [2.4, 1.4], size: [0.3, {0.1 + number / 100}]"
            file.write(f"  - {{{where}, motion: {{kind: broken-{number}}}}}\n")
    room.with_name("broken.py").write_text(plugin)
    with pytest.raises(UserError) as told:
        inside("validate", room, "--plugin", room.with_name("broken.py"))
    lines = dict(line.split(".motion: ") for line in told.value.problems)
    for number, (_, _, words) in enumerate(cases):
        line = lines.get(f"{room}:{6 + number}: obstacles[{number}]")
        if "division" in (words or ""):  # which says where, too
            assert line.startswith(
                f"motion broken-{number}: {words} ({room.with_name('broken.py')}:"
            )
        else:
            assert line in (words, f"motion broken-{number}: {words}")


def test_a_motion_that_is_not_there_is_named_by_a_record(filmed: Path, tmp_path: Path) -> None:
    arrays = dict(np.load(filmed / "short.npz"))
    meta = json.loads(str(arrays["meta"]))
    for obstacle in meta["scenario"]["obstacles"]:
        obstacle["motion"] = {"kind": "swing", "angle": 0.0}
    meta["scenario"]["robot"]["model"] = "mouse"
    path = tmp_path / "short.npz"
    np.savez(path, **{**arrays, "meta": np.array(json.dumps(meta))})
    with pytest.raises(UserError, match="made with the robot 'mouse' and the motion 'swing', not"):
        Trajectory.load(path)


def test_a_layout_is_drawn_from_the_seed(fuzzyq: Call, inside: Call, room: Path) -> None:
    room.write_text(ROOM + "random: {layout: orchard, spacing: 0.9}\n")
    plugin = ("--plugin", EXTEND / "layout.py")
    done = fuzzyq("run", room, *plugin, "--out", room.parent, "--no-video", "--json")
    assert done.returncode == 0, done.stderr
    record = Trajectory.load(room.parent / "room.npz")
    assert 3 <= len(record.scenario.obstacles) <= 6  # and the layout is needed no more
    with pytest.raises(UserError, match="no layout 'orchard'"):
        inside("validate", room)


def test_an_importer_makes_a_scenario_file(fuzzyq: Call, tmp_path: Path) -> None:
    table = tmp_path / "forest.csv"
    table.write_text("0.5,0.5,0.2\n1.5,1.4,0.3\n2.5,0.6,0.25\n")
    plugin = ("--plugin", EXTEND / "importer.py")
    assert "no importer for the suffix '.csv'" in fuzzyq("import", table).stderr
    done = fuzzyq("import", table, *plugin, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "forest.yaml\n"), done.stderr
    scenario = load_scenario(tmp_path / "forest.yaml")
    assert scenario.goal.position == (2.5, 0.6)
    assert [one.shape for one in scenario.obstacles] == ["cylinder"]

    again = fuzzyq("import", table, *plugin, cwd=tmp_path)
    assert again.returncode == 2
    assert "is there already" in again.stderr
    table.write_text("0.5,0.5,0.2\n1.5,x,0.3\n")
    wrong = fuzzyq("import", table, *plugin, "--out", tmp_path / "other.yaml")
    assert "forest.csv:2: expected x,y,radius" in wrong.stderr
    assert not (tmp_path / "other.yaml").exists()


def test_a_scenario_file_is_imported_as_itself_and_never_replaced(
    inside: Call, short: Path, tmp_path: Path
) -> None:
    inside("import", short, "--out", tmp_path / "copy.yaml")
    assert load_scenario(tmp_path / "copy.yaml") == load_scenario(short)
    with pytest.raises(Exception, match="is an input of this command"):
        inside("import", short, "--out", short, "--replace")


REGISTRIES = (
    *(register_planner, register_robot, register_expectation, register_importer, register_layout),
    *(register_sensor, register_motion, register_shape, register_study, register_panel),
)


def test_the_example_of_each_registry_can_be_copied(fuzzyq: Call, room: Path) -> None:
    plugins: list[object] = []
    for registry in REGISTRIES:
        lines = inspect.getdoc(registry).split("\n")
        first = next(i for i, line in enumerate(lines) if line.lstrip().startswith("from "))
        indent = len(lines[first]) - len(lines[first].lstrip())
        code = lines[first:]
        last = next((i for i, line in enumerate(code) if line[:indent].strip()), len(code))
        path = room.with_name(f"{registry.__name__}_example.py")
        path.write_text(textwrap.dedent("\n".join(code[:last])))
        plugins += ["--plugin", path]
    room.write_text(
        ROOM.replace("[3.0, 2.0]", "[8.0, 4.0]")
        + "random: {layout: row, count: 3}\n"
        + "robot: {model: mouse}\n"
        + "sensor: {model: rounded, step: 0.1}\n"
        + "planner: {name: my-planner, speed: 0.4}\n"
        + "expect: {max_turning: 20}\n"
    )
    done = fuzzyq("validate", room, *plugins)
    assert done.returncode == 0, done.stderr
