"""What the doctor finds in a scenario that is valid and yet not sound."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from fuzzyq_bullet.cli.app import app
from fuzzyq_bullet.doctor import Finding, examine
from fuzzyq_bullet.doctor.examination import examine_turn
from fuzzyq_bullet.doctor.touch import examine_touch
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.robots import RobotModel
from fuzzyq_bullet.scenario import Scenario, bundled_scenarios, load_scenario
from fuzzyq_bullet.shapes import ConvexShape
from fuzzyq_bullet.shapes.base import Collision, Floats

CART = Path(__file__).parents[2] / "examples" / "robots" / "cart.urdf"


def findings(**told: Any) -> list[Finding]:
    given = {"name": "s", "start": {"position": [1, 5]}, "goal": {"position": [9, 5]}, **told}
    return examine(Scenario.model_validate(given))


def box(x: float, y: float, width: float, depth: float) -> dict[str, Any]:
    return {"shape": "box", "position": [x, y], "size": [width, depth]}


GHOST = """
from typing import Literal
from fuzzyq_bullet.shapes import ConvexShape, register_shape

@register_shape
class Ghost(ConvexShape):
    shape: Literal["ghost"]

    def polygon(self):
        x, y = self.position
        return [(x - 0.3, y - 0.3), (x + 0.3, y - 0.3), (x + 0.3, y + 0.3), (x - 0.3, y + 0.3)]

    def faces(self):
        return super().faces() + (0.05, 0.0)
