"""Maps of other programs become scenarios in the same coordinates; what is left out is named."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from fuzzyq_bullet import UserError, load_scenario
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.scenario.importers import import_map, options_of
from tests.helpers.commands import Call

MAPS = Path(__file__).parent / "maps"
WORLD = '<sdf version="1.7"><world name="w">{}</world></sdf>'
MODEL = '<model name="{name}"><static>1</static><pose>{pose}</pose>{more}{link}</model>'
LINK = '<link name="l"><collision name="c">{pose}<geometry>{solid}</geometry></collision></link>'
BOX = "<box><size>1 0.4 0.5</size></box>"
POST = "<cylinder><radius>0.3</radius><length>2</length></cylinder>"
CAPSULE = "<capsule><radius>0.3</radius><length>1</length></capsule>"
APART = options_of(start="-8,-8", goal="8,8")


def world(tmp_path: Path, solid: str, pose: str = "0 0 0 0 0 0", inner: str = "") -> Path:
    """A world of one solid, and two posts far from it that make room."""
    post = "<box><size>0.2 0.2 1</size></box>"
    models = [
        MODEL.format(name="m", pose=pose, more="", link=LINK.format(pose=inner, solid=solid)),
        *(
            MODEL.format(
                name=at, pose=f"{at} {at} 0 0 0 0", more="", link=LINK.format(pose="", solid=post)
            )
            for at in ("-9", "9")
        ),
    ]
    path = tmp_path / "a.world"
    path.write_text(WORLD.format("".join(models)))
    return path


def test_a_house_of_gazebo_is_read_with_what_stands_in_it() -> None:
    found = import_map(MAPS / "house.world", options_of(start="-3.5,-3.4", goal="4.4,1.2"))
    field = Field.of(found.scenario.obstacles)
    assert field.clearance([(-1.0, -3.0)])[0] < 0.0  # a wall
    assert field.clearance([(-1.45 - 1.0, 0.4)])[0] > 0.3  # a doorway, in spite of its step
    leg = (
        -3.2 + 0.55 * math.cos(0.3) - 0.3 * math.sin(0.3),
        -2.4 + 0.55 * math.sin(0.3) + 0.3 * math.cos(0.3),
    )
    assert field.clearance([leg])[0] == pytest.approx(-0.03)  # of a table that is included, turned
    assert field.clearance([(-3.2, -2.4)])[0] > 0.3  # under the board there is room
    assert field.clearance([(1.6, -2.3)])[0] == pytest.approx(
        -0.5 * math.cos(math.pi / 6), abs=1e-3
    )
    assert found.left_out == (
        "lights: nothing to run into: sun",
        "plugins: programs of Gazebo: physics",
        "what is above the robot, 0.15 m high: walls/outer/ceiling, kitchen_table/top/board, "
        "desk/top/board",
        "what lies on the ground or below: walls/inner/doorstep",
        "includes that do not lie beside the file: model://sofa",
    )
    assert found.changed == (
        "models that can be pushed in Gazebo stand still here: lamp, ball",
        "parts of meshes are their convex outlines at the robot's height: column/link/stone",
    )


@pytest.mark.parametrize(
    ("solid", "pose", "inside", "outside"),
    [
        (BOX, "1 2 0 0 0 1.5707963", [(1.19, 2.49)], [(1.21, 2.0), (1.0, 2.51)]),
        (BOX, "1 2 0 0 1.5707963 0", [(1.24, 2.19)], [(1.26, 2.0), (1.0, 2.21)]),  # on its end
        # A plank of 1 m leans at 45°: at the robot's height only its foot is there.
        (BOX.replace("0.5", "0.02"), "0 0 0.35 0 -0.7853981 0", [(-0.3, 0.0)], [(0.0, 0.0)]),
        ("<sphere><radius>0.5</radius></sphere>", "0 0 0.5 0 0 0", [(0.356, 0.0)], [(0.358, 0.0)]),
        (POST, "0 0 1 0 0 0", [(0.29, 0.0)], [(0.31, 0.0)]),
        (POST, "0 0 0 1.5707963 0 0", [(0.29, 0.99)], [(0.31, 0.0), (0.0, 1.01)]),
        (CAPSULE, "0 0 0 0 1.5707963 0", [(0.78, 0.0)], [(0.82, 0.0)]),
        (
            "<polyline><point>0 0</point><point>2 0</point><point>2 2</point><point>1 0.5</point>"
            "<height>1</height></polyline>",
            "1 1 0 0 0 0",
            [(2.9, 2.5)],
            [(1.9, 2.4)],
        ),
    ],
)  # fmt: skip
def test_solids_are_cut_at_the_height_of_the_robot(
    tmp_path: Path,
    solid: str,
    pose: str,
    inside: list[tuple[float, float]],
    outside: list[tuple[float, float]],
) -> None:
    found = import_map(world(tmp_path, solid, pose), APART)
    field = Field.of(found.scenario.obstacles)
    assert field.clearance(inside).max() < 0.0
    assert field.clearance(outside).min() > 0.0
    assert found.left_out == ()


def test_poses_may_be_relative_to_frames_in_degrees_or_quaternions(tmp_path: Path) -> None:
    half = math.sqrt(0.5)
    more = (
        '<frame name="f" attached_to="g"><pose degrees="true">1 0 0 0 0 90</pose></frame>'
        f'<frame name="g"><pose rotation_format="quat_xyzw">0 1 0 0 0 {half} {half}</pose></frame>'
    )
    inner = '<pose relative_to="f">0.5 0 0 0 0 0</pose>'
    solid = "<cylinder><radius>0.1</radius><length>1</length></cylinder>"
    link = LINK.format(pose=inner, solid=solid)
    path = tmp_path / "a.sdf"
    path.write_text(
        '<sdf version="1.7">'
        + MODEL.format(name="m", pose="3 0 0 0 0 0", more=more, link=link)
        + "</sdf>"
    )
    found = import_map(path, options_of(start="2.5,1", goal="2.5,3"))
    # g: at (0, 1), turned by 90°; f: 1 m along its x, turned again; the part is 0.5 m further back.
    (post,) = found.scenario.obstacles
    assert post.position == pytest.approx((2.5, 2.0))


def test_what_a_world_has_thin_is_grown_and_named(tmp_path: Path) -> None:
    found = import_map(world(tmp_path, "<box><size>1 0.005 1</size></box>"), APART)
    assert found.changed == ("what is thinner than 0.02 m is grown to that: m/l/c",)
    assert found.scenario.obstacles[0].thickness() == pytest.approx(0.02)


@pytest.mark.filterwarnings("ignore::DeprecationWarning:collada.*")
@pytest.mark.filterwarnings("ignore::ResourceWarning")
def test_a_collada_mesh_keeps_its_unit_and_its_axis_upwards(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    block = trimesh.creation.box((300, 40, 100))  # centimetres; y is up
    block.export(tmp_path / "block.dae")
    text = (tmp_path / "block.dae").read_text()
    text = text.replace("<up_axis>", '<unit name="centimeter" meter="0.01"/><up_axis>')
    (tmp_path / "block.dae").write_text(text)
    path = world(tmp_path, "<mesh><uri>block.dae</uri></mesh>")
    field = Field.of(import_map(path, APART).scenario.obstacles)
    inside = field.clearance([(1.49, 0.0), (0.0, 0.49), (1.51, 0.0), (0.0, 0.51)]) < 0.0
    assert inside.tolist() == [True, True, False, False]


def test_a_task_of_movingai_names_its_map_start_and_goal() -> None:
    found = import_map(MAPS / "cave.map.scen", options_of(number=2, resolution=0.5))
    scenario = found.scenario
    assert scenario.start.position == (0.75, 0.75)  # column 1, row 8 of 10 from the top
    assert scenario.goal.position == (5.25, 4.25)
    assert scenario.arena.size == (6.0, 5.0)
    field = Field.of(scenario.obstacles)
    assert field.clearance([(2.75, 3.75)])[0] < 0.0  # column 5, row 2 from the top: @
    assert field.clearance([(2.75, 3.25)])[0] > 0.0  # row 3: the gap in the wall
    assert "1 cells of swamp (S): taken as free" in found.changed
    assert "2 cells of water (W): taken as blocked" in found.changed
    with pytest.raises(UserError, match=r"--number: .* has the tasks 1 to 2, not 3"):
        import_map(MAPS / "cave.map.scen", options_of(number=3))


def test_a_world_of_ir_sim_brings_start_goal_and_obstacles() -> None:
    found = import_map(MAPS / "irsim.yaml")
    scenario = found.scenario
    assert (scenario.start.position, scenario.start.heading) == ((1.0, 1.0), 0.0)
    assert scenario.goal.position == (9.0, 9.0)
    shapes = [one.shape for one in scenario.obstacles]
    assert shapes == ["cylinder", "box", "polygon", "polygon", "polygon"]
    assert (
        found.left_out[-1]
        == "line 17 obstacle[4].distribution: drawn by chance, so not in the file"
    )


def test_options_win_over_the_map_and_reach_own_scenarios_too() -> None:
    asked = options_of(start="2,1,0.5", goal="8.5,9")
    found = import_map(MAPS / "irsim.yaml", asked).scenario
    assert (found.start.position, found.start.heading) == ((2.0, 1.0), 0.5)
    assert found.goal.position == (8.5, 9.0)
    own = import_map(Path("scenarios/boxes.yaml"), options_of(goal="9,6")).scenario
    assert own.goal.position == (9.0, 6.0)
    assert own.obstacles == load_scenario("boxes").obstacles


def test_without_start_and_goal_two_places_are_named_that_can_be_driven_between() -> None:
    with pytest.raises(UserError) as raised:
        import_map(MAPS / "lab.yaml")
    (line,) = raised.value.problems
    assert "has no start and goal; give --start X,Y --goal X,Y. There is room for example" in line
    words = line.split()
    start, goal = words[words.index("example") + 3], words[words.index("example") + 5]
    scenario = import_map(MAPS / "lab.yaml", options_of(start=start, goal=goal)).scenario
    assert math.dist(scenario.start.position, scenario.goal.position) > 3.0


def test_a_map_becomes_a_file_that_says_what_it_left_out_and_is_driven(
    inside: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    said = inside("import", MAPS / "irsim.yaml", "--out", "w.yaml", "--goal", "2.2,1")
    assert "left out: line 17 obstacle[4].distribution: drawn by chance" in said.stderr
    head = Path("w.yaml").read_text().splitlines()
    assert head[0] == "# Imported from irsim.yaml."
    assert head[3:5] == [
        "# left out: line 17 obstacle[4].distribution: drawn by chance, so not in the file",
        "# changed: line 15 obstacle[3].shape.vertices: lines become 0.02 m thick",
    ]
    assert load_scenario("w.yaml").goal.position == (2.2, 1.0)
    inside("run", "w.yaml", "--no-video")
    assert Path("out/irsim.npz").exists()


def test_a_picture_needs_its_scale(tmp_path: Path) -> None:
    Image.fromarray(np.full((40, 60), 255, dtype=np.uint8)).save(tmp_path / "a.png")
    with pytest.raises(UserError, match=r"give --resolution M_PER_PIXEL, such as 0\.05"):
        import_map(tmp_path / "a.png")
    scenario = import_map(
        tmp_path / "a.png", options_of(resolution=0.1, start="1,1", goal="5,3")
    ).scenario
    assert scenario.arena.size == (6.0, 4.0)
    assert isinstance(scenario, Scenario)


@pytest.mark.parametrize("robot", [None, "create3"])
def test_a_map_that_is_yaml_is_kept_and_its_scenario_says_only_what_is_its_own(
    inside: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, robot: str | None
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("lab.yaml", "lab.pgm"):
        (tmp_path / name).write_bytes((MAPS / name).read_bytes())
    ends = ("--start", "-1.18,5.81", "--goal", "0.9,2.63")
    inside("import", "lab.yaml", *ends, *(("--robot", robot) if robot else ()))
    told = (tmp_path / "lab.scenario.yaml").read_text()
    assert (tmp_path / "lab.yaml").read_bytes() == (MAPS / "lab.yaml").read_bytes()
    assert "null" not in told
    assert ("robot: {model: create3}" in told) == (robot is not None)
    given = options_of(start=ends[1], goal=ends[3], robot=robot)
    assert load_scenario("lab.scenario.yaml") == import_map(MAPS / "lab.yaml", given).scenario
