"""A URDF that could not drive, or would do harm, is refused in one line with file and line."""

from pathlib import Path

import pytest

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.robots.urdf_checks import robot_from_urdf
from fuzzyq_bullet.scenario import parse_scenario

ROOT = Path(__file__).resolve().parents[2]
CART = (ROOT / "examples" / "robots" / "cart.urdf").read_text()
CASTER = '<link name="caster">'
LEFT = '<origin xyz="0 0.14 0.06"/>\n    <axis xyz="0 1 0"/>'


def swapped(old: str, new: str, count: int = -1) -> str:
    assert old in CART
    return CART.replace(old, new, count)


WRONG = {
    "not XML": (CART[:-9], "not valid XML"),
    "empty": ("", "not valid XML"),
    "another document": ("<sdf/>", "holds <sdf>; a URDF holds one <robot>"),
    "entities": (
        '<!DOCTYPE a [<!ENTITY b "c">]><robot name="a">&b;</robot>',
        "declares a document type or entities",
    ),
    "a huge line": (swapped("<link", "<!--" + 9000 * "x" + "--><link", 1), "a line of 90"),
    "deep nesting": (f"<robot>{100 * '<a>'}{100 * '</a>'}</robot>", "nested deeper than 60"),
    "no number": (swapped('mass value="4.0"', 'mass value="four"'), "must be a number"),
    "not finite": (swapped('mass value="4.0"', 'mass value="nan"'), "finite"),
    "a xacro": (swapped('mass value="4.0"', 'mass value="${m}"'), "this is a xacro"),
    "no mass": (swapped('mass value="4.0"', 'mass value="0"'), "value must be greater than 0"),
    "negative inertia": (swapped('ixx="0.03"', 'ixx="-0.03"'), "ixx must be greater than 0"),
    "impossible inertia": (swapped('izz="0.06"', 'izz="9"'), "no body has this inertia"),
    "no weight": (swapped('mass value="4.0"', 'mass value="1e-9"'), "weighs less than"),
    "too much inertia": (
        swapped('ixx="0.03" iyy="0.04" izz="0.06"', 'ixx="600" iyy="600" izz="600"'),
        "too large for 4 kg",
    ),
    "friction": (
        swapped(CASTER, f'{CASTER}<contact><lateral_friction value="-1"/></contact>'),
        "lateral_friction must be between 0 and 10",
    ),
    "no wheels": (swapped("wheel_joint", "motor"), "no joint for the left wheel; name it"),
    "a fixed wheel": (swapped('"continuous"', '"fixed"', 1), "its type must be continuous"),
    "a third joint that moves": (swapped('"fixed"', '"continuous"'), "only the two wheels may"),
    "axis forward": (swapped(LEFT, LEFT.replace("0 1 0", "1 0 0")), "0 1 0 in the base frame"),
    "axis the other way": (swapped(LEFT, LEFT.replace("0 1 0", "0 -1 0")), "both the same way"),
    "lopsided": (swapped(LEFT, LEFT.replace("0.14", "0.10")), "must lie opposite each other"),
    "swapped sides": (
        swapped('"0 0.14', '"0 +0.14').replace('"0 -0.14', '"0 0.14').replace("+", "-"),
        "must be on the left",
    ),
    "base frame not between": (swapped('"0 0.14', '"0.1 0.14').replace('"0 -0.14', '"0.1 -0.14'),
                               "must lie between the wheels"),
    "wheels in the air": (swapped("0.14 0.06", "0.14 0.09"), "it must stand on the ground"),
    "no caster": (swapped("-0.2 0 0.02", "-0.2 0 0.1"), "give it a caster"),
    "below the ground": (swapped("-0.2 0 0.02", "-0.2 0 0.0"), "below the ground"),
    "millimetres": (swapped("0.36 0.24 0.14", "360 240 140"), "are these millimetres?"),
    "negative size": (swapped("0.36 0.24 0.14", "0.36 -0.24 0.14"), "greater than 0"),
    "too tall": (swapped("0.36 0.24 0.14", "0.36 0.24 0.16").replace("0 0.11", "0 0.4"), "tall"),
    "a mesh that is not there": (
        swapped('<box size="0.36 0.24 0.14"/>', '<mesh filename="body.obj"/>'), "body.obj"),
    "a mesh that is a folder": (
        swapped('<box size="0.36 0.24 0.14"/>', '<mesh filename="folder.obj"/>'), "folder.obj"),
    "a package": (
        swapped('<box size="0.36 0.24 0.14"/>', '<mesh filename="package://a/b.obj"/>'),
        "relative to the URDF",
    ),
    "a link twice": (swapped('name="right_tyre"', 'name="left_tyre"'), "is there twice"),
    "no such link": (swapped('<child link="caster"/>', '<child link="cast"/>'), "that is no link"),
    "a circle": (swapped('<parent link="base"/>\n    <child link="caster"/>',
                         '<parent link="caster"/>\n    <child link="caster"/>'), "circle"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_it_is_refused_in_one_line(name, tmp_path):
    text, why = WRONG[name]
    (tmp_path / "folder.obj").mkdir()
    path = tmp_path / "my.urdf"
    path.write_text(text)
    with pytest.raises(UserError) as caught:
        robot_from_urdf(path)
    [line] = caught.value.problems
    assert line.startswith(f"{path}:")
    assert line.removeprefix(f"{path}:").split(":")[0].isdigit()
    assert why in line


@pytest.mark.parametrize("name", ["folder.urdf", "missing.urdf"])
def test_no_file_is_one_line(name, tmp_path):
    (tmp_path / "folder.urdf").mkdir()
    with pytest.raises(UserError, match=name):
        robot_from_urdf(tmp_path / name)


@pytest.mark.parametrize(
    ("robot", "line"),
    [
        ("{model: jackal, radius: 0.5}", "robot.radius: is that of a rectangle's corners"),
        ("{radius: 0.1}", "robot.radius: the wheels do not fit under the body"),
        ("{track: 0.6}", "robot.track: the wheels do not fit under the body"),
        ("{left_wheel: a}", "robot.left_wheel: is for a model from a URDF file"),
        ("{model: missing.urdf}", "robot.model: "),
        ("{model: my.urdf, mass: 3.0}", "robot.mass: is measured from the URDF"),
        ("{model: my.urdf, left_wheel: nobody}", "robot.model: "),
    ],
)
def test_a_scenario_names_its_key(robot, line, tmp_path):
    (tmp_path / "my.urdf").write_text(CART)
    start = "start: {position: [1.0, 5.0]}\ngoal: {position: [9.0, 5.0]}"
    with pytest.raises(UserError) as caught:
        parse_scenario(f"name: a\n{start}\nrobot: {robot}\n", "a.yaml", folder=tmp_path)
    [told] = caught.value.problems
    assert told.startswith(f"a.yaml:4: {line}")


def test_a_plain_cart_is_a_robot(tmp_path):
    path = tmp_path / "my.urdf"
    path.write_text(CART.replace("wheel_joint", "motor"))
    assert robot_from_urdf(path, "left_motor", "right_motor").name == "cart"
