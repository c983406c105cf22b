"""The open path: the shortest path to the goal, with unknown space taken as free.

A robot that sees far need not drive to frontiers, because it sees most obstacles in time. It drives
along the open path and plans again after a short way (the free-space assumption: Koenig, Smirnov,
Tovey 2003).
"""

from __future__ import annotations

import numpy as np

from fuzzyq_bullet.occupancy import SIXTEEN, OccupancyGrid
from fuzzyq_bullet.planning.base import USUAL_SPEED
from fuzzyq_bullet.planning.escape.cost_to_go import ObstacleMap
from fuzzyq_bullet.planning.scan import Point

TIGHT_SPEED = 0.2
"""How fast any robot gets through a gap that is hardly wider than itself (m/s), turning on the spot
included: at full speed it could go so much farther instead."""
OWN_CELLS = 1
"""So many cells on each side of the robot's own are free, because it stands there."""
POINT_EVERY = 3
"""One of so many cells of the path becomes a point of it."""


def open_path(
    obstacles: ObstacleMap, start: Point, goal: Point, speed: float = USUAL_SPEED
) -> list[Point] | None:
    """Return the points (m) of the path, from the start to the goal.

    Args:
        obstacles: What was seen.
        start: Where the path begins (m).
        goal: Where it ends (m).
        speed: Greatest speed of the robot (m/s).

    Returns:
        None if the known obstacles leave no path.
    """
    found = obstacles.open_grid((start, goal))
    if found is None:
        return None
    grid, tight = found
    columns, rows = grid.cells(*np.array((start, goal)).T)
    (column, goal_column), (row, goal_row) = columns.tolist(), rows.tolist()
    beside = (
        slice(column - OWN_CELLS, column + OWN_CELLS + 1),
        slice(row - OWN_CELLS, row + OWN_CELLS + 1),
    )
    grid.free[beside] = True
    price = np.where(tight, max(1.0, speed / TIGHT_SPEED), 1.0)
    cells = grid.path((column, row), (goal_column, goal_row), SIXTEEN, price)
    if cells is None:
        return None
    between = [_middle(grid, cell) for cell in cells[1:]]
    return [start, *between[POINT_EVERY - 1 : -1 : POINT_EVERY], goal]


def _middle(grid: OccupancyGrid, cell: tuple[int, int]) -> Point:
    """Return the middle of a cell (m)."""
    (x, y), (column, row) = grid.low, cell
    return x + (column + 0.5) * grid.cell, y + (row + 0.5) * grid.cell
