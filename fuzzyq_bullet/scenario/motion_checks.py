"""What cannot be right about how obstacles move: ways that begin in something, or are too fast."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from fuzzyq_bullet.errors import MotionError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.quantities import TOUCH
from fuzzyq_bullet.reading.problems import Loc
from fuzzyq_bullet.scenario.courses import conflicts_of, course_of, fastest, told_top_speed
from fuzzyq_bullet.scenario.layouts.placing import separated
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.movers import standing_field
from fuzzyq_bullet.shapes import Pose, Shape
from fuzzyq_bullet.shapes.motion import MAX_MOTION_SPEED, placed, seen_from

_ROUNDING = 1e-3


def motion_conflicts(scenario: Scenario) -> list[tuple[Loc, str]]:
    """Return what is wrong with the motions of a scenario: places and messages.

    Conflicts are: an obstacle that begins inside one that stands, a wall or the robot; one of which
    any part is faster than 3 m/s, or than its motion tells; a motion that raises, or whose poses
    are none; whatever a motion itself finds.
    """
    moving = scenario.movers
    if not moving:
        return []
    field = standing_field(scenario.obstacles, scenario.arena)
    found: list[tuple[Loc, str]] = []
    for i in moving:
        motion = ("obstacles", i, "motion")
        try:
            conflicts = conflicts_of(scenario.obstacles[i], field)
            found += [((*motion, key), why) for key, why in conflicts]
            if not conflicts:
                found += [(motion, why) for why in _conflicts(scenario, i, field)]
        except MotionError as error:
            found.append((motion, str(error)))
    return found


def _conflicts(scenario: Scenario, index: int, field: Field) -> Iterator[str]:
    """Yield what is wrong with the course of one obstacle.

    Raises:
        MotionError: If it has none that can be looked at.
    """
    shape, limit = scenario.obstacles[index], scenario.limits.time
    course = course_of(index, shape, field, scenario.seed)
    yield from _begins(scenario, shape, course.pose(0.0))
    told, seen = told_top_speed(shape), fastest(course, shape.extent(), limit)
    if (fast := max(seen, told or 0.0)) > MAX_MOTION_SPEED + _ROUNDING:
        part = "" if fastest(course, 0.0, limit) > MAX_MOTION_SPEED + _ROUNDING else "its edge "
        yield f"{part}moves at {fast:.2f} m/s; at most {MAX_MOTION_SPEED:g} m/s"
    elif told is not None and seen > told + _ROUNDING:
        yield f"moves at {seen:.2f} m/s, but its top_speed is {told:.2f} m/s"


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
