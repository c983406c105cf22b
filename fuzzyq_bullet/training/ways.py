"""How far it really is to the goal, from everywhere: what progress is measured by in training.

A planner never sees this. But a reward may know more than who is rewarded: with the straight
distance a step into a dead end looks as good as a step towards the goal, and what was wrong with it
turns up many decisions later.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from fuzzyq_bullet.geometry import Field, Floats
from fuzzyq_bullet.scenario.models import Scenario

CELL = 0.05
"""Side of a cell (m)."""
ROOM = 0.21
"""Radius (m) of the disc that must fit: between that of the robot and what it can see."""
_MOVES = ((1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (1, 2), (2, -1), (1, -2))
"""To half of the sixteen neighbours; the others are the ways back. No length is off by over 3 %."""


class Ways:
    """Lengths of the shortest ways to a goal.

    Args:
        scenario: A realised scenario.
    """

    def __init__(self, scenario: Scenario) -> None:
        width, depth = scenario.arena.size
        xs = np.arange(0.0, width + CELL, CELL)
        ys = np.arange(0.0, depth + CELL, CELL)
        centres = np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=-1)
        field = Field.of(scenario.obstacles, scenario.arena)
        free = (field.clearance(centres.reshape(-1, 2)) >= ROOM).reshape(centres.shape[:2])
        goal = scenario.goal.position
        at_goal = np.hypot(*(centres - goal).reshape(-1, 2).T)
        lengths = dijkstra(
            _graph(free), indices=int(np.where(free.ravel(), at_goal, np.inf).argmin())
        )
        known = np.isfinite(lengths)
        # Where no disc fits the robot is not; its cells only must not spoil what is beside them.
        lengths[~known] = at_goal[~known] + (lengths[known].max() if known.any() else 0.0)
        self._lengths = _spread(lengths.reshape(free.shape), known.reshape(free.shape))

    def from_here(self, x: float, y: float) -> float:
        """Return the length of the shortest way from a point (m)."""
        [length] = map_coordinates(self._lengths, [[x / CELL], [y / CELL]], order=1, mode="nearest")
        return float(length)


def _graph(free: NDArray[np.bool_]) -> csr_array:
    number = np.arange(free.size).reshape(free.shape)
    starts, ends, ways = [], [], []
    for i, j in _MOVES:
        rows, columns = free.shape[0] - i, free.shape[1] - abs(j)
        here = slice(0, rows), slice(max(0, -j), max(0, -j) + columns)
        there = slice(i, i + rows), slice(max(0, j), max(0, j) + columns)
        both = free[here] & free[there]
        starts.append(number[here][both])
        ends.append(number[there][both])
        ways.append(np.full(both.sum(), CELL * float(np.hypot(i, j))))
    edges = np.concatenate(ways), (np.concatenate(starts), np.concatenate(ends))
    half = csr_array(edges, shape=(free.size, free.size))
    return half + half.T


def _spread(lengths: Floats, known: NDArray[np.bool_]) -> Floats:
    """Give every cell without a way the least length around it, some cells deep."""
    lengths, known = lengths.copy(), known.copy()
    for _ in range(4):
        padded = np.pad(np.where(known, lengths, np.inf), 1, constant_values=np.inf)
        windows = np.lib.stride_tricks.sliding_window_view(padded, (3, 3))
        least = windows.min(axis=(2, 3))
        new = ~known & np.isfinite(least)
        lengths[new] = least[new] + CELL
        known |= new
    return lengths
