"""Where in a map there is room for the robot: a drawing of it, good enough for examples."""

from __future__ import annotations

from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from fuzzyq_bullet.quantities import Point
from fuzzyq_bullet.scenario.models import Scenario

Mask: TypeAlias = NDArray[np.bool_]

_CELLS = 600
"""Cells of the drawing along the longer side of the arena."""
_FINEST = 0.02
"""Least size of a cell (m)."""


class Room:
    """The free space of a scenario for the robot's disc, on a grid.

    Cells count as free if the disc fits there whatever the drawing has rounded. A gap narrower
    than the robot and about three cells counts as closed.

    Args:
        scenario: A scenario whose obstacles are listed; start and goal do not matter.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.radius = scenario.robot.radius
        self._scenario = scenario
        self._bounds = scenario.arena.bounds
        self._step = max(max(scenario.arena.size) / _CELLS, _FINEST)

    @cached_property
    def _free(self) -> Mask:
        """Shape (rows, columns), the first row at the bottom."""
        from PIL import Image, ImageDraw

        left, bottom, right, top = self._bounds
        shape = (
            max(1, int((right - left) / self._step)),
            max(1, int((top - bottom) / self._step)),
        )
        drawing = Image.new("1", shape, 1)
        pen = ImageDraw.Draw(drawing)
        for one in self._scenario.obstacles:
            for piece in one.pieces():
                points = (piece - (left, bottom)) / self._step - 0.5
                pen.polygon([(x, y) for x, y in points.tolist()], fill=0, outline=0)
        # Behind the edge there is nothing to stand on.
        drawn = np.pad(np.array(drawing, dtype=bool), 1)
        distance = ndimage.distance_transform_edt(drawn)[1:-1, 1:-1] * self._step
        free: Mask = distance > self.radius + 1.5 * self._step
        return free

    @cached_property
    def _graph(self) -> Any:
        """Links between free cells that are beside each other, as long as they are (m)."""
        free = self._free
        number = np.arange(free.size).reshape(free.shape)
        first, second, lengths = [], [], []
        for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
            here = (slice(0, -down or None), slice(max(0, -right), -right if right > 0 else None))
            there = (slice(down, None), slice(max(0, right), right if right < 0 else None))
            both = free[here] & free[there]
            first.append(number[here][both])
            second.append(number[there][both])
            lengths.append(np.full(len(first[-1]), self._step * np.hypot(down, right)))
        pairs = (np.concatenate(first), np.concatenate(second))
        return coo_matrix((np.concatenate(lengths), pairs), shape=(free.size,) * 2).tocsr()

    def _far(self, cell: int) -> NDArray[np.float64]:
        """Return the way (m) from a cell to every other one; infinite where there is none."""
        far: NDArray[np.float64] = dijkstra(self._graph, directed=False, indices=cell)
        return far

    def _cell(self, point: Point) -> int:
        """Return the free cell that is nearest to a point."""
        rows, columns = np.nonzero(self._free)
        x = self._bounds.left + (columns + 0.5) * self._step
        y = self._bounds.bottom + (rows + 0.5) * self._step
        at = int(np.hypot(x - point[0], y - point[1]).argmin())
        return int(rows[at]) * int(self._free.shape[1]) + int(columns[at])

    def _point(self, cell: int) -> Point:
        row, column = divmod(cell, self._free.shape[1])
        x = self._bounds.left + (column + 0.5) * self._step
        y = self._bounds.bottom + (row + 0.5) * self._step
        return round(x, 2), round(y, 2)

    def nearest(self, point: Point) -> Point | None:
        """Return the free place (m) that is nearest to a point; None if there is none."""
        return self._point(self._cell(point)) if self._free.any() else None

    def way(self, start: Point, goal: Point) -> float:
        """Return about how far it is (m); 0 if the drawing is too coarse to show a way."""
        if not self._free.any():
            return 0.0
        length = float(self._far(self._cell(start))[self._cell(goal)])
        return length if np.isfinite(length) else 0.0

    def apart(self, given: Point | None) -> tuple[Point, Point, float] | None:
        """Return two places that are far apart and between which there is a way, and its length.

        Args:
            given: The first of them (m); None for one in the largest free part.
        """
        if not self._free.any():
            return None
        if given is None:
            parts, _ = ndimage.label(self._free, structure=np.ones((3, 3)))
            largest = int(np.bincount(parts.ravel())[1:].argmax()) + 1
            begin = self._farthest(int(np.flatnonzero(parts == largest)[0]))[0]
        else:
            begin = self._cell(given)
        end, way = self._farthest(begin)
        return (self._point(begin), self._point(end), way) if way > 4 * self.radius else None

    def _farthest(self, cell: int) -> tuple[int, float]:
        far = self._far(cell)
        far[~np.isfinite(far)] = -1.0
        end = int(far.argmax())
        return end, float(far[end])
