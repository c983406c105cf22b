"""An occupancy grid: which places of an area are free, and the least ways between them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Moves: TypeAlias = tuple[tuple[int, int], ...]

EIGHT: Moves = ((1, 0), (0, 1), (1, 1), (1, -1))
"""Moves to the eight cells around, each in both directions. No way is more than 8.3 % too long."""
SIXTEEN: Moves = (*EIGHT, (2, 1), (1, 2), (2, -1), (1, -2))
"""Moves to sixteen cells around, each in both directions. No way is more than 2.8 % too long."""


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyGrid:
    """Square cells over a rectangle.

    Attributes:
        low: Where the first cell begins (m).
        cell: Side of a cell (m).
        free: Which cells are free, shape (columns, rows). Mark in it what is occupied.
    """

    low: tuple[float, float]
    cell: float
    free: NDArray[np.bool_]

    @classmethod
    def over(
        cls, low: tuple[float, float], high: tuple[float, float], cell: float
    ) -> OccupancyGrid:
        """Return a free grid; its first cell begins at ``low``, its last one holds ``high`` (m)."""
        shape = tuple(len(np.arange(a, b + cell, cell)) for a, b in zip(low, high, strict=True))
        return cls(low, cell, np.ones(shape, dtype=bool))

    def points(self) -> Floats:
        """Return where each cell begins (m), shape (columns, rows, 2)."""
        axes = [
            np.arange(start, start + (count - 0.5) * self.cell, self.cell)
            for start, count in zip(self.low, self.free.shape, strict=True)
        ]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    def cells(self, x: Floats, y: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the column and the row of the cell that holds each point (m)."""
        return (
            ((x - self.low[0]) / self.cell).astype(np.int64),
            ((y - self.low[1]) / self.cell).astype(np.int64),
        )

    def cover(self, points: Floats, radius: float) -> None:
        """Mark the cells as occupied whose middle is within a radius (m) of one of the points.

        Args:
            points: Points on the grid (m), shape (K, 2).
            radius: At least 0 (m).
        """
        most = math.ceil(radius / self.cell) + 1
        around = np.arange(-most, most + 1)
        cells = np.floor((points - self.low) / self.cell)
        columns, rows = (cells[:, k, None] + around for k in (0, 1))
        x, y = (self.low[k] + (part + 0.5) * self.cell for k, part in ((0, columns), (1, rows)))
        away = np.hypot((x - points[:, :1])[:, :, None], (y - points[:, 1:])[:, None, :])
        which, i, j = np.nonzero(away <= radius)
        column, row = columns[which, i].astype(int), rows[which, j].astype(int)
        inside = (column >= 0) & (column < self.free.shape[0]) & (row >= 0)
        inside &= row < self.free.shape[1]
        self.free[column[inside], row[inside]] = False

    def distances(
        self, source: tuple[int, int], moves: Moves, *, past_corners: bool = False
    ) -> Floats:
        """Return the least way (m) from one cell to every cell, over free cells (Dijkstra).

        Args:
            source: Its column and row.
            moves: ``EIGHT`` or ``SIXTEEN``.
            past_corners: Whether a diagonal move needs no more than two free ends. Without, it
                needs the two cells beside it too, and no way slips through between two occupied
                cells that touch at a corner.

        Returns:
            Shape (columns, rows); infinite where there is no way.
        """
        from scipy.sparse.csgraph import dijkstra

        graph = self._graph(moves, past_corners=past_corners)
        found = dijkstra(graph, directed=False, indices=self._number(source))
        return np.asarray(found.reshape(self.free.shape))

    def path(
        self, start: tuple[int, int], goal: tuple[int, int], moves: Moves, price: Floats
    ) -> list[tuple[int, int]] | None:
        """Return the cells of the cheapest way between two cells, over free cells (Dijkstra).

        Args:
            start: Column and row of the first cell.
            goal: Those of the last one.
            moves: ``EIGHT`` or ``SIXTEEN``.
            price: What a metre in each cell costs, shape (columns, rows).

        Returns:
            The cells from the start to the goal, both included; None where there is no way.
        """
        from scipy.sparse.csgraph import dijkstra

        graph = self._graph(moves, price)
        last = self._number(goal)
        costs, before = dijkstra(graph, directed=False, indices=last, return_predecessors=True)
        at = self._number(start)
        if not np.isfinite(costs[at]):
            return None
        cells = [start]
        while at != last:
            at = int(before[at])
            cells.append(divmod(at, self.free.shape[1]))
        return cells

    def _number(self, cell: tuple[int, int]) -> int:
        """Return the number of a cell in the graph."""
        column, row = cell
        return int(column * self.free.shape[1] + row)

    def _graph(
        self, moves: Moves, price: Floats | None = None, *, past_corners: bool = False
    ) -> Any:
        """Return the graph of all moves between free cells, weighed by their length times price."""
        from scipy.sparse import csr_matrix

        free = self.free
        columns, rows = free.shape
        number = np.arange(free.size, dtype=np.int32).reshape(free.shape)
        starts, ends, lengths = [], [], []
        for dx, dy in moves:
            here = slice(0, columns - dx), slice(max(0, -dy), rows - max(0, dy))
            there = slice(dx, columns), slice(max(0, dy), rows - max(0, -dy))
            both = free[here] & free[there]
            if dx and dy and not past_corners:
                both &= free[here[0], there[1]] & free[there[0], here[1]]
            starts.append(number[here][both])
            ends.append(number[there][both])
            length = np.full(len(starts[-1]), self.cell * math.hypot(dx, dy))
            if price is not None:
                length *= (price[here][both] + price[there][both]) / 2.0
            lengths.append(length)
        edges = np.concatenate(starts), np.concatenate(ends)
        return csr_matrix((np.concatenate(lengths), edges), shape=(free.size, free.size))
