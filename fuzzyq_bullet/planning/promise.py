"""How far the goal may still be, at best: around the walls seen so far, through all that was not.

It serves to choose between ways not gone yet. Its grid may close a gap narrower than a cell: then
that way comes last, but it is not given up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning.base import Floats
from fuzzyq_bullet.planning.view import Point

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

CELL = 0.1
"""Side of a cell (m); doubled until the grid has no more than ``MOST`` cells."""
MOST = 50_000
MARGIN = 1.0
"""How far the grid reaches beyond everything known (m)."""
_ALONG = np.linspace(0.0, 1.0, 9)[:, None]
_MOVES = ((1, 0), (0, 1), (1, 1), (1, -1))
_BITS = np.unpackbits(np.arange(256, dtype=np.uint8)[:, None], axis=1).sum(axis=1, dtype=np.int32)
"""How many bits are set in each byte."""


@dataclass(frozen=True, slots=True)
class _Grid:
    """Cells over everything known.

    Attributes:
        low: Where the first cell begins (m).
        cell: Side of a cell (m).
        shape: Columns and rows.
    """

    low: Point
    cell: float
    shape: tuple[int, int]

    @classmethod
    def over(cls, low: Point, high: Point) -> _Grid:
        """Return the grid that reaches ``MARGIN`` beyond both corners (m)."""
        low, high = (low[0] - MARGIN, low[1] - MARGIN), (high[0] + MARGIN, high[1] + MARGIN)
        width, depth = high[0] - low[0], high[1] - low[1]
        cell = CELL
        while (width / cell + 1.0) * (depth / cell + 1.0) > MOST:
            cell *= 2.0
        return cls(low, cell, (math.ceil(width / cell) + 1, math.ceil(depth / cell) + 1))

    def cells(self, x: Floats, y: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the column and the row of each point (m)."""
        return (
            ((x - self.low[0]) / self.cell).astype(np.int64),
            ((y - self.low[1]) / self.cell).astype(np.int64),
        )


class Walls:
    """All walls seen so far."""

    def __init__(self) -> None:
        # Loaded here: not by whoever only reads a scenario, and not while the robot drives.
        import scipy.sparse.csgraph  # noqa: F401

        self._ends = np.zeros((4, 0))  # rows: x and y of one end, x and y of the other
        self._low, self._high = (math.inf, math.inf), (-math.inf, -math.inf)
        # Walls are only ever added: what they block of a grid is kept for the next question.
        self._grid: _Grid | None = None
        self._free = np.zeros((0, 0), dtype=bool)
        self._marked = 0

    def add(self, seen: Floats) -> None:
        """Remember walls.

        Args:
            seen: Shape (W, 2, 2), as in ``View.walls``. They must come in short pieces, as those
                of a view do: longer than eight cells they would leak.
        """
        if len(seen):
            self._ends = np.concatenate([self._ends, seen.reshape(-1, 4).T], axis=1)
            corners = seen.reshape(-1, 2)
            self._low = _least(self._low, corners.min(axis=0).tolist())
            self._high = _greatest(self._high, corners.max(axis=0).tolist())

    def in_sight(self, start: Point, goal: Point) -> bool:
        """Return whether no known wall crosses the straight line between two points (m)."""
        (x, y), (gx, gy) = start, goal
        x1, y1, x2, y2 = self._ends
        dx, dy = gx - x, gy - y
        side = dx * (y1 - y) - dy * (x1 - x)
        other = dx * (y2 - y) - dy * (x2 - x)
        wx, wy = x2 - x1, y2 - y1
        start_side = wx * (y - y1) - wy * (x - x1)
        goal_side = wx * (gy - y1) - wy * (gx - x1)
        return not bool(((side * other <= 0.0) & (start_side * goal_side <= 0.0)).any())

    def ways_to_goal(self, goal: Point, starts: Sequence[Point]) -> list[float]:
        """Return the least way (m) from each start to the goal that no known wall crosses.

        Infinite where the known walls leave none, as far as the grid can tell.
        """
        from scipy.sparse.csgraph import dijkstra

        points = (*starts, goal)
        grid = _Grid.over(_least(self._low, *points), _greatest(self._high, *points))
        free = self._left_free(grid)
        columns, rows = grid.cells(*np.array(points).T)
        source = int(columns[-1] * grid.shape[1] + rows[-1])
        # The graph holds every move in both directions.
        ways = dijkstra(_moves(free, grid.cell), directed=True, indices=source)
        found: list[float] = ways.reshape(grid.shape)[columns[:-1], rows[:-1]].tolist()
        return found

    def _left_free(self, grid: _Grid) -> NDArray[np.bool_]:
        """Return which cells no known wall touches."""
        if grid != self._grid:
            self._grid, self._free, self._marked = grid, np.ones(grid.shape, dtype=bool), 0
        x1, y1, x2, y2 = self._ends[:, self._marked :]
        self._free[grid.cells(x1 + (x2 - x1) * _ALONG, y1 + (y2 - y1) * _ALONG)] = False
        self._marked = self._ends.shape[1]
        return self._free


def _least(*points: Sequence[float]) -> Point:
    return min(x for x, _ in points), min(y for _, y in points)


def _greatest(*points: Sequence[float]) -> Point:
    return max(x for x, _ in points), max(y for _, y in points)


def _moves(free: NDArray[np.bool_], cell: float) -> csr_matrix:
    """Return the graph of moves between free cells; none slips through between two blocked ones."""
    from scipy.sparse import csr_matrix

    columns, rows = free.shape
    can = np.zeros((columns, rows, 2 * len(_MOVES)), dtype=bool)
    steps, lengths = [], []
    for k, (dx, dy) in enumerate(_MOVES):
        here = (slice(0, columns - dx), slice(0, rows - dy) if dy >= 0 else slice(1, rows))
        there = (slice(dx, columns), slice(dy, rows) if dy >= 0 else slice(0, rows - 1))
        both = free[here] & free[there]
        if dx and dy:
            both &= free[here[0], there[1]] & free[there[0], here[1]]
        can[(*here, 2 * k)] = can[(*there, 2 * k + 1)] = both
        steps += [dx * rows + dy, -dx * rows - dy]
        lengths += [cell * math.hypot(dx, dy)] * 2
    # Eight moves from each cell: eight bits.
    ends = np.zeros(free.size + 1, dtype=np.int32)
    _BITS[np.packbits(can)].cumsum(out=ends[1:])
    targets = np.flatnonzero(can).astype(np.int32)
    move = targets & np.int32(7)
    targets >>= 3
    targets += np.array(steps, dtype=np.int32)[move]
    return csr_matrix((np.array(lengths)[move], targets, ends), shape=(free.size, free.size))
