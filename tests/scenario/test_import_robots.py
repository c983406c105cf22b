"""A map is imported for a robot of some height; a taller one that could touch more is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fuzzyq_bullet import UserError, load_scenario
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.robots import robot_model
from fuzzyq_bullet.scenario.importers import import_map, options_of
from tests.helpers.commands import Call

CART = Path(__file__).resolve().parents[2] / "examples" / "robots" / "cart.urdf"
ENDS = {"start": "-2,0", "goal": "2,0"}
OPTIONS = ("--start", "-2,0", "--goal", "2,0")
MODEL = (
    '<model name="m"><static>1</static><pose>{pose}</pose><link name="l"><collision name="c">'
    "<geometry>{solid}</geometry></collision></link></model>"
)
BAR = ("<box><size>0.2 1 0.04</size></box>", "0 0 {} 0 0 0")
BALL = "<sphere><radius>{}</radius></sphere>"
PLANK = "<box><size>1 0.5 0.02</size></box>"
POLE = "<cylinder><radius>0.3</radius><length>1</length></cylinder>"
GRID = np.stack(np.meshgrid(*[np.linspace(-1.5, 1.5, 31)] * 2), axis=-1).reshape(-1, 2)
TALLER = ("turtlebot3-burger", "jackal", "husky")  # 0.192, 0.25 and 0.39 m; the default: 0.15 m


def world(folder: Path, solid: str, pose: str) -> Path:
    path = folder / "low.world"
    model = MODEL.format(solid=solid, pose=pose)
    path.write_text(f'<sdf version="1.7"><world name="w">{model}</world></sdf>')
    return path


def bar(folder: Path, middle: float) -> Path:
    """A world of one bar across the way, 0.04 m thick."""
    return world(folder, BAR[0], BAR[1].format(middle))


def cart(folder: Path, top: float) -> Path:
    """A URDF of a robot so tall (m)."""
    text = CART.read_text()
    assert "-0.06 0 0.11" in text  # the middle of its body, 0.14 m high
    path = folder / "cart.urdf"
    path.write_text(text.replace("-0.06 0 0.11", f"-0.06 0 {top - 0.07:.3f}"))
    return path


def refused(inside: Call, *words: object) -> str:
    """The one line with which a command refuses."""
    with pytest.raises(UserError) as raised:
        inside(*words)
    (line,) = raised.value.problems
    return line


@pytest.mark.parametrize(
    ("solid", "pose", "headroom"),
    [
        (BAR[0], BAR[1].format(0.21), 0.19),
        (BAR[0], BAR[1].format(0.16), None),  # the default robot touches it
        (BAR[0], BAR[1].format(0.43), None),  # no robot is that tall
        ("<box><size>0.2 1 2</size></box>", "0 0 1 0 0 0", None),
        ("<box><size>0.2 1 2</size></box>", "0 0 0.1 0 1.5707963 0.3", None),  # lies on its side
        (BALL.format(0.1), "0 0 0.1 0 0 0", None),
        (BALL.format(0.5), "0 0 0.5 0 0 0", 0.15),  # wider further up
        (PLANK, "0 0 0.35 0 -0.7853981 0", 0.15),  # leans
        (POLE, "0 0 0.3 1.5707963 0 0", 0.15),  # lies
    ],
)
def test_headroom_is_the_height_up_to_which_a_taller_robot_touches_nothing_else(
    tmp_path: Path, solid: str, pose: str, headroom: float | None
) -> None:
    path = world(tmp_path, solid, pose)
    made = import_map(path, options_of(**ENDS)).scenario
    assert made.arena.headroom == (None if headroom is None else pytest.approx(headroom, abs=1e-9))
    for robot in TALLER:
        own = import_map(path, options_of(**ENDS, robot=robot)).scenario
        gaps, others = (Field.of(one.obstacles).clearance(GRID) for one in (made, own))
        fits = headroom is None or robot_model(robot).height <= headroom
        assert np.allclose(gaps, others, rtol=0.0, atol=1e-5) == fits


def test_a_part_of_a_mesh_that_hangs_is_seen(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    leg = trimesh.creation.box((0.1, 0.1, 0.2), transform=translation(0.5, 0.1))
    board = trimesh.creation.box((1.0, 1.0, 0.02), transform=translation(0.0, 0.31))
    trimesh.util.concatenate([leg, board]).export(tmp_path / "table.stl")
    path = world(tmp_path, "<mesh><uri>table.stl</uri></mesh>", "0 0 0 0 0 0")
    made = import_map(path, options_of(**ENDS)).scenario
    assert len(made.obstacles) == 1
    assert made.arena.headroom == pytest.approx(0.3, abs=1e-6)
    assert len(import_map(path, options_of(**ENDS, robot="husky")).scenario.obstacles) == 2


def translation(x: float, z: float) -> list[list[float]]:
    return [[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, z], [0, 0, 0, 1]]


@pytest.mark.usefixtures("in_this_process")
def test_every_command_refuses_a_robot_that_is_too_tall_for_the_map(
    inside: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    bar(tmp_path, 0.21)
    cart(tmp_path, 0.24)
    inside("import", "low.world", *OPTIONS)
    made = Path("low.yaml").read_text()
    assert "headroom: 0.19" in made
    Path("low.yaml").write_text(made + "robot: {model: cart.urdf}\n")
    line = made[: made.index("headroom")].count("\n") + 1
    for command in ("validate", "doctor", "check", "run"):
        assert refused(inside, command, "low.yaml") == (
            f"low.yaml:{line}: arena.headroom: the robot cart.urdf is 0.24 m tall, and the "
            "obstacles leave out what it could touch above 0.19 m; import the map again with "
            "--robot cart.urdf"
        )
    cart(tmp_path, 0.19)  # one that just fits
    inside("validate", "low.yaml")


def test_a_map_is_imported_for_a_urdf_which_the_scenario_names_from_where_it_lies(
    inside: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    bar(tmp_path, 0.21)
    (tmp_path / "bots").mkdir()
    cart(tmp_path / "bots", 0.24)
    (tmp_path / "deep" / "est").mkdir(parents=True)
    (tmp_path / "link").symlink_to("deep/est")
    for out, told in (
        ("low.yaml", "bots/cart.urdf"),
        ("bots/low.yaml", "cart.urdf"),
        ("link/low.yaml", "../../bots/cart.urdf"),
    ):
        inside("import", "low.world", *OPTIONS, "--robot", "bots/cart.urdf", "--out", out)
        assert f'robot: {{model: "{told}"}}\n' in Path(out).read_text()
        scenario = load_scenario(out)
        assert [one.shape for one in scenario.obstacles] == ["box"]
        assert scenario.robot.spec.height == pytest.approx(0.24)
        assert scenario.arena.headroom is None
    again = ("--robot", "bots/cart.urdf", "--out", "bots/cart.urdf", "--replace")
    assert refused(inside, "import", "low.world", *OPTIONS, *again).startswith("bots/cart.urdf: ")
    assert Path("bots/cart.urdf").read_text().startswith("<?xml")


def test_wheels_of_a_urdf_with_names_of_their_own_are_named_by_options(
    inside: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    bar(tmp_path, 0.21)
    urdf = cart(tmp_path, 0.24)
    urdf.write_text(
        urdf.read_text().replace("left_wheel_joint", "a").replace("right_wheel_joint", "b")
    )
    ask = ("import", "low.world", *OPTIONS, "--robot", "cart.urdf")
    said = refused(inside, *ask)
    assert said.startswith("--robot: cart.urdf:")
    assert "no joint for the left wheel; name it: left_wheel: JOINT" in said
    inside(*ask, "--left-wheel", "a", "--right-wheel", "b")
    assert (
        'robot: {model: "cart.urdf", left_wheel: a, right_wheel: b}' in Path("low.yaml").read_text()
    )
    assert load_scenario("low.yaml").robot.spec.axles == ("a", "b")


def test_an_arena_without_headroom_is_told_as_before_so_digests_of_fields_stay() -> None:
    assert "headroom" not in load_scenario("boxes").model_dump()["arena"]


def test_a_scenario_of_a_lower_robot_is_not_imported_for_a_taller_one(tmp_path: Path) -> None:
    made = tmp_path / "own.yaml"
    made.write_text(
        "name: own\nstart: {position: [1.0, 5.0]}\ngoal: {position: [9.0, 5.0]}\n"
        "arena: {headroom: 0.19}\n"
    )
    with pytest.raises(UserError, match=r"^--robot: the robot jackal is 0\.25 m tall, and the obs"):
        import_map(made, options_of(robot="jackal"))
    assert import_map(made, options_of(robot="create3")).scenario.arena.headroom == 0.19
