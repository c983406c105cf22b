"""How far the goal may still be, at best: around the walls seen so far, through all that was not.

It serves to choose between ways not gone yet. Its grid may close a gap narrower than a cell: then
that way comes last, but it is not given up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from fuzzyq_bullet.planning.base import Floats
from fuzzyq_bullet.planning.view import Point

CELL = 0.1
"""Side of a cell (m); doubled until the grid has no more than ``MOST`` cells."""
MOST = 50_000
MARGIN = 1.0
"""How far the grid reaches beyond everything known (m)."""
_ALONG = np.linspace(0.0, 1.0, 9)
_MOVES = ((1, 0), (0, 1), (1, 1), (1, -1))


def in_sight(start: Point, goal: Point, walls: Floats) -> bool:
    """Return whether no known wall crosses the straight line between two points.

    Args:
        start: One end (m).
        goal: The other (m).
        walls: Shape (W, 2, 2), as in ``View.walls``.
    """
    (x, y), (gx, gy) = start, goal
    first, second = walls[:, 0], walls[:, 1]
    dx, dy = gx - x, gy - y
    side = dx * (first[:, 1] - y) - dy * (first[:, 0] - x)
    other = dx * (second[:, 1] - y) - dy * (second[:, 0] - x)
    wx, wy = (second - first).T
    start_side = wx * (y - first[:, 1]) - wy * (x - first[:, 0])
    goal_side = wx * (gy - first[:, 1]) - wy * (gx - first[:, 0])
    return not bool(((side * other <= 0.0) & (start_side * goal_side <= 0.0)).any())


def ways_to_goal(goal: Point, walls: Floats, starts: Sequence[Point]) -> list[float]:
    """Return the least way (m) from each start to the goal that no known wall crosses.

    Walls must come in short pieces, as those of a view do: longer than eight cells they would leak.

    Infinite where the known walls leave none, as far as the grid can tell.
    """
    points = np.array([*starts, goal])
    known = np.vstack([walls.reshape(-1, 2), points])
    low, high = known.min(axis=0) - MARGIN, known.max(axis=0) + MARGIN
    cell = CELL
    while np.prod((high - low) / cell + 1.0) > MOST:
        cell *= 2.0
    columns, rows = (np.ceil((high - low) / cell).astype(int) + 1).tolist()

    free = np.ones((columns, rows), dtype=bool)
    on_walls = walls[:, 0, None] + (walls[:, 1] - walls[:, 0])[:, None] * _ALONG[:, None]
    blocked = ((on_walls.reshape(-1, 2) - low) / cell).astype(int)
    free[blocked[:, 0], blocked[:, 1]] = False

    cells = ((points - low) / cell).astype(int)
    source = int(cells[-1, 0] * rows + cells[-1, 1])
    ways = dijkstra(_moves(free, cell), directed=False, indices=source).reshape(columns, rows)
    return [float(ways[x, y]) for x, y in cells[:-1]]


def _moves(free: NDArray[np.bool_], cell: float) -> csr_matrix:
    """Return the graph of moves between free cells; none slips through between two blocked ones."""
    columns, rows = free.shape
    number = np.arange(free.size).reshape(free.shape)
    first, second, lengths = [], [], []
    for dx, dy in _MOVES:
        here = (slice(0, columns - dx), slice(0, rows - dy) if dy >= 0 else slice(1, rows))
        there = (slice(dx, columns), slice(dy, rows) if dy >= 0 else slice(0, rows - 1))
        can = free[here] & free[there]
        if dx and dy:
            can &= free[here[0], there[1]] & free[there[0], here[1]]
        first.append(number[here][can])
        second.append(number[there][can])
        lengths.append(np.full(first[-1].size, cell * math.hypot(dx, dy)))
    ends = (np.concatenate(first), np.concatenate(second))
    return csr_matrix((np.concatenate(lengths), ends), shape=(free.size, free.size))
