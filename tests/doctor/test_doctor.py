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
