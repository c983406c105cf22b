"""The clearance at one point after the other, each near the one before."""

from __future__ import annotations

import math

from fuzzyq_bullet.geometry import Field

AROUND = 1.0
"""How far away what is kept in mind was when it was looked for (m)."""


class Nearby:
    """A field's clearance in plain numbers: a few things are near, and it is asked again and again.

    Args:
        field: All obstacles and walls.
    """

    def __init__(self, field: Field) -> None:
        self._field = field
        self._arena = field.arena
        self._near: list[list[float]] = []
        self._at = (math.nan, math.nan)
        self._next = -math.inf

    def clearance(self, x: float, y: float) -> float:
        """Return the signed distance (m) from a point to the nearest surface.

        Negative inside an obstacle or behind a wall, infinite in an empty field.
        """
        least = self._least(x, y)
        # Nothing that is not kept in mind has come nearer by more than the point has moved.
        if not least <= self._next - math.dist(self._at, (x, y)):
            self._at = (x, y)
            self._near, self._next = self._field.around(x, y, AROUND)
            least = self._least(x, y)
        return least

    def _least(self, x: float, y: float) -> float:
        least = math.inf
        if self._arena is not None:
            width, depth = self._arena
            least = min(x, width - x, y, depth - y)
        for at_x, at_y, half_x, half_y, cos, sin, radius in self._near:
            dx, dy = x - at_x, y - at_y
            qx, qy = abs(dx * cos + dy * sin) - half_x, abs(dy * cos - dx * sin) - half_y
            if qx > 0.0 and qy > 0.0:
                distance = math.hypot(qx, qy) - radius
            else:
                distance = max(qx, qy) - radius
            least = min(least, distance)
        return least