"""


def test_a_sound_scenario_has_nothing() -> None:
    assert findings(obstacles=[{"shape": "cylinder", "position": [5, 5], "radius": 0.3}]) == []


def test_a_gap_as_wide_as_the_robot_on_its_path_is_found() -> None:
    [found] = findings(obstacles=[box(5, 2.399, 0.5, 4.8), box(5, 7.601, 0.5, 4.8)])
    assert (found.kind, found.wrong, found.loc) == ("luck", True, ("obstacles", 1))
    assert "0.402 m at (5.25, 5.00)" in found.message


def test_such_a_gap_elsewhere_is_a_note() -> None:
    [found] = findings(obstacles=[box(5, 1.0, 0.5, 0.5), box(5, 1.902, 0.5, 0.5)])
    assert (found.kind, found.wrong) == ("luck", False)


def test_a_gap_between_arms_of_one_polygon_is_found() -> None:
    # A wall across the arena with a door that is 0.402 m wide, in one piece: it meets behind.
    door = [(5, 4.799), (5.2, 4.799), (5.2, 0.0), (9.8, 0.0), (9.8, 9.8), (5.2, 9.8)]
    door += [(5.2, 5.201), (5, 5.201), (5, 10), (10, 10), (10, -0.2), (5, -0.2)]
    told = {"obstacles": [{"shape": "polygon", "points": door}], "arena": {"walls": False}}
    [found] = findings(**told)
    assert (found.kind, found.wrong, found.loc) == ("luck", True, ("obstacles", 0))
    assert "obstacles[0] and itself leave a gap of 0.402 m at (5" in found.message


def test_rays_that_graze_or_begin_in_a_concave_polygon_prove_nothing() -> None:
    hook = [(4, 4), (6, 4), (6, 6), (4, 6), (4, 5.85), (5.85, 5.85), (5.85, 4.15), (4, 4.15)]
    assert findings(obstacles=[{"shape": "polygon", "points": hook}]) == []


def test_walls_elsewhere_are_seen_where_they_are() -> None:
    arena = {"size": [6, 4], "origin": [-40, 30]}
    places = {"start": {"position": [-39, 32]}, "goal": {"position": [-36, 32]}}
    assert findings(arena=arena, **places) == []


def test_a_niche_in_which_a_rectangular_body_cannot_turn_is_found() -> None:
    robot = {"model": "jackal"}
    sides = [box(1, 5.4, 0.8, 0.3), box(1, 4.6, 0.8, 0.3)]  # 0.25 m from its middle; it needs 0.33
    found = findings(robot=robot, start={"position": [1, 5], "heading": 0.0}, obstacles=sides)
    assert ("turn", ("start", "position")) in [(one.kind, one.loc) for one in found]
    wide = [box(1, 5.6, 0.8, 0.3), box(1, 4.4, 0.8, 0.3)]
    found = findings(robot=robot, start={"position": [1, 5], "heading": 0.0}, obstacles=wide)
    assert "turn" not in [one.kind for one in found]


class Block(ConvexShape):
    """A square prism as a plugin may have it; nobody registers it."""

    shape: Literal["block"] = "block"
    half: float = 0.3

    def polygon(self) -> list[tuple[float, float]]:
        (x, y), a = self.position, self.half
        return [(x - a, y - a), (x + a, y - a), (x + a, y + a), (x - a, y + a)]


class SeenBeside(Block):
    def faces(self) -> Floats:
        return np.add(super().faces(), (0.5, 0.0))


class Unseen(Block):
    """Its rays meet a small core only, they pass over the rest."""

    def faces(self) -> Floats:
        return np.array(self.position) + (super().faces() - self.position) / 10.0


class Aloft(Block):
    """Its solid hangs above the robot."""

    def collisions(self, height: float) -> list[Collision]:
        [one] = super().collisions(height)
        assert one.prism is not None
        return [Collision("", prism=np.add(one.prism, (0.0, 0.0, height)))]


class Needle(Block):
    """It is thinner than the rays of the sensor are apart, and says that it is not."""

    half: float = 0.01

    def thickness(self) -> float:
        return 1.0


def touched(*obstacles: Block, **told: Any) -> list[Finding]:
    """What the poses alone tell; the obstacles are of no registered shape."""
    given = {"name": "s", "start": {"position": [1, 5]}, "goal": {"position": [9, 5]}, **told}
    scenario = Scenario.model_validate(given).model_copy(update={"obstacles": obstacles})
    return list(examine_touch(scenario, len(obstacles)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "words"),
    [
        (SeenBeside, ("the sensor sees something, the nearest solid is", "the body is")),
        (Unseen, ("mm inside something that the sensor,",)),
        (Aloft, ("the sensor sees something, the nearest solid is far away",)),
        (Needle, ("mm inside something that the sensor,",)),
    ],
)
def test_what_is_not_both_seen_and_touched_is_found_from_many_poses(
    kind: type[Block], words: tuple[str, ...]
) -> None:
    found = touched(Block(position=(3.0, 3.0)), kind(position=(6.0, 6.0)))
    assert [(one.kind, one.loc, one.wrong) for one in found] == [("sight", ("obstacles", 1), True)]
    assert any(one in found[0].message for one in words)


@pytest.mark.slow
def test_what_poses_cannot_tell_apart_is_no_mismatch() -> None:
    near = [Block(position=(5.0, 3.0 + k * 0.61)) for k in range(4)]  # 1 cm apart, in a row
    thin = Block(position=(7.0, 7.0), half=0.011)
    assert touched(*near, thin, robot={"model": "jackal"}) == []


def test_walls_that_rays_do_not_see_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    from fuzzyq_bullet.physics import sensor_world

    monkeypatch.setattr(sensor_world, "meshes", lambda *_: iter(()))
    [found] = touched(arena={"size": [4, 4]}, start={"position": [1, 1]}, goal={"position": [3, 3]})
    assert (found.kind, found.loc) == ("sight", ("arena",))


def test_a_body_larger_than_the_radius_that_a_plugin_tells_is_found_at_the_start(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    beside = [box(1, 5.35, 0.8, 0.2)]  # 0.25 m from its middle, and the radius is 0.2 m
    start = {"position": [1, 5], "heading": 0.0}
    assert findings(start=start, obstacles=beside) == []
    sled = RobotModel(name="fuzzyq", size=(0.8, 0.3), radius=0.2)
    monkeypatch.setattr("fuzzyq_bullet.scenario.robot.robot_model", lambda _: sled)
    found = findings(start=start, obstacles=beside)
    assert ("turn", ("start", "position")) in [(one.kind, one.loc) for one in found]


ARM = """
  <link name="arm">
    <inertial><mass value="0.1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <collision><geometry><box size="0.4 0.04 0.04"/></geometry></collision>
  </link>
  <joint name="arm_mount" type="fixed">
    <parent link="base"/><child link="arm"/><origin xyz="0.3 0 0.1"/>
  </joint>
