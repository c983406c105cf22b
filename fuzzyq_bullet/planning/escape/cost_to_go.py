"""The least way to the goal that the obstacles seen so far leave, through all that was not seen.

It serves to choose between frontiers (Section 4.3). Its grid may close a gap narrower than a cell:
such a frontier comes last, but it stays a candidate.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from fuzzyq_bullet.occupancy import EIGHT, OccupancyGrid
from fuzzyq_bullet.planning.base import Flags, Floats
from fuzzyq_bullet.planning.scan import Point

CELL = 0.1
"""Side of a cell (m); doubled until the grid has no more than ``MOST`` cells."""
TIGHT = 3.0
"""What a path costs more for which there seems to be no room (m)."""
NO_HITS = np.zeros((0, 2))
GRAIN = 0.03
"""Hits no farther apart than about this are one (m)."""
CLOSE = 1e-6
"""How much nearer (m) a third point must be to count as between two."""
NARROWER = 1.0
"""How many cells narrower than the disc the cells of an open path may be."""
SPARE = 0.5
"""With less room than this around the disc, in cells, a place is tight."""
THICK = 1.5
"""How far from the middle of a gap that is too narrow the cells are closed, in cells. So they are
closed two cells deep in all of the gap, and no move of ``SIXTEEN`` jumps over them."""
MOST = 50_000
MARGIN = 1.0
"""How far the grid reaches beyond everything known (m)."""
_ALONG = np.linspace(0.0, 1.0, 9)[:, None]


class ObstacleMap:
    """What has been seen of all obstacles so far: where the robot's centre cannot be."""

    def __init__(self) -> None:
        # Loading it takes long: not while the robot drives, and not when a scenario is only read.
        import scipy.sparse.csgraph
        import scipy.spatial  # noqa: F401

        self._ends = np.zeros((4, 0))  # rows: x and y of one end, x and y of the other
        self._hits = NO_HITS  # in grains
        self._points = NO_HITS  # one of those that were hit in each grain
        self._radius = 0.0
        self._low, self._high = (math.inf, math.inf), (-math.inf, -math.inf)

    def add(self, boundary: Floats, hits: Floats = NO_HITS, radius: float = 0.0) -> None:
        """Remember what was seen.

        Args:
            boundary: Lines, shape (W, 2, 2), as in ``Scan.boundary``: the centre cannot cross them.
                None may be longer than eight cells: a longer one would leak.
            hits: Points, shape (H, 2), as in ``Scan.hits``: the disc cannot cover them.
            radius: Radius of the disc (m).
        """
        self._radius = radius
        grains = np.concatenate([self._hits, (hits / GRAIN).round()])
        self._hits, first = np.unique(grains, axis=0, return_index=True)
        self._points = np.concatenate([self._points, hits])[first]
        if len(boundary):
            self._ends = np.concatenate([self._ends, boundary.reshape(-1, 4).T], axis=1)
            corners = boundary.reshape(-1, 2)
            self._low = _least(self._low, corners.min(axis=0).tolist())
            self._high = _greatest(self._high, corners.max(axis=0).tolist())

    def forget(self, seen_through: Callable[[Floats, float], Flags]) -> None:
        """Forget what is not there any more.

        Args:
            seen_through: Returns which points (m), shape (K, 2), are seen to be free now: by a thin
                ray if the second argument is 0, by the robot's disc if it is its radius (m).
        """
        kept = ~seen_through(self._hits * GRAIN, 0.0)
        self._hits, self._points = self._hits[kept], self._points[kept]
        middles = (self._ends[:2] + self._ends[2:]).T / 2.0
        self._ends = self._ends[:, ~seen_through(middles, self._radius)]

    def in_sight(self, start: Point, goal: Point) -> bool:
        """Return whether the straight line between two points (m) crosses no boundary."""
        (x, y), (gx, gy) = start, goal
        x1, y1, x2, y2 = self._ends
        dx, dy = gx - x, gy - y
        side = dx * (y1 - y) - dy * (x1 - x)
        other = dx * (y2 - y) - dy * (x2 - x)
        wx, wy = x2 - x1, y2 - y1
        start_side = wx * (y - y1) - wy * (x - x1)
        goal_side = wx * (gy - y1) - wy * (gx - x1)
        return not bool(((side * other <= 0.0) & (start_side * goal_side <= 0.0)).any())

    def cost_to_go(self, goal: Point, starts: Sequence[Point], tight: float = TIGHT) -> list[float]:
        """Return what the shortest path from each start to the goal costs (m).

        It is its length. Where the points that were hit leave no path, but the known boundaries do,
        it costs ``tight`` more: the grid may be wrong about a gap. Infinite where neither do.
        """
        costs = self._lengths(goal, starts, self._hits)
        if not all(map(math.isfinite, costs)):
            narrow = [length + tight for length in self._lengths(goal, starts, NO_HITS)]
            costs = [a if math.isfinite(a) else b for a, b in zip(costs, narrow, strict=True)]
        return costs

    def open_grid(self, points: Sequence[Point]) -> tuple[OccupancyGrid, Flags] | None:
        """Return an occupancy grid on which every gap is open that the disc gets through.

        The free cells have room for a disc that is one cell narrower. So no gap closes only because
        of where the cells lie. The gap between two points that rays have hit is closed at its
        middle if it is narrower than the disc.

        The grid is aligned: however much is known, its cells lie at the same places. So a cell that
        was closed once stays closed.

        Args:
            points: Points (m) that the grid holds.

        Returns:
            The grid, and which of its cells are tight: the disc with half a cell of room around it
            does not fit there. None if the cells are as wide as the disc: then the grid would be
            meaningless.
        """
        grid = _free_grid(_least(self._low, *points), _greatest(self._high, *points), aligned=True)
        least = self._radius - NARROWER * grid.cell
        if least <= 0.0:
            return None
        grid.cover(self._points, self._radius + SPARE * grid.cell)
        tight = ~grid.free
        grid.free[:] = True
        grid.cover(self._points, least)
        grid.cover(_too_narrow(self._points, 2.0 * least, 2.0 * self._radius), THICK * grid.cell)
        return grid, tight

    def _lengths(self, goal: Point, starts: Sequence[Point], hits: Floats) -> list[float]:
        points = (*starts, goal)
        grid = self._grid(_least(self._low, *points), _greatest(self._high, *points), hits)
        columns, rows = grid.cells(*np.array(points).T)
        lengths = grid.distances((columns[-1], rows[-1]), EIGHT)
        found: list[float] = lengths[columns[:-1], rows[:-1]].tolist()
        return found

    def _grid(self, low: Point, high: Point, hits: Floats) -> OccupancyGrid:
        """Return a grid over a rectangle (m) and ``MARGIN`` around it, what was seen in it."""
        grid = _free_grid(low, high)
        x1, y1, x2, y2 = self._ends
        grid.free[grid.cells(x1 + (x2 - x1) * _ALONG, y1 + (y2 - y1) * _ALONG)] = False
        # Half a cell less than the disc: a gap that is wide enough hardly ever closes only because
        # of where the cells lie. Cells as wide as the disc could tell nothing.
        if self._radius > grid.cell:
            grid.cover(hits * GRAIN, self._radius - grid.cell / 2.0)
        return grid


