"""How far the robot surely is from everything, measured anew only where that may matter."""

from __future__ import annotations

import math
from collections.abc import Callable


class Apart:
    """A lower bound of the clearance.

    It falls by no more than the robot moves, so one measurement serves for a while.

    Args:
        measure: The clearance (m) of a robot whose centre is at (x, y), or less; infinite only
            where there is nothing at all.
    """

    def __init__(self, measure: Callable[[float, float], float]) -> None:
        self._measure = measure
        self._known = -math.inf
        self._at = (math.nan, math.nan)

    def by(self, x: float, y: float, enough: float) -> float:
        """Return a distance (m) that is free all around the robot at (x, y).

        Where it is less than ``enough`` (m), it is the clearance itself.
        """
        left = self._known - math.dist(self._at, (x, y))
        if left >= enough or (x, y) == self._at:
            return left
        self._known, self._at = self._measure(x, y), (x, y)
        return self._known
