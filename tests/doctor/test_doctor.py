"""What the doctor finds in a scenario that is valid and yet not sound."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from fuzzyq_bullet.cli.app import app
from fuzzyq_bullet.doctor import Finding, examine
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario import Scenario, bundled_scenarios, load_scenario


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
