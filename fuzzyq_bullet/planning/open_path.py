"""The open path: the shortest path to the goal, with unknown space taken as free.

A robot that sees far need not drive to frontiers, because it sees most obstacles in time. It drives
along the open path and plans again after a short way (the free-space assumption: Koenig, Smirnov,
Tovey 2003).
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
"""How many cells narrower than the disc the path may be. Half a cell is tried if there is no path
otherwise: the grid may be wrong about a gap."""
OWN_CELLS = 1
"""So many cells on each side of the robot's own are free, because it stands there."""
POINT_EVERY = 3
"""One of so many cells of the path becomes a point of it."""


def open_path(obstacles: ObstacleMap, start: Point, goal: Point) -> list[Point] | None:
    """Return the points (m) of the path, from the start to the goal.

    Returns:
        None if the known obstacles leave no path.
    """
    for narrower in NARROWER:
        grid = obstacles.free_cells((start, goal), narrower)
        if grid is None:
            return None
        columns, rows = grid.cells(*np.array((start, goal)).T)
        (column, goal_column), (row, goal_row) = columns.tolist(), rows.tolist()
        beside = (
            slice(column - OWN_CELLS, column + OWN_CELLS + 1),
            slice(row - OWN_CELLS, row + OWN_CELLS + 1),
        )
        grid.free[beside] = True
        lengths = grid.distances((goal_column, goal_row), SIXTEEN)
        if math.isfinite(lengths[column, row]):
            between = [_middle(grid, cell) for cell in _downhill(grid, lengths, (column, row))]
            return [start, *between[POINT_EVERY - 1 : -1 : POINT_EVERY], goal]
    return None


def _middle(grid: OccupancyGrid, cell: tuple[int, int]) -> Point:
    """Return the middle of a cell (m)."""
    (x, y), (column, row) = grid.low, cell
    return x + (column + 0.5) * grid.cell, y + (row + 0.5) * grid.cell


def _downhill(
    grid: OccupancyGrid, lengths: NDArray[np.float64], at: tuple[int, int]
) -> Iterator[tuple[int, int]]:
    """Yield the cells of the shortest path after a cell, by the path lengths (m) from all cells."""
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
