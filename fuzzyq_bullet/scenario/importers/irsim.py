"""Worlds of the simulator ir-sim: YAML files with ``world``, ``robot`` and ``obstacle``."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario.importers.foreign import THIN, ForeignMap, Obstacle, rectangle
from fuzzyq_bullet.scenario.importers.registry import register_importer
from fuzzyq_bullet.scenario.importers.yaml_keys import Mapping, keys_in, read_yaml
from fuzzyq_bullet.scenario.places import Bounds

_SHAPES = ("circle", "rectangle", "polygon", "linestring")
_FAR = 1e6


def _is_world(path: Path) -> bool:
    keys = keys_in(path)
    return "world" in keys and bool(keys & {"robot", "obstacle"})


@register_importer(".yaml", ".yml", claims=_is_world)
def world(path: Path) -> ForeignMap:
    """Read a world; start and goal are those of its first robot."""
    given = read_yaml(path, "a world of ir-sim")
    size = given.inner("world")
    width = size.number("width", 10.0, least=0.1, most=_FAR)
    height = size.number("height", 10.0, least=0.1, most=_FAR)
    x, y = size.numbers("offset", 2, 2) if "offset" in size else (0.0, 0.0)
    found = ForeignMap(Bounds(x, y, x + width, y + height), walls=False)
    if size.get("obstacle_map") is not None:
        found.left_out.append("world.obstacle_map: import that picture by itself")
    for i, robot in enumerate(given.items("robot")):
        _robot(found, robot, first=i == 0)
    for one in given.items("obstacle"):
        _obstacles(found, one)
    if "gui" in given:
        found.left_out.append("gui: how a world is drawn")
    return found


def _robot(found: ForeignMap, robot: Mapping, *, first: bool) -> None:
    if not first or robot.number("number", 1, least=0) > 1:
        found.left_out.append(f"line {robot.at('state')}: only the first robot drives")
        if not first:
            return
    if "state" in robot:
        x, y, *heading = _first(robot, "state")
        found.start, found.heading = (x, y), heading[0] if heading else None
    if "goal" in robot:
        x, y, *_ = _first(robot, "goal")
        found.goal = (x, y)
    for key in ("shape", "kinematics", "behavior", "sensors"):
        if key in robot:
            found.left_out.append(f"robot.{key}: the robot is that of the scenario (--robot)")


def _first(one: Mapping, key: str) -> list[float]:
    """Return a state, or the first of a list of them."""
    value = one.get(key)
    if isinstance(value, list) and value and isinstance(value[0], list):
        return one.inner(key).numbers(0, 2, 6)
    return one.numbers(key, 2, 6)


def _obstacles(found: ForeignMap, one: Mapping) -> None:
    distribution = one.get("distribution")
    name = distribution.get("name") if isinstance(distribution, dict) else distribution
    if name not in (None, "manual"):
        found.left_out.append(f"line {one.at('distribution')}: drawn by chance, so not in the file")
        return
    if any(key in one for key in ("behavior", "velocity", "goal")):
        found.changed.append(f"line {one.at('state')}: may move there, and stands still here")
    states = _states(one)
    shapes = one.items("shape") if "shape" in one else []
    if not shapes:
        raise UserError(f"{one.where('shape')}: expected {{name: circle, radius: R}} or the like")
    for i, (x, y, yaw) in enumerate(states):
        shape = shapes[min(i, len(shapes) - 1)]
        for obstacle, note in _placed(shape, x, y, yaw):
            found.obstacles.append(obstacle)
            if note:
                found.changed.append(note)


def _states(one: Mapping) -> list[tuple[float, float, float]]:
    value = one.get("state")
    if value is None:
        return [(0.0, 0.0, 0.0)]
    rows: list[list[float]]
    if isinstance(value, list) and value and isinstance(value[0], list):
        inner = one.inner("state")
        rows = [inner.numbers(i, 2, 6) for i in range(len(value))]
    else:
        rows = [one.numbers("state", 2, 6)]
    return [(row[0], row[1], row[2] if len(row) > 2 else 0.0) for row in rows]


def _placed(shape: Mapping, x: float, y: float, yaw: float) -> list[tuple[Obstacle, str]]:
    """Return an obstacle's parts at a place, with a note where one had to be grown."""
    kind = shape.one_of("name", _SHAPES, "circle")
    cos, sin = math.cos(yaw), math.sin(yaw)

    def there(px: float, py: float) -> tuple[float, float]:
        return x + cos * px - sin * py, y + sin * px + cos * py

    if kind == "circle":
        radius = shape.number("radius", 0.2, least=1e-6, most=_FAR)
        note = f"line {shape.at('radius')}: grown to {THIN:g} m" if radius < THIN else ""
        one: dict[str, Any] = {"shape": "cylinder", "position": (x, y)}
        return [({**one, "radius": max(radius, THIN)}, note)]
    if kind == "rectangle":
        size = [shape.number(key, 1.0, least=1e-6, most=_FAR) for key in ("length", "width")]
        made, grown = rectangle((x, y), (size[0], size[1]), yaw)
        return [(made, f"line {shape.at('width')}: grown to {THIN:g} m" if grown else "")]
    if not isinstance(shape.get("vertices"), list):
        raise UserError(f"{shape.where('vertices')}: expected a list of points [x, y]")
    inner = shape.inner("vertices")
    points = [there(*inner.numbers(i, 2, 2)) for i in range(len(inner.node.data))]
    if kind == "polygon":
        return [({"shape": "polygon", "points": points}, "")]
    parts: list[tuple[Obstacle, str]] = []
    for (ax, ay), (bx, by) in pairwise(points):
        length, turn = math.hypot(bx - ax, by - ay), math.atan2(by - ay, bx - ax)
        middle = ((ax + bx) / 2, (ay + by) / 2)
        note = "" if parts else f"line {shape.at('vertices')}: lines become {THIN:g} m thick"
        parts.append((rectangle(middle, (length, 0.0), turn)[0], note))
    return parts
