"""From a foreign map to a scenario: the part that is kept, the arena, start and goal."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import MAX_OBSTACLES, MIN_RADIUS
from fuzzyq_bullet.scenario.importers.foreign import (
    FAR,
    ForeignMap,
    ImportOptions,
    Obstacle,
    too_many,
)
from fuzzyq_bullet.scenario.importers.refusals import no_places, refuse_places
from fuzzyq_bullet.scenario.importers.room import Room
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.places import Bounds
from fuzzyq_bullet.shapes.outlines import LEAST_AREA

_NANO = 9
"""Decimals of a metre to which outlines of maps are rounded: no edge moves by more than 1 nm."""
_MARGIN = 1.0
"""Free space about start and goal in a world without walls (m)."""
_USUAL_TIME = 120.0
_LONGEST_TIME = 3600.0


def scenario_of(path: Path, found: ForeignMap, options: ImportOptions) -> Scenario:
    """Return the scenario of a foreign map.

    Raises:
        UserError: If it has too many obstacles, is too large, nobody says where to start and to
            go, or the robot cannot be there.
        ValidationError: If an obstacle is none.
    """
    bounds = found.bounds
    obstacles = [rounded(one) for one in found.obstacles]
    if options.crop is not None:
        bounds = _cropped(path, bounds, options.crop)
        obstacles = [part for one in obstacles for part in cropped(one, bounds)]
    start = options.start or found.start
    heading = options.heading if options.start else found.heading
    goal = options.goal or found.goal
    if not found.walls and options.crop is None:
        bounds = _around(bounds, start, goal)
    _refuse_large(path, bounds, len(obstacles))
    left, bottom, right, top = (round(edge, _NANO) for edge in bounds)
    data: dict[str, Any] = {
        "name": re.sub(r"[^A-Za-z0-9._-]+", "-", path.stem).lstrip("._-")[:100] or "map",
        "description": f"Imported from {path.name}."[:2000],
        "arena": {
            "origin": (left, bottom),
            "size": (round(right - left, _NANO), round(top - bottom, _NANO)),
            "walls": found.walls,
            "headroom": None if found.headroom is None else round(found.headroom, _NANO),
        },
        "obstacles": obstacles,
        "robot": options.robot_keys(),
    }
    anywhere = (left, bottom)
    data["start"] = {"position": start or anywhere, "heading": heading}
    data["goal"] = {"position": goal or anywhere}
    scenario = Scenario.model_validate(data)
    room = Room(scenario)
    refuse_places(path, scenario, options, (start, goal))
    if start is None or goal is None:
        raise no_places(path, room, start, goal)
    seconds = 3 * room.way(start, goal) / scenario.robot.max_speed
    time = float(math.ceil(min(max(_USUAL_TIME, seconds), _LONGEST_TIME)))
    limits = scenario.limits.model_copy(update={"time": time})
    return scenario.model_copy(update={"limits": limits})


def _around(bounds: Bounds, *places: tuple[float, float] | None) -> Bounds:
    """Return bounds with places in them: a world without walls goes on beyond what stands in it."""
    left, bottom, right, top = bounds
    for x, y in (place for place in places if place is not None):
        left, right = min(left, x - _MARGIN), max(right, x + _MARGIN)
        bottom, top = min(bottom, y - _MARGIN), max(top, y + _MARGIN)
    return Bounds(left, bottom, right, top)


def asked_for(path: Path, scenario: Scenario, options: ImportOptions) -> Scenario:
    """Return a scenario with the start, the goal, the part and the robot that are asked for.

    Raises:
        UserError: If the part lies outside it, or the robot cannot be at a place.
        ValidationError: If any of them cannot be.
    """
    data = scenario.model_dump(mode="python")
    if options.start is not None:
        data["start"] = {"position": options.start, "heading": options.heading}
    if options.goal is not None:
        data["goal"] = {**data["goal"], "position": options.goal}
    if options.robot is not None:
        data["robot"] = options.robot_keys()
    if options.crop is not None:
        left, bottom, right, top = _cropped(path, scenario.arena.bounds, options.crop)
        part = Bounds(left, bottom, right, top)
        data["arena"] = {
            **data["arena"],
            "origin": (left, bottom),
            "size": (right - left, top - bottom),
        }
        data["obstacles"] = [p for one in data["obstacles"] for p in cropped(one, part)]
    if options == ImportOptions():
        return scenario
    made = Scenario.model_validate(data)
    refuse_places(path, made, options, (made.start.position, made.goal.position))
    return made


def rounded(one: Obstacle) -> Obstacle:
    """Return an obstacle with its lengths rounded to a nanometre, so that they can be read."""

    def plain(value: Any) -> Any:
        if isinstance(value, float):
            return round(value, _NANO) + 0.0
        if isinstance(value, list | tuple):
            return tuple(plain(item) for item in value)
        return value

    return {key: plain(value) for key, value in one.items()}


def cropped(one: Obstacle, part: Bounds) -> list[Obstacle]:
    """Return what an obstacle is within a part of the map.

    Boxes and polygons are cut at its edge, unless what remains would be too thin. Others that
    reach into it stay whole: obstacles may stand in the walls of the arena.
    """
    import shapely

    window = shapely.box(*part)
    outline: Any
    if one["shape"] == "polygon":
        outline = shapely.Polygon(one["points"])
    elif one["shape"] == "box":
        (x, y), (length, width), yaw = one["position"], one["size"], one.get("yaw", 0.0)
        corners = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) * (length / 2, width / 2)
        cos, sin = math.cos(yaw), math.sin(yaw)
        outline = shapely.Polygon(corners @ np.array([[cos, sin], [-sin, cos]]) + (x, y))
    elif "radius" in one:
        outline = shapely.Point(one["position"]).buffer(one["radius"])
    else:
        return [one]
    if outline.within(window):
        return [one]
    within = outline.intersection(window)
    pieces = [piece for piece in shapely.get_parts(within) if piece.area > 0.0]
    if one["shape"] not in ("polygon", "box") or not pieces:
        return [one] if pieces else []
    if any(p.area < LEAST_AREA or shapely.minimum_clearance(p) < MIN_RADIUS for p in pieces):
        return [one]
    return [
        rounded({"shape": "polygon", "points": tuple(map(tuple, _corners(piece)))})
        for piece in pieces
    ]


def _corners(piece: Any) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in piece.exterior.coords[:-1]]


def _cropped(path: Path, bounds: Bounds, crop: Bounds) -> Bounds:
    """Return the part of the bounds that the crop leaves.

    Raises:
        UserError: If it leaves none.
    """
    left, bottom = max(bounds.left, crop.left), max(bounds.bottom, crop.bottom)
    right, top = min(bounds.right, crop.right), min(bounds.top, crop.top)
    if right <= left or top <= bottom:
        raise UserError(f"--crop: leaves nothing of {path}, which has {bounds}")
    return Bounds(left, bottom, right, top)


def _refuse_large(path: Path, bounds: Bounds, count: int) -> None:
    if count > MAX_OBSTACLES:
        raise UserError(too_many(path, count))
    width, depth = bounds.right - bounds.left, bounds.top - bounds.bottom
    if max(width, depth, *map(abs, bounds)) > FAR:
        raise UserError(
            f"{path}: the map has {bounds}; coordinates and sides of an arena are at most "
            f"{FAR:g} m: take a part with --crop X0,Y0,X1,Y1"
        )
