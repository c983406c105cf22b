"""What cannot be right about how obstacles move: ways that begin in something, or are too fast."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.quantities import TOUCH
from fuzzyq_bullet.reading.problems import Loc
from fuzzyq_bullet.scenario.layouts.placing import separated
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.movers import courses_of, fastest, standing_field
from fuzzyq_bullet.shapes import Pose, Shape
from fuzzyq_bullet.shapes.motion import MAX_MOTION_SPEED, placed, seen_from

_ROUNDING = 1e-3


def motion_conflicts(scenario: Scenario) -> list[tuple[Loc, str]]:
    """Return what is wrong with the motions of a scenario: places and messages.

    Conflicts are: an obstacle that begins inside one that stands, a wall or the robot; one that is
    faster than 3 m/s; whatever a motion itself finds.
    """
    moving = scenario.movers
    if not moving:
        return []
    field = standing_field(scenario.obstacles, scenario.arena)
    found: list[tuple[Loc, str]] = []
    for i in moving:
        item = scenario.obstacles[i]
        for key, why in item.motion.conflicts(item, field):
            found.append((("obstacles", i, "motion", key), why))
    told = {loc[1] for loc, _ in found}
    courses = courses_of(scenario.obstacles, scenario.arena, scenario.seed)
    for i, course in courses.items():
        if i in told:
            continue
        shape, first = scenario.obstacles[i], course.pose(0.0)
        found += [(("obstacles", i, "motion"), why) for why in _begins(scenario, shape, first)]
        if (fast := fastest(course, 0.0, scenario.limits.time)) > MAX_MOTION_SPEED + _ROUNDING:
            why = f"moves at {fast:.2f} m/s; at most {MAX_MOTION_SPEED:g} m/s"
            found.append((("obstacles", i, "motion"), why))
    return found


def _begins(scenario: Scenario, shape: Shape, pose: Pose) -> Iterator[str]:
    """Yield in what a moving obstacle begins: one line at most."""
    x, y = shape.position
    at = (x + pose[0], y + pose[1], pose[2])
    gap = float(
        Field.of([shape]).clearance(seen_from(scenario.start.position, shape.position, at))[0]
    )
    if gap <= scenario.robot.radius + TOUCH:
        yield (
            f"begins {max(gap, 0.0):.3g} m from the start; the robot needs more than "
            f"{scenario.robot.radius:g} m"
        )
        return
    moving = set(scenario.movers)
    own = [placed(piece, shape.position, at) for piece in shape.pieces()]
    extent, here = shape.extent(), at[:2]
    for j, other in enumerate(scenario.obstacles):
        if j in moving or math.dist(here, other.position) > extent + other.extent():
            continue
        theirs = other.pieces()
        if any(not separated(a, b) for a in own for b in theirs):
            yield f"begins inside obstacles[{j}], which stands still, at ({at[0]:g}, {at[1]:g})"
            return
    if scenario.arena.walls:
        left, bottom, right, top = scenario.arena.bounds
        points, radius = shape.corners()
        low, high = (f(placed(points, shape.position, at), axis=0) for f in (np.min, np.max))
        inside = (low - radius >= (left, bottom)).all() and (high + radius <= (right, top)).all()
        if not inside:
            yield f"begins in a wall, at ({at[0]:g}, {at[1]:g})"
