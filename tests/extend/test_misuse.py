"""A plugin that raises, exits or answers nonsense is one line about it, never a traceback."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tests.helpers.commands import Call

ROOM = """\
name: room
arena: {size: [4.0, 3.0]}
start: {position: [0.6, 1.5]}
goal: {position: [3.2, 1.5]}
"""
MOTION = "obstacles: [{shape: cylinder, position: [2, 2.5], radius: 0.2, motion: {kind: NAME}}]\n"
HEAD = """\
from typing import Literal
from fuzzyq_bullet.scenario.layouts import Layout, register_layout
from fuzzyq_bullet.shapes import ConvexShape, Cylinder, Motion, Pose
from fuzzyq_bullet.shapes import register_motion, register_shape
"""
KINDS = {
    "motion": """
@register_motion
class Motion{number}(Motion):
    kind: Literal["{name}"]
    def pose(self, time): return Pose(0, 0, 0)
    def {method}: {body}
""",
    "shape": """
@register_shape
class Shape{number}(ConvexShape):
    shape: Literal["{name}"]
    def polygon(self): return [(x + 2, y + 2.4) for x, y in [(0, 0), (0.3, 0), (0.3, 0.3)]]
    def {method}: {body}
""",
    "layout": """
@register_layout
class Layout{number}(Layout):
    layout: Literal["{name}"]
    def draw(self, scenario, rng): return ()
    def {method}: {body}
""",
}
ASKS = {
    "motion": MOTION,
    "shape": "obstacles: [{shape: NAME, position: [2, 2.4]}]\n",
    "layout": "random: {layout: NAME}\n",
}
OUTLINE = "polygon(self)"
CASES = [
    ("motion", "conflicts(self, obstacle, standing)", "1 / 0", "in conflicts (FILE:"),
    ("motion", "conflicts(self, obstacle, standing)", "pass", "conflicts must return a list"),
    ("motion", "conflicts(self, obstacle, standing)", "return [(1, 2)]", "conflicts must return"),
    ("motion", "course(self, obstacle, world)", "raise SystemExit(0)", "tried to exit, as its"),
    ("motion", "course(self, obstacle, world)", "raise KeyboardInterrupt", "by KeyboardInterrupt"),
    ("motion", "pose(self, time)", "raise SystemExit(0)", "tried to exit, in pose(0) (FILE:"),
    ("motion", "pose(self, time)", "return {1, 'two'}", "must return Pose(x, y, yaw), three"),
    ("motion", "pose(self, time)", "return (0, 1e9, 0)", "three numbers below 1e+07, not [0, 10"),
    ("motion", "top_speed(self, obstacle)", "raise SystemExit(0)", "tried to exit, in top_speed"),
    ("shape", OUTLINE, "1 / 0", "ZeroDivisionError: division by zero, in outline (FILE:"),
    ("shape", OUTLINE, "raise SystemExit(0)", "tried to exit, in outline"),
    ("shape", OUTLINE, "return [(0, 0), (1, 1)]", "outline must be at least 3 points"),
    ("shape", OUTLINE, "return [(0, 0), (float('nan'), 1), (1, 1)]", "must be finite"),
    ("shape", OUTLINE, "return [(2, 2), (2, 2.3), (2.3, 2)]", "outline must go anticlockwise"),
    (
        "shape",
        OUTLINE,
        "return [(2, 2), (2.9, 2), (2.1, 2.1), (2, 2.9)]",
        "pieces must be convex",
    ),
    ("shape", "extent(self)", "return -1.0", "extent must be a length (m), not -1.0"),
    ("shape", "thickness(self)", "return None", "TypeError"),
    ("shape", "faces(self)", "1 / 0", "division by zero, in faces"),
    ("shape", "collisions(self, height)", "return []", "collisions must return one solid"),
    ("layout", "conflicts(self, scenario)", "1 / 0", "division by zero, in conflicts (FILE:"),
    ("layout", "draw(self, scenario, rng)", "1 / 0", "division by zero, as it drew (FILE:"),
    ("layout", "draw(self, scenario, rng)", "raise SystemExit(0)", "tried to exit, as it drew"),
    ("layout", "draw(self, scenario, rng)", "return (1, 2)", "draw must return obstacles"),
    (
        "layout",
        "draw(self, scenario, rng)",
        "return 10001 * [Cylinder(shape='cylinder', position=(2, 2.5), radius=0.1)]",
        "drew 10001 obstacles; at most 10000 have room",
    ),
]


def test_whatever_it_does_is_one_line(fuzzyq: Call, tmp_path: Path) -> None:
    plugin = tmp_path / "broken.py"
    code, files = HEAD, []
    for number, (kind, method, body, _) in enumerate(CASES):
        name = f"{kind}-{number}"
        code += KINDS[kind].format(number=number, name=name, method=method, body=body)
        files.append(tmp_path / f"{name}.yaml")
        text = ROOM.replace("name: room", f"name: {name}") + ASKS[kind]
        files[-1].write_text(text.replace("NAME", name))
    plugin.write_text(code)
    told = fuzzyq("validate", *files, "--plugin", plugin)
    assert told.returncode == 2
    lines = told.stderr.splitlines()
    assert len(lines) == len(CASES), told.stderr
    for file, line, (kind, _, _, words) in zip(files, lines, CASES, strict=True):
        drawn = kind == "layout" and "conflicts" not in words
        assert line.startswith(f"error: {file.stem if drawn else file}:"), line
        assert f"{kind} {file.stem}: " in line
        assert words.replace("FILE", str(plugin)) in line


MOVED = """
@register_motion
class Gone(Motion):
    kind: Literal["gone"]
    def pose(self, time): return Pose(0, 0, 0)
    def moved(self, x, y, turn): pass
"""


def test_a_motion_that_cannot_be_moved_is_one_line(fuzzyq: Call, tmp_path: Path) -> None:
    plugin, room = tmp_path / "gone.py", tmp_path / "room.yaml"
    plugin.write_text(HEAD + MOVED)
    elsewhere = ROOM.replace("{size: [4.0, 3.0]}", "{size: [5.0, 4.0], origin: [-1.0, -1.0]}")
    drawn = "random: {count: 1, radius: 0.1}\n"
    room.write_text(elsewhere + MOTION.replace("NAME", "gone") + drawn)
    told = fuzzyq("validate", room, "--plugin", plugin)
    assert told.returncode == 2
    [line] = told.stderr.splitlines()
    assert "motion gone: moved must return a motion, not a NoneType" in line
