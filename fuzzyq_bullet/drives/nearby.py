"""The clearance at one point after the other."""

from __future__ import annotations

from fuzzyq_bullet.geometry import Field


class Nearby:
    """A field's clearance at one point after the other.

    Args:
        field: All obstacles and walls.
    """

    def __init__(self, field: Field) -> None:
        self._field = field

    def clearance(self, x: float, y: float) -> float:
        """Return the signed distance (m) from a point to the nearest surface."""
        return float(self._field.clearance(((x, y),))[0])
