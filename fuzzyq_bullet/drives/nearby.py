"""The clearance at one point after the other, each near the one before."""

from __future__ import annotations

import math

from fuzzyq_bullet.geometry import Field

AROUND = 1.5
"""How far away what is kept in mind was when it was looked for (m)."""
STALE = 0.3
"""After so much way what is kept in mind is put in order again (m)."""


class Nearby:
    """A field's clearance in plain numbers: a few things are near, and it is asked again and again.

    What is near is kept with how far it was, the nearest first, so that the first few tell.

    Args:
        field: All obstacles and walls.
    """

    def __init__(self, field: Field) -> None:
        self._field = field
        self._arena = field.arena
        self._near: list[tuple[float, list[float]]] = []
        self._next = -math.inf
        self._at = (0.0, 0.0)

    def clearance(self, x: float, y: float) -> float:
        """Return the signed distance (m) from a point to the nearest surface.

        Negative inside an obstacle or behind a wall, infinite in an empty field.
        """
        moved = math.dist(self._at, (x, y))
        if moved > STALE:
            self._near = sorted((_distance(x, y, shape), shape) for _, shape in self._near)
            self._next, self._at, moved = self._next - moved, (x, y), 0.0
        least = self._least(x, y, moved)
        # Nothing that is not kept in mind has come nearer by more than the point has moved.
        if least > self._next - moved:
            self._at = (x, y)
            self._near, self._next = self._field.around(x, y, AROUND)
            least = min(self._least(x, y, 0.0), self._next)
        return least

    def _least(self, x: float, y: float, moved: float) -> float:
        least = math.inf
        if self._arena is not None:
            width, depth = self._arena
            least = min(x, width - x, y, depth - y)
        for was, shape in self._near:
            if was - moved >= least:
                break  # nor can anything be nearer that was still farther away
            least = min(least, _distance(x, y, shape))
        return least


def _distance(x: float, y: float, shape: list[float]) -> float:
    """Return the signed distance (m) from a point to a rectangle with round corners."""
    at_x, at_y, half_x, half_y, cos, sin, radius = shape
    dx, dy = x - at_x, y - at_y
    qx, qy = abs(dx * cos + dy * sin) - half_x, abs(dy * cos - dx * sin) - half_y
    outside = math.hypot(qx, qy) if qx > 0.0 and qy > 0.0 else max(qx, qy)
    return outside - radius