def _free_grid(low: Point, high: Point, *, aligned: bool = False) -> OccupancyGrid:
    """Return a free grid over a rectangle (m) and ``MARGIN`` around it.

    Args:
        low: Its lower left corner.
        high: Its upper right corner.
        aligned: Whether the origin is a corner of a cell, so that the cells of all grids coincide.
    """
    low, high = (low[0] - MARGIN, low[1] - MARGIN), (high[0] + MARGIN, high[1] + MARGIN)
    width, depth = high[0] - low[0], high[1] - low[1]
    cell = CELL
    while (width / cell + 1.0) * (depth / cell + 1.0) > MOST:
        cell *= 2.0
    if aligned:
        low = math.floor(low[0] / cell) * cell, math.floor(low[1] / cell) * cell
    return OccupancyGrid.over(low, high, cell)


def _too_narrow(hits: Floats, least: float, wide: float) -> Floats:
    """Return the middles (m) of the gaps between two hits that are too narrow, shape (G, 2).

    Args:
        hits: Points (m), shape (H, 2).
        least: How wide a gap is at least (m): what is narrower is closed anyway.
        wide: From which width on (m) the disc gets through.

    Returns:
        The middles. Where a third hit closes the middle anyway, the two need not.
    """
    from scipy.spatial import cKDTree

    tree = cKDTree(hits)
    one, other = tree.query_pairs(wide, output_type="ndarray").T
    places = hits[:, 0] + 1j * hits[:, 1]
    apart = places[one] - places[other]
    middles = (places[one] - apart / 2.0)[np.abs(apart) >= least]
    _, first = np.unique((middles / GRAIN).round(), return_index=True)
    found = np.column_stack([middles[first].real, middles[first].imag])
    nearest, _ = tree.query(found, distance_upper_bound=least / 2.0 - CLOSE)
    between: Floats = found[np.isinf(nearest)]
    return between


def _least(*points: Sequence[float]) -> Point:
    return min(x for x, _ in points), min(y for _, y in points)


def _greatest(*points: Sequence[float]) -> Point:
    return max(x for x, _ in points), max(y for _, y in points)
