"""The simple alternative to learning a field: the map of it, kept from run to run.

The exploration graph is not thrown away at the goal. From the second run on the robot plans on it
from the start: it drives the shortest known way, and tries an unknown one only where that looks
shorter by more than ``PRICE``, and only in one run.
"""

from __future__ import annotations

import math

from fuzzyq_bullet.planning.escape.exploration import ENCLOSED, NEAR, ExplorationGraph, WaysOut
from fuzzyq_bullet.planning.scan import Point

PRICE = 2.0
"""How much shorter an unknown way must look to be tried (m)."""


class KeptMap:
    """A map that outlives the runs in which it is made.

    Attributes:
        graph: It.
    """

    def __init__(self) -> None:
        self.graph = ExplorationGraph()
        self.graph.judge = self._judge
        self._tried: list[Point] = []
        self._chosen: list[Point] = []

    def begin_again(self) -> None:
        """Begin another run."""
        self.graph.begin_again()
        self._tried += self._chosen
        self._chosen = []

    def _judge(self, out: WaysOut) -> list[float]:
        """Judge ways out by what was seen in all runs."""
        goal = out.observation.goal
        costs = [
            way + on + (0.0 if point == goal else self._price(point))
            for point, way, on in zip(out.points, out.ways, out.guess(), strict=True)
        ]
        chosen = out.points[min(range(len(costs)), key=costs.__getitem__)]
        if chosen != goal and chosen not in self._chosen:
            self._chosen.append(chosen)
        return costs

    def _price(self, point: Point) -> float:
        """Return what a way that is not known to lead to the goal costs more (m)."""
        tried = any(math.dist(point, other) <= NEAR for other in self._tried)
        return ENCLOSED if tried else PRICE
