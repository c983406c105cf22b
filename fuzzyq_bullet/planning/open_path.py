"""The shortest path to the goal that what was seen leaves open, all that was not seen for free.

A robot that sees far need not go to frontiers to look behind things: most of what stands in its way
it sees in time. It drives along this path, and looks again before it has come far.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.occupancy import SIXTEEN, OccupancyGrid
from fuzzyq_bullet.planning.cost_to_go import ObstacleMap
from fuzzyq_bullet.planning.scan import Point

NARROWER = (0.0, 0.5)
"""By how many cells less than the disc may be free on the path: the whole disc, or where it finds
no path half a cell less, as the grid may be wrong about a gap."""
STANDS = 1
"""So many cells on each side of the robot's own are free: it stands there."""
EVERY = 3
"""One of so many cells of the path is a point of it."""


def open_path(obstacles: ObstacleMap, start: Point, goal: Point) -> list[Point] | None:
    """Return the points (m) of the path, first the start and last the goal.

    Returns:
        None where what was seen leaves no path.
    """
    for narrower in NARROWER:
        grid = obstacles.free_cells((start, goal), narrower)
        if grid is None:
            return None
        columns, rows = grid.cells(*np.array((start, goal)).T)
        (column, goal_column), (row, goal_row) = columns.tolist(), rows.tolist()
        beside = slice(column - STANDS, column + STANDS + 1), slice(row - STANDS, row + STANDS + 1)
        grid.free[beside] = True
        lengths = grid.distances((goal_column, goal_row), SIXTEEN)
        if math.isfinite(lengths[column, row]):
            between = [_middle(grid, cell) for cell in _downhill(grid, lengths, (column, row))]
            return [start, *between[EVERY - 1 : -1 : EVERY], goal]
    return None


def _middle(grid: OccupancyGrid, cell: tuple[int, int]) -> Point:
    """Return the middle of a cell (m)."""
    (x, y), (column, row) = grid.low, cell
    return x + (column + 0.5) * grid.cell, y + (row + 0.5) * grid.cell


def _downhill(
    grid: OccupancyGrid, lengths: NDArray[np.float64], at: tuple[int, int]
) -> Iterator[tuple[int, int]]:
    """Yield the cells of the shortest path after one cell, by the lengths of the ways from all."""
    free, moves = grid.free, [(x * side, y * side) for x, y in SIXTEEN for side in (1, -1)]
    while lengths[at] > 0.0:
        x, y = at
        best = min(
            (lengths[x + dx, y + dy] + math.hypot(dx, dy) * grid.cell, (x + dx, y + dy))
            for dx, dy in moves
            if 0 <= x + dx < free.shape[0]
            and 0 <= y + dy < free.shape[1]
            and not (dx and dy and not (free[x + dx, y] and free[x, y + dy]))
        )
        at = best[1]
        yield at
