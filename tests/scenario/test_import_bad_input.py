"""Maps that are wrong or hostile: one line each that says what, where and what would be right."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from fuzzyq_bullet import UserError
from fuzzyq_bullet.scenario.importers import ForeignMap, import_map, options_of, register_importer

MAPS = Path(__file__).parent / "maps"
ROS = "image: a.pgm\nresolution: 0.1\norigin: [0.0, 0.0, 0.0]\n"
HEAD = '<sdf version="1.7"><world name="w">\n'
TAIL = "\n</world></sdf>"
SOLID = (
    '<model name="m"><link name="l"><collision name="c">{pose}<geometry>\n{solid}\n</geometry>'
    "</collision></link></model>"
)
BOMB = (
    '<?xml version="1.0"?><!DOCTYPE b [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;">]>'
    "<sdf>&b;</sdf>"
)
OUTSIDE = (
    '<?xml version="1.0"?><!DOCTYPE b [<!ENTITY a SYSTEM "file:///etc/passwd">]><sdf>&a;</sdf>'
)


def line_of(path: Path, **options: str | float) -> str:
    asked = {"start": "1,1", "goal": "2,2", **options}
    with pytest.raises(UserError) as raised:
        import_map(path, options_of(**asked))  # type: ignore[arg-type]
    (line,) = raised.value.problems
    assert "\n" not in line
    return line


def solid(text: str, pose: str = "") -> str:
    return HEAD + SOLID.format(solid=text, pose=pose) + TAIL


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", ":1: is not valid XML: no element found"),
        ("<sdf><world></sdf>", ":1: is not valid XML: mismatched tag"),
        (BOMB, ": declares a document type or entities"),
        (OUTSIDE, ": declares a document type or entities"),
        ("<robot/>", ":1: robot: expected <sdf> with a <world> or a <model> in it"),
        ("<sdf>" + "<model>" * 100 + "</model>" * 100 + "</sdf>", ": nested deeper than 60 levels"),
        ("<sdf>" + "<model>" * 30 + "</model>" * 30 + "</sdf>", ": models nested deeper than 20"),
        (solid("<box><size>1 1</size></box>"), ":3: size: expected 3 numbers, got '1 1'"),
        (
            solid("<box><size>1 1 0</size></box>"),
            ":3: size: 0 m is no size; it must be more than 0",
        ),
        (solid("<box><size>1 1 nan</size></box>"), ":3: size: 'nan' is not a finite number"),
        (solid("<box><size>1 1 1e99</size></box>"), ":3: size: 1e+99 is out of bounds"),
        (solid("<box/>"), ":3: box: <size> is missing"),
        (solid("<sphere><radius>x</radius></sphere>"), ":3: radius: 'x' is not a finite number"),
        (
            solid("<sphere><radius>1</radius></sphere>", "<pose>1 2 3 nan 0 0</pose>"),
            ":2: pose: 'nan' is not a finite number",
        ),
        (
            solid("<empty/>", '<pose relative_to="x">0 0 0 0 0 0</pose>'),
            ":2: pose: relative to 'x', which is no link, model, frame or joint beside it",
        ),
        (
            HEAD + '<frame name="a" attached_to="b"/><frame name="b" attached_to="a"/>'
            '<model name="m"><pose relative_to="a"/></model>' + TAIL,
            ":2: frame: 'a' is placed relative to itself",
        ),
        (
            HEAD + "<include><uri>model://../../etc</uri></include>" + TAIL,
            ":2: uri: '../../etc' lies outside the folder",
        ),
        (
            HEAD + "<include><uri>/etc/passwd</uri></include>" + TAIL,
            ":2: uri: '/etc/passwd' lies outside the folder",
        ),
        (
            HEAD + "<include><uri>a.world</uri></include>" + TAIL,
            ":2: uri: 'a.world' includes itself in the end",
        ),
        (HEAD + "<include/>" + TAIL, ":2: include: <uri> is missing"),
        (
            solid("<mesh><uri>../x.stl</uri></mesh>"),
            ":3: uri: '../x.stl' lies outside the folder",
        ),
        (solid("<mesh><uri>broken.stl</uri></mesh>"), "broken.stl: is a mesh without triangles"),
        (solid("<mesh><uri>bomb.dae</uri></mesh>"), "bomb.dae:1: declares a document type"),
        (
            solid("<mesh><uri>a.blend</uri></mesh>"),
            ":3: uri: no mesh format '.blend'; allowed: .stl",
        ),
    ],
)
def test_worlds_of_gazebo(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "broken.stl").write_bytes(b"solid?" + bytes(200))
    (tmp_path / "bomb.dae").write_text(BOMB)
    (tmp_path / "a.blend").write_text("x")
    path = tmp_path / "a.world"
    path.write_text(text)
    assert said in line_of(path)


def test_models_that_include_each_other_in_a_circle(tmp_path: Path) -> None:
    for one, other in (("a", "b"), ("b", "a")):
        (tmp_path / one).mkdir()
        (tmp_path / one / "model.sdf").write_text(
            f'<sdf><model name="{one}"><include><uri>model://{other}</uri></include></model></sdf>'
        )
    path = tmp_path / "w.world"
    path.write_text(HEAD + "<include><uri>model://a</uri></include>" + TAIL)
    assert "b/model.sdf:1: uri: 'model://a' includes itself in the end" in line_of(path)


def test_meshes_without_trimesh_say_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "trimesh", None)
    told = line_of(MAPS / "house.world")
    assert told.endswith("which is not installed: pip install 'fuzzyq_bullet[maps]'")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (ROS.replace("a.pgm", "b.pgm"), "a.yaml:1: image: there is no file"),
        (ROS.replace("a.pgm", "../b.pgm"), "a.yaml:1: image: '../b.pgm' lies outside the folder"),
        (ROS.replace("a.pgm", "[1]"), "a.yaml:1: image: expected a file's name, got [1]"),
        (ROS.replace("0.1", ".nan"), "a.yaml:2: resolution: nan is not a finite number"),
        (ROS.replace("0.1", "0"), "a.yaml:2: resolution: 0 m cannot be; allowed: 0.001 to 100 m"),
        (ROS.replace("0.1", "x"), "a.yaml:2: resolution: expected a number, got 'x'"),
        (ROS.replace("[0.0, 0.0, 0.0]", "[1]"), "a.yaml:3: origin: expected a list of 2 to 3"),
        (ROS.replace("[0.0,", "[.inf,"), "a.yaml:3: origin[0]: inf is not a finite number"),
        (ROS.replace("[0.0,", "[5000,"), "a.pgm"),
        (ROS + "mode: raw\n", "a.yaml:4: mode: no mode 'raw'; allowed: trinary"),
        (ROS + "negate: 2\n", "a.yaml:4: negate: expected 0 or 1, got 2"),
        (ROS + "free_thresh: 0.9\n", "a.yaml:4: free_thresh: 0.9 is above occupied_thresh, 0.65"),
        (ROS + "occupied_thresh: 65\n", "a.yaml:4: occupied_thresh: 65 is out of bounds"),
    ],
)
def test_ros_maps(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "a.pgm").write_text("P2\n40 40\n255\n" + "254 " * 1600)
    (tmp_path / "a.yaml").write_text(text)
    if "5000" in text:
        said = "coordinates and sides of an arena are at most 1000 m: take a part with --crop"
    assert said in line_of(tmp_path / "a.yaml")


def png_bomb() -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        check = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", check)

    head = struct.pack(">IIBBBBB", 60000, 60000, 8, 0, 0, 0, 0)
    packed = zlib.compress(bytes(100_000))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", packed)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.png", b"", ": is no picture (PNG, PGM, BMP) that can be read"),
        ("a.png", b"\x89PNG\r\n\x1a\n", ": is no picture"),
        ("a.png", png_bomb(), ": has more than 25000000 pixels, which are not read"),
        ("a.pgm", b"P5\n99999 99999\n255\n", ": has more than 25000000 pixels"),
        ("a.pgm", b"P5\n6000 6000\n255\n", ": has more than 25000000 pixels"),
        ("a.pgm", b"P5\n40 40\n255\n" + bytes(100), ": is no picture"),
        ("a.pgm", b"P2\n4 4\n255\n1 2 x", ": is no picture"),
        ("a.pgm", b"P5\n0 0\n255\n", ": is"),
    ],
)
def test_pictures(tmp_path: Path, name: str, content: bytes, said: str) -> None:
    (tmp_path / name).write_bytes(content)
    assert said in line_of(tmp_path / name, resolution=0.1)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "a.map: is no map: there is no line 'map' at its head"),
        ("type octile\nheight 2\nmap\n..\n..\n", "a.map:3: width: is missing before 'map'"),
        ("type octile\nheight 2\nwidth x\nmap\n", "a.map:3: width: 'x' is not a finite number"),
        ("height 99999\nwidth 2\nmap\n", "a.map:1: height: 99999 is out of bounds"),
        ("height 0\nwidth 2\nmap\n", "a.map:1: height: 0 is out of bounds; allowed: 1 to 5000"),
        ("height 3\nwidth 2\nmap\n..\n..\n", "a.map:5: 2 rows, but height says 3"),
        ("height 2\nwidth 2\nmap\n..\n...\n", "a.map:5: 3 letters, but width says 2"),
        ("height 2\nwidth 2\nmap\n..\n.x\n", "a.map:5: 'x' is no cell; allowed: . G S @ O T W"),
    ],
)
def test_maps_of_movingai(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "a.map").write_text(text)
    assert said in line_of(tmp_path / "a.map")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "a.scen:1: expected 'version 1'"),
        ("version 1\n0 b.map 2 2 0 0 1 1 1\n", "a.scen:2: map: there is no file"),
        ("version 1\n0 a.map 2 2 0 0 1 1\n", "a.scen:2: expected bucket, map, width"),
        ("version 1\n0 a.map 2 2 0 9 1 1 1\n", "a.scen:2: start y: 9 is out of bounds"),
        ("version 1\n0 .. 2 2 0 9 1 1 1\n", "a.scen:2: map: '..' lies outside the folder"),
    ],
)
def test_tasks_of_movingai(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "a.map").write_text("height 2\nwidth 2\nmap\n..\n..\n")
    (tmp_path / "a.scen").write_text(text)
    assert said in line_of(tmp_path / "a.scen")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("world: 3\nrobot: {}\n", "a.yaml:1: world: expected a mapping or a list, got 3"),
        ("world: {width: -1}\nrobot: {}\n", "a.yaml:1: world.width: -1 is out of bounds"),
        ("world: {}\nrobot: {state: [1]}\n", "a.yaml:2: robot.state: expected a list of 2 to 6"),
        ("world: {}\nobstacle: [{state: [1, 1]}]\n", "a.yaml:2: obstacle[0].shape: expected {name"),
        (
            "world: {}\nobstacle:\n  - {shape: {name: star}}\n",
            "a.yaml:3: obstacle[0].shape.name: no name 'star'; allowed: circle",
        ),
        (
            "world: {}\nobstacle:\n  - {shape: {name: circle, radius: .nan}}\n",
            "a.yaml:3: obstacle[0].shape.radius: nan is not a finite number",
        ),
    ],
)
def test_worlds_of_ir_sim(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "a.yaml").write_text(text)
    assert said in line_of(tmp_path / "a.yaml")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"start": "1"}, "--start: expected X,Y or X,Y,HEADING, got '1'"),
        ({"goal": "1,x"}, "--goal: 'x' is not a finite number"),
        ({"goal": "1,nan"}, "--goal: 'nan' is not a finite number"),
        ({"crop": "1,2,3"}, "--crop: expected X0,Y0,X1,Y1, got '1,2,3'"),
        ({"crop": "3,2,1,4"}, "--crop: 3,2,1,4: X0 must be less than X1, and Y0 less than Y1"),
        ({"unknown": "bloked"}, "--unknown: no answer 'bloked'; did you mean 'blocked'?"),
        ({"robot": "mouse"}, "--robot: no robot 'mouse'"),
        ({"resolution": 0.0}, "--resolution: 0 m cannot be"),
        ({"crop": "90,90,99,99"}, "--crop: leaves nothing of"),
        ({"robot": "mouse.urdf"}, "--robot: mouse.urdf: cannot be read"),
        ({"left_wheel": "a"}, "--left-wheel: is for a model from a URDF file; fuzzyq needs none"),
        (
            {"start": "50,50"},
            "--start: (50, 50) is outside the map, x 0 to 4 m, y 0 to 4 m; there is room at "
            "--start 3.77,3.77",
        ),
        ({"goal": "3.9,2"}, "--goal: (3.9, 2) is 0.1 m from the edge of the map; the robot needs"),
        ({"crop": "0,0,1.5,1.5"}, "--goal: (2, 2) is outside --crop, x 0 to 1.5 m, y 0 to 1.5 m"),
        ({"start": "5000,1"}, "--start: 5000 is out of bounds; allowed: -1000 to 1000"),
        ({"goal": "1.1,1"}, "--start: is within the goal already: 0.1 m from its centre"),
    ],
)
def test_options(tmp_path: Path, options: dict[str, str | float], said: str) -> None:
    Image.fromarray(np.full((40, 40), 255, dtype=np.uint8)).save(tmp_path / "a.png")
    assert said in line_of(tmp_path / "a.png", **{"resolution": 0.1, **options})


def test_start_and_goal_inside_something_are_told_with_what_it_is_and_where_there_is_room() -> None:
    with pytest.raises(UserError) as raised:
        import_map(MAPS / "irsim.yaml", options_of(start="5,5", goal="6.1,2"))
    start, goal = raised.value.problems
    what = "--start: (5, 5) is inside an obstacle, the cylinder at (5.00, 5.00); there is room at "
    assert start.startswith(what)
    assert goal.startswith("--goal: (6.1, 2) is inside an obstacle, the box at (6.00, 2.00); ")
    better = [line.split()[-1] for line in (start, goal)]
    import_map(MAPS / "irsim.yaml", options_of(start=better[0], goal=better[1]))


def test_a_start_of_the_map_itself_is_named_with_the_map(tmp_path: Path) -> None:
    path = tmp_path / "w.yaml"
    path.write_text((MAPS / "irsim.yaml").read_text().replace("[1, 1, 0]", "[5, 5, 0]"))
    with pytest.raises(UserError) as raised:
        import_map(path)
    (line,) = raised.value.problems
    assert line.startswith(f"{path}: start.position: (5, 5) is inside an obstacle, the cylinder")


def test_importers_share_a_suffix_only_if_they_can_tell_their_files(tmp_path: Path) -> None:
    def nothing(path: Path) -> ForeignMap:
        raise UserError(f"{path}: read")

    with pytest.raises(ValueError, match=r"an importer for '\.png' is registered already"):
        register_importer(".png")(nothing)
    (tmp_path / "a.nowhere").write_text("x")
    assert "no importer for the suffix '.nowhere'" in line_of(tmp_path / "a.nowhere")
