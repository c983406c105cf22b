"""What cannot be right about a scenario although every value is: overlaps, walls, no way to start.

Algorithm 2 exists because "the starting point or end point may overlap with obstacles"; this is
its test, for obstacles from any source.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TypeAlias

import numpy as np

from fuzzyq_bullet.blame import blamed
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning.base import LONGEST_STRIDE
from fuzzyq_bullet.quantities import TOUCH
from fuzzyq_bullet.reading.problems import Loc, first_lines, key_path
from fuzzyq_bullet.scenario.layouts.placing import separated
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.motion_checks import motion_conflicts
from fuzzyq_bullet.scenario.movers import moves
from fuzzyq_bullet.scenario.places import Arena, Bounds, Goal, Start, Via
from fuzzyq_bullet.shapes import Obstacle

Conflict: TypeAlias = tuple[Loc, str]


def find_conflicts(scenario: Scenario) -> list[Conflict]:
    """Return what stands in the way of running the scenario: places and messages, none if well.

    Conflicts are: a planner that needs wheels in the kinematic drive; a robot taller than the
    headroom of the arena; start or goal outside the arena; the robot's disc at the start, or at the
    centre of the goal or of a via point, touching a wall or an obstacle; a start within the first
    via point, or within the goal if there is none (a run of no steps, with no shortest path to
    measure it by); a via point around the centre of the one before it; an obstacle wholly outside
    the walls; obstacles to be drawn that are too large for the arena or too many; a motion that
    begins inside something, or is too fast; a sensor that sees less far than the longest step of
    the controller. Obstacles may overlap each other and poke through walls.
    """
    obstacles = _obstacles(scenario)
    # What is wholly outside begins in a wall, which need not be said as well.
    outside = {loc[:2] for loc, _ in obstacles if loc[0] == "obstacles" and loc[2:]}
    return [
        *_drive(scenario),
        *_headroom(scenario),
        *_places(scenario),
        *_range(scenario),
        *obstacles,
        *(one for one in motion_conflicts(scenario) if one[0][:2] not in outside),
        *_random(scenario),
        *_noise(scenario),
    ]


def check(scenario: Scenario) -> None:
    """Make sure that a scenario can be run.

    Raises:
        UserError: If it cannot, with one line for each conflict.
    """
    conflicts = find_conflicts(scenario)
    if conflicts:
        lines = [f"{scenario.name}: {key_path(loc)}: {why}" for loc, why in conflicts]
        raise UserError(*first_lines(lines, scenario.name))


def _drive(scenario: Scenario) -> list[Conflict]:
    planner = scenario.planner
    if scenario.drive == "wheels" or not planner.needs_wheels:
        return []
    return [(("drive",), f"the planner {planner.name} needs wheels, not {scenario.drive}")]


def _headroom(scenario: Scenario) -> list[Conflict]:
    headroom, height = scenario.arena.headroom, scenario.robot.spec.height
    if headroom is None or height <= headroom + TOUCH:
        return []
    robot = Path(scenario.robot.model).name
    why = (
        f"the robot {robot} is {height:g} m tall, and the obstacles leave out what it could touch "
        f"above {headroom:g} m; import the map again with --robot {robot}"
    )
    return [(("arena", "headroom"), why)]


def _places(scenario: Scenario) -> list[Conflict]:
    found: list[Conflict] = []
    left, bottom, right, top = scenario.arena.bounds
    for _, key, place in _named(scenario):
        x, y = place.position
        gap = min(x - left, right - x, y - bottom, top - y)
        if gap < 0.0:
            found.append(
                ((*key, "position"), f"({x:g}, {y:g}) is outside {_in_words(scenario.arena)}")
            )
        elif scenario.arena.walls and gap <= scenario.robot.radius + TOUCH:
            found.append(
                (
                    (*key, "position"),
                    f"is {gap:.3g} m from a wall; {_remedy(gap, scenario.robot.radius)}",
                )
            )
    apart = float(np.hypot(*np.subtract(scenario.start.position, scenario.goal.position)))
    if not scenario.via and apart <= scenario.goal.radius:
        found.append(
            (
                ("start", "position"),
                f"is within the goal already: {apart:.3g} m from its centre, radius "
                f"{scenario.goal.radius:g} m",
            )
        )
    for i, via in enumerate(scenario.via):
        before = scenario.via[i - 1] if i else scenario.start
        apart = math.dist(before.position, via.position)
        if apart <= via.radius:
            found.append(
                (
                    ("via", i, "position"),
                    f"is passed at once: its centre is {apart:.3g} m from that of "
                    f"{f'via[{i - 1}]' if i else 'the start'}, its radius {via.radius:g} m",
                )
            )
    return found


def _named(scenario: Scenario) -> list[tuple[str, Loc, Start | Via | Goal]]:
    """Return the places of a scenario, with what they are called and where their keys are."""
    via: list[tuple[str, Loc, Start | Via | Goal]] = [
        (f"via point {i + 1}", ("via", i), one) for i, one in enumerate(scenario.via)
    ]
    ends: list[tuple[str, Loc, Start | Via | Goal]] = [
        ("start", ("start",), scenario.start),
        ("goal", ("goal",), scenario.goal),
    ]
    return [*ends, *via]


def _obstacles(scenario: Scenario) -> list[Conflict]:
    field, radius = Field.of(scenario.obstacles), scenario.robot.radius
    by_index: dict[int, Conflict] = {}
    at_via: dict[Loc, Conflict] = {}
    # Of several places in one obstacle the start is told, then the goal; a via point by itself.
    for name, key, place in reversed(_named(scenario)):
        x, y = place.position
        gaps = field.distances(place.position)
        for i in np.flatnonzero(gaps <= radius + TOUCH).tolist():
            if moves(scenario.obstacles[i]):  # it may go there, and begin elsewhere
                continue
            where = f"{-gaps[i]:.3g} m inside" if gaps[i] < 0 else f"{gaps[i]:.3g} m from"
            if key[0] == "via":
                loc = (*key, "position")
                message = f"is {where} obstacles[{i}], a {scenario.obstacles[i].shape}; "
                at_via.setdefault(loc, (loc, message + _remedy(gaps[i], radius)))
                continue
            where += " it"
            message = f"overlaps the {name} at ({x:g}, {y:g}), which is {where}; "
            message += _remedy(gaps[i], radius)
            by_index[i] = (("obstacles", i), message)
    if scenario.arena.walls:
        for i, item in enumerate(scenario.obstacles):
            if _is_outside(item, scenario.arena.bounds):
                by_index[i] = (
                    ("obstacles", i, "position"),
                    f"is wholly outside the walls of {_in_words(scenario.arena)}",
                )
    return [*(by_index[i] for i in sorted(by_index)), *reversed(at_via.values())]


def _range(scenario: Scenario) -> list[Conflict]:
    wrong = range_conflict(scenario)
    return [] if wrong is None else [(("sensor", "range"), wrong)]


def range_conflict(scenario: Scenario) -> str | None:
    """Return what is wrong with a range in which the controller's longest step does not end."""
    least = LONGEST_STRIDE * scenario.robot.radius
    if scenario.sensor_range >= least:
        return None
    return (
        f"must be at least {least:g} m, the longest step of a robot of radius "
        f"{scenario.robot.radius:g} m, got {scenario.sensor_range:g}"
    )


