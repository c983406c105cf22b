"""The true distance to the goal from everywhere, on a grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from fuzzyq_bullet.geometry import Field, Floats
from fuzzyq_bullet.occupancy import SIXTEEN, OccupancyGrid
from fuzzyq_bullet.scenario.models import Scenario

CELL = 0.05
"""Side of a cell (m)."""
SPARE = 0.01
"""How much wider (m) than the robot the disc is that must fit, where nothing else is said."""


class DistanceField:
    """The true distance to the goal from everywhere: the lengths of the shortest paths.

    No planner ever sees it, but a reward may know more than who is rewarded. By the straight
    distance, a step into a dead end looks as good as a step towards the goal, and the mistake only
    shows many decisions later.

    Args:
        scenario: A realised scenario.
        room: Radius (m) of the disc that must fit; by default a little more than the robot's.
    """

    def __init__(self, scenario: Scenario, room: float | None = None) -> None:
        if room is None:
            room = scenario.robot.spec.radius + SPARE
        left, bottom, right, top = scenario.arena.bounds
        self._low = left, bottom
        grid = OccupancyGrid.over((left, bottom), (right, top), CELL)
        points = grid.points()
        field = Field.of(scenario.standing, scenario.arena)
        grid.free[:] = (field.clearance(points.reshape(-1, 2)) >= room).reshape(grid.free.shape)
        at_goal = np.hypot(*np.moveaxis(points - scenario.goal.position, 2, 0))
        source = np.unravel_index(np.where(grid.free, at_goal, np.inf).argmin(), at_goal.shape)
        lengths = grid.distances((int(source[0]), int(source[1])), SIXTEEN, past_corners=True)
        known = np.isfinite(lengths)
        # Where no disc fits there is no robot, but the cells beside interpolate with these.
        lengths[~known] = at_goal[~known] + (lengths[known].max() if known.any() else 0.0)
        self._lengths = _spread(lengths, known)

    def at(self, x: float, y: float) -> float:
        """Return the length of the shortest path from a point (m)."""
        at = [[(x - self._low[0]) / CELL], [(y - self._low[1]) / CELL]]
        [length] = map_coordinates(self._lengths, at, order=1, mode="nearest")
        return float(length)


def _spread(lengths: Floats, known: NDArray[np.bool_]) -> Floats:
    """Give every cell without a path the least length around it, four cells deep."""
    lengths, known = lengths.copy(), known.copy()
    for _ in range(4):
        padded = np.pad(np.where(known, lengths, np.inf), 1, constant_values=np.inf)
        windows = np.lib.stride_tricks.sliding_window_view(padded, (3, 3))
        least = windows.min(axis=(2, 3))
        new = ~known & np.isfinite(least)
        lengths[new] = least[new] + CELL
        known |= new
    return lengths