</robot>"""


def test_every_link_of_a_urdf_is_the_body_that_turns(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(CART.read_text().replace("</robot>", ARM))
    beside = [box(1, 5.5, 0.8, 0.2)]  # 0.4 m from its middle: the arm reaches 0.5 m, the base 0.27
    start = {"position": [1, 5], "heading": 0.0}
    for robot, found in ((path, ["turn"]), (CART, [])):
        scenario = Scenario.model_validate(
            {
                "name": "s",
                "start": start,
                "goal": {"position": [9, 5]},
                "robot": {"model": str(robot)},
                "obstacles": beside,
            }
        )
        assert [one.kind for one in examine_turn(scenario)] == found


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("name: s\nstart: {position: [1, 5]}\ngoal: {position: [9, 5]}\nvia: 7\n", ":4: via"),
        ("name: s\nstart: {position: [1, 5]}\n", "goal"),
        (
            "name: s\nstart: {position: [1, 5]}\ngoal: {position: [9, 5]}\nobstacles:\n"
            "  - {shape: box, position: [1, 5.4], size: [0.8, 0.5]}\n",
            ":5: obstacles[0]: overlaps the start",
        ),
        (None, "there is no such file"),
    ],
)
def test_bad_input_is_one_line(text: str | None, line: str, tmp_path: Path) -> None:
    file = tmp_path / "bad.yaml"
    if text is not None:
        file.write_text(text)
    with pytest.raises(UserError) as wrong:
        app(["doctor", str(file)], standalone_mode=False)
    [told] = wrong.value.problems
    assert line in told


def test_bad_input_has_exit_code_2(tmp_path: Path) -> None:
    order = [sys.executable, "-m", "fuzzyq_bullet", "doctor", str(tmp_path)]
    done = subprocess.run(order, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)


def test_a_goal_walled_in_is_found() -> None:
    [found] = findings(obstacles=[box(7, 5, 0.2, 10)])
    assert (found.kind, found.loc) == ("reach", ("goal",))


def test_a_via_point_walled_in_is_found_first() -> None:
    via = [{"position": [5, 5]}, {"position": [9, 9]}]
    [found] = findings(via=via, obstacles=[box(7, 5, 0.2, 10)])
    assert (found.kind, found.loc) == ("reach", ("via", 1))


@pytest.mark.slow
def test_a_shape_of_a_plugin_that_is_seen_beside_its_solid_is_found(tmp_path: Path) -> None:
    plugin, file = tmp_path / "ghost.py", tmp_path / "haunted.yaml"
    plugin.write_text(GHOST)
    file.write_text(
        "name: haunted\nstart: {position: [1, 5]}\ngoal: {position: [9, 5]}\nobstacles:\n"
        "  - {shape: box, position: [3, 3], size: [1, 1]}\n  - {shape: ghost, position: [5, 5]}\n"
    )
    order = [sys.executable, "-m", "fuzzyq_bullet", "doctor", str(file), "--plugin", str(plugin)]
    done = subprocess.run(order, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stderr
    [line] = done.stdout.splitlines()
    assert line.startswith(f"wrong  sight  {file}:6: obstacles[1]: ghost: rays meet it 5")


def test_the_command_tells_file_and_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "walled.yaml"
    file.write_text(
        "name: walled\nstart: {position: [1, 5]}\ngoal: {position: [9, 5]}\nobstacles:\n"
        "  - {shape: box, position: [7, 5], size: [0.2, 10]}\n"
    )
    assert app(["doctor", str(file), "--json"], standalone_mode=False) == 1
    [told] = json.loads(capsys.readouterr().out)
    assert not told["healthy"]
    assert told["findings"][0]["text"].startswith(f"{file}:3: goal: there is no way")


@pytest.mark.slow
@pytest.mark.parametrize("name", bundled_scenarios())
def test_bundled_scenarios_are_sound(name: str) -> None:
    assert [one for one in examine(load_scenario(name)) if one.wrong] == []