def _random(scenario: Scenario) -> list[Conflict]:
    if scenario.random is None:
        return []
    drawn = scenario.random
    try:
        with blamed(f"layout {drawn.layout}", "in conflicts"):
            found: list[Conflict] = [
                (("random", *loc), why) for loc, why in drawn.conflicts(scenario)
            ]
    except UserError as error:
        found = [(("random",), str(error))]
    if drawn.movers is not None:
        moving = drawn.movers.conflicts(scenario)
        found += [(("random", "movers", key), why) for key, why in moving]
    return found


def _in_words(arena: Arena) -> str:
    """Say where the arena is."""
    width, depth = arena.size
    where = f" from ({arena.origin[0]:g}, {arena.origin[1]:g})" if any(arena.origin) else ""
    return f"the arena, {width:g} × {depth:g} m{where}"


def _noise(scenario: Scenario) -> list[Conflict]:
    """Return what of the sensor's noise leaves nothing to be seen."""
    sensor, far = scenario.sensor, scenario.sensor_range
    return [
        (("sensor", key), f"must be less than the range of the sensor, {far:g} m; got {value:g}")
        for key, value in (
            ("noise", sensor.noise),
            ("quantisation", sensor.quantisation),
            ("blind", sensor.blind),
        )
        if value >= far
    ]


def _is_outside(item: Obstacle, bounds: Bounds) -> bool:
    """Tell whether no part of an obstacle is inside the arena (exactly)."""
    points, radius = item.corners()
    low, high = points.min(axis=0), points.max(axis=0)
    left, bottom, right, top = bounds
    if len(points) == 1:
        (x, y), *_ = points.tolist()
        beside_x, beside_y = max(left - x, x - right, 0.0), max(bottom - y, y - top, 0.0)
        return math.hypot(beside_x, beside_y) >= radius
    if left < low[0] < right and bottom < low[1] < top and high[0] < right and high[1] < top:
        return False
    arena = np.array(bounds.corners)
    return all(separated(arena, piece) for piece in item.pieces())


def _remedy(gap: float, radius: float) -> str:
    """Say how far to move what leaves the robot's centre this gap (m), negative inside it."""
    lacking = max(round(radius - gap, 3), 0.001)
    return f"the robot needs more than {radius:g} m: move it by more than {lacking:g} m"
