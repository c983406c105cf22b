"""Whether drawn obstacles may stand where they are: clear of start and goal, inside, a way left."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.occupancy import OccupancyGrid
from fuzzyq_bullet.quantities import TOUCH
from fuzzyq_bullet.shapes import Obstacle

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from fuzzyq_bullet.geometry import Floats
    from fuzzyq_bullet.scenario.models import Scenario

_STEP = 0.05
"""Distance of the places (m) among which ``leaves_a_way`` looks for one, in a usual arena."""
_MOST_PLACES = 250_000
_OUTSIDE = 2.0
"""How far (m) beyond an arena without walls it looks."""


def kept_clear(scenario: Scenario, margin: float) -> list[tuple[tuple[float, float], float]]:
    """Return centres and radii (m) of the discs that drawn obstacles keep out of."""
    robot = scenario.robot.radius
    discs = (
        (scenario.start.position, robot),
        (scenario.goal.position, max(scenario.goal.radius, robot)),
    )
    return [(centre, radius + margin + 2 * TOUCH) for centre, radius in discs]


def is_clear(scenario: Scenario, obstacles: Sequence[Obstacle], margin: float) -> bool:
    """Tell whether obstacles keep that margin (m) to the robot at the start and to the goal."""
    field = Field.of(obstacles)
    return all(field.nearest(centre)[1] > radius for centre, radius in kept_clear(scenario, margin))


def is_inside(obstacle: Obstacle, size: tuple[float, float]) -> bool:
    """Tell whether an obstacle lies wholly within an arena of that size (m)."""
    points, reach = obstacle.corners()
    low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
    return bool(np.all(low >= -TOUCH) and np.all(high <= np.array(size) + TOUCH))


def separated(first: Floats, second: Floats) -> bool:
    """Tell whether two convex polygons, shape (K, 2), share no more than an edge (exactly)."""
    return _lies_beyond(first, second) or _lies_beyond(second, first)


def _lies_beyond(first: Floats, second: Floats) -> bool:
    """Tell whether all of the second lies beyond some side of the first, or beyond its opposite."""
    for side in np.roll(first, -1, axis=0) - first:
        across = np.array([-side[1], side[0]])
        along, other = first @ across, second @ across
        if other.min() >= along.max() or other.max() <= along.min():
            return True
    return False


def leaves_a_way(scenario: Scenario, obstacles: Sequence[Obstacle]) -> bool:
    """Tell whether the robot can surely get from start to goal among all obstacles.

    Looks on a grid and is careful: what it finds is a way, but it may miss one that is hardly
    wider than the robot.
    """
    from scipy.ndimage import label  # only who draws obstacles waits for it to load

    (left, bottom, right, top), (width, depth) = scenario.arena.bounds, scenario.arena.size
    outside = 0.0 if scenario.arena.walls else _OUTSIDE
    step = max(_STEP, math.sqrt((width + 2 * outside) * (depth + 2 * outside) / _MOST_PLACES))
    grid = OccupancyGrid.over(
        (left - outside, bottom - outside), (right + outside, top + outside), step
    )
    places = grid.points()
    field = Field.of([*scenario.obstacles, *obstacles], scenario.arena)
    clearance = field.clearance(places.reshape(-1, 2)).reshape(grid.free.shape)
    # Half a step from either of two neighbours, that much clearance is left over.
    grid.free[:] = clearance >= scenario.robot.radius + step / 2
    regions, _ = label(grid.free)
    ends = [
        _regions_at(
            np.array(place.position),
            scenario.robot.radius,
            field,
            places,
            clearance,
            regions,
            3 * step,
        )
        for place in (scenario.start, scenario.goal)
    ]
    return bool(ends[0] & ends[1])


def _regions_at(
    point: Floats,
    radius: float,
    field: Field,
    places: Floats,
    clearance: Floats,
    regions: NDArray[np.intp],
    reach: float,
) -> set[int]:
    """Return the regions of places to which there is a short straight way from a point."""
    apart = np.linalg.norm(places - point, axis=-1)
    # Along a line of length L between clearances a and b, it is nowhere less than (a + b − L) / 2.
    least = (clearance + field.clearance(point[None])[0] - apart) / 2
    return set(np.unique(regions[(apart <= reach) & (regions > 0) & (least >= radius)]))
