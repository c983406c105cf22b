"""Whether there is a way, among more obstacles than the tangent graph can hold.

What the disc's centre may not enter is united into areas, and what remains falls into regions. Arcs
become chords here: a gap that is too narrow by no more than about 0.1 mm counts as open.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fuzzyq_bullet.quantities import TOUCH
from fuzzyq_bullet.scenario.models import Scenario

_CHORDS = 48
"""Of a quarter of a circle: they stray from it by 1.3e-4 of its radius."""
_BEYOND = 1.0
"""Room (m) that is left round everything where there are no walls."""


def has_open_space(scenario: Scenario, radius: float | None = None) -> bool:
    """Return whether a disc gets from the start to the goal disc, to about 0.1 mm.

    Args:
        scenario: A realised scenario.
        radius: Radius of the disc (m); by default the robot's.
    """
    import shapely  # only who has very many obstacles waits for it to load

    radius = scenario.robot.radius if radius is None else radius
    told = [one.corners() for one in scenario.standing]
    bare = [
        shapely.Polygon(points) if len(points) > 2 else shapely.MultiPoint(points).convex_hull
        for points, _ in told
    ]
    grown = shapely.buffer(bare, [own + radius for _, own in told], quad_segs=_CHORDS)
    blocked: Any = shapely.union_all(grown)
    start, goal = (shapely.Point(one.position) for one in (scenario.start, scenario.goal))
    if scenario.arena.walls:
        left, bottom, right, top = scenario.arena.bounds
        ground = shapely.box(left + radius, bottom + radius, right - radius, top - radius)
    else:
        everything = shapely.GeometryCollection([blocked, start, goal])
        left, bottom, right, top = everything.bounds
        ground = shapely.box(left - _BEYOND, bottom - _BEYOND, right + _BEYOND, top + _BEYOND)
    regions = shapely.get_parts(ground.difference(blocked))
    around_start = regions[shapely.distance(regions, start) <= TOUCH]
    reached = shapely.distance(around_start, goal) <= scenario.goal.radius
    return bool(np.any(reached))
