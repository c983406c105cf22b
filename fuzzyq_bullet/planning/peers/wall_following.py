"""Going along an obstacle: what `tangent-bug` and the escapes of `apf` share."""

from __future__ import annotations

import math

from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.ray_search import FreeHeading, eased, ray_search
from fuzzyq_bullet.planning.scan import Point

SHORTER = (1.0, 0.5, 0.25)
"""Where nothing is as free as it should be, these parts of it are enough."""


def free_heading(
    observation: Observation, start: float, side: int, enough: float, limit: float = math.tau
) -> FreeHeading | None:
    """Return the first heading to a side that is free enough, turned a little off the edge.

    Args:
        observation: What the robot senses.
        start: Heading to turn from (rad).
        side: +1 to the left, -1 to the right.
        enough: What should be free for the usual robot (m); less if nothing is.
        limit: How far to turn (rad).
    """
    for part in SHORTER:
        wanted = part * enough * observation.size
        found = ray_search(observation.sense, start, side, wanted, limit)
        if found is not None:
            return eased(observation.sense, found, side, wanted)
    return None


def follow_wall(
    observation: Observation, contact: Point, side: int, enough: float
) -> tuple[float, Point] | None:
    """Return the heading (rad) along an obstacle, and the next point (m) that stops the robot.

    From the point that stopped it last, a ray turns to one side until it is free. So the obstacle
    stays on the other side, round inner and outer corners.

    Args:
        observation: What the robot senses.
        contact: A point of the obstacle (m), world frame.
        side: +1 if the ray turns left: the obstacle stays on the right; -1 the other way round.
        enough: What should be free along the heading (m).
    """
    start, _ = towards(observation.position, contact)
    found = free_heading(observation, start, side, enough)
    if found is None:
        return None
    if found.blocked is not None:
        heading, free = found.blocked
        contact = ahead(observation.position, heading, free + observation.radius)
    return found.heading, contact


def towards(start: Point, point: Point) -> tuple[float, float]:
    """Return the heading (rad) and the distance (m) from one point to another."""
    x, y = point[0] - start[0], point[1] - start[1]
    return math.atan2(y, x), math.hypot(x, y)


def ahead(start: Point, heading: float, distance: float) -> Point:
    """Return the point at a distance (m) along a heading (rad)."""
    return start[0] + distance * math.cos(heading), start[1] + distance * math.sin(heading)
