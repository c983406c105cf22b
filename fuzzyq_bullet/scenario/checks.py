"""What cannot be right about a scenario although every value is: overlaps, walls, no way to start.

Algorithm 2 exists because "the starting point or end point may overlap with obstacles"; this is
its test, for obstacles from any source.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.problems import MAX_SHOWN, Loc, key_path
from fuzzyq_bullet.quantities import TOUCH
from fuzzyq_bullet.scenario.layouts.placing import separated
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.places import Goal, Start, Via
from fuzzyq_bullet.shapes import Obstacle
from fuzzyq_bullet.shapes.motion import STILL

Conflict: TypeAlias = tuple[Loc, str]


def find_conflicts(scenario: Scenario) -> list[Conflict]:
    """Return what stands in the way of running the scenario: places and messages, none if well.

    Conflicts are: start or goal outside the arena; the robot's disc at the start, or at the centre
    of the goal or of a via point, touching a wall or an obstacle; a start within the first via
    point, or within the goal if there is none (a run of no steps, with no shortest path to measure
    it by); a via point around the centre of the one before it; an obstacle wholly outside the
    walls; obstacles to be drawn that are too large for the arena or too many; an obstacle that
    moves. Obstacles may overlap each other and poke through walls.
    """
    return [
        *_places(scenario),
        *_obstacles(scenario),
        *_motions(scenario),
        *_random(scenario),
    ]


def check(scenario: Scenario) -> None:
    """Make sure that a scenario can be run.

    Raises:
        UserError: If it cannot, with one line for each conflict.
    """
    conflicts = find_conflicts(scenario)
    if conflicts:
        lines = [f"{scenario.name}: {key_path(loc)}: {why}" for loc, why in conflicts[:MAX_SHOWN]]
        if len(conflicts) > MAX_SHOWN:
            lines.append(f"{scenario.name}: and {len(conflicts) - MAX_SHOWN} more")
        raise UserError(*lines)


def _places(scenario: Scenario) -> list[Conflict]:
    found: list[Conflict] = []
    width, depth = scenario.arena.size
    for _, key, place in _named(scenario):
        x, y = place.position
        gap = min(x, width - x, y, depth - y)
        if gap < 0.0:
            found.append(
                (
                    (*key, "position"),
                    f"({x:g}, {y:g}) is outside the arena, {width:g} × {depth:g} m",
                )
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
    # Of several places in one obstacle the start is told, then the goal.
    for name, _, place in reversed(_named(scenario)):
        x, y = place.position
        gaps = field.distances(place.position)
        for i in np.flatnonzero(gaps <= radius + TOUCH).tolist():
            where = f"{-gaps[i]:.3g} m inside it" if gaps[i] < 0 else f"{gaps[i]:.3g} m from it"
            message = f"overlaps the {name} at ({x:g}, {y:g}), which is {where}; "
            message += _remedy(gaps[i], radius)
            by_index[i] = (("obstacles", i), message)
    if scenario.arena.walls:
        width, depth = scenario.arena.size
        for i, item in enumerate(scenario.obstacles):
            if _is_outside(item, width, depth):
                by_index[i] = (
                    ("obstacles", i, "position"),
                    f"is wholly outside the walls of the arena, {width:g} × {depth:g} m",
                )
    return [by_index[i] for i in sorted(by_index)]


def _motions(scenario: Scenario) -> list[Conflict]:
    """Return the obstacles that would move: the physics cannot move them yet."""
    times = np.linspace(0.0, scenario.limits.time, 50).tolist()
    return [
        (("obstacles", i, "motion"), f"moves, and obstacles cannot move yet; allowed: {STILL.kind}")
        for i, item in enumerate(scenario.obstacles)
        if item.motion is not STILL and any(map(any, map(item.motion.pose, times)))
    ]


def _random(scenario: Scenario) -> list[Conflict]:
    if scenario.random is None:
        return []
    return [(("random", *loc), why) for loc, why in scenario.random.conflicts(scenario)]


def _is_outside(item: Obstacle, width: float, depth: float) -> bool:
    """Tell whether no part of an obstacle is inside the arena (exactly)."""
    points, radius = item.corners()
    if len(points) == 1:
        (x, y), *_ = points.tolist()
        beside_x, beside_y = max(-x, x - width, 0.0), max(-y, y - depth, 0.0)
        return math.hypot(beside_x, beside_y) >= radius
    arena = np.array([(0.0, 0.0), (width, 0.0), (width, depth), (0.0, depth)])
    return separated(arena, item.outline())


def _remedy(gap: float, radius: float) -> str:
    """Say how far to move what leaves the robot's centre this gap (m), negative inside it."""
    lacking = max(round(radius - gap, 3), 0.001)
    return f"the robot needs more than {radius:g} m: move it by more than {lacking:g} m"
