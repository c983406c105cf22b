"""The upright cylinder."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from fuzzyq_bullet.quantities import MIN_RADIUS, Number
from fuzzyq_bullet.shapes.base import (
    Collision,
    Floats,
    Mask,
    Shape,
    ShapeGroup,
    reach_of_circles,
    register_shape,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typing_extensions import Self

ROUNDNESS = 0.001
"""Greatest distance between a circle and the polygon that rays meet (m)."""


class Cylinders(ShapeGroup):
    """Cylinders.

    Args:
        rows: Shape (N, 3): x, y, radius (m).
    """

    def __init__(self, rows: Floats) -> None:
        self.discs = np.array(rows, dtype=np.float64).reshape(-1, 3)
        self.discs.flags.writeable = False
        self._columns = np.ascontiguousarray(self.discs.T)

    @classmethod
    def of(cls, shapes: Sequence[Cylinder]) -> Self:
        """Build it of cylinders."""
        return cls(np.array([(*one.position, one.radius) for one in shapes]))

    def __len__(self) -> int:
        return len(self.discs)

    def distances(self, x: Floats, y: Floats, which: Mask | None = None) -> Floats:
        """Return the distance to each circle."""
        cx, cy, r = self._columns if which is None else self._columns[:, which]
        distances: Floats = np.sqrt((x - cx) ** 2 + (y - cy) ** 2) - r
        return distances

    def free_distances(self, x: float, y: float, ux: Floats, uy: Floats, radius: float) -> Floats:
        """Return where the disc's centre enters the circle of both radii."""
        cx, cy, r = self._columns
        return reach_of_circles(cx - x, cy - y, ux, uy, r + radius)


@register_shape
class Cylinder(Shape):
    """An upright cylinder."""

    group = Cylinders

    shape: Literal["cylinder"]
    radius: Annotated[Number, Field(ge=MIN_RADIUS, le=1000.0)] = Field(description="Radius (m).")

    def corners(self) -> tuple[Floats, float]:
        """Return the centre and the radius."""
        return np.array([self.position]), self.radius

    def outline(self, corners: int = 24) -> Floats:
        """Return a polygon with its corners on the circle."""
        x, y = self.position
        angle = np.arange(corners) * (math.tau / corners)
        return np.stack([x + self.radius * np.cos(angle), y + self.radius * np.sin(angle)], axis=1)

    def faces(self) -> Floats:
        """Return a polygon around the circle, so that no distance is told longer than it is."""
        # A polygon around a circle of radius r with K sides reaches r·(1/cos(π/K) − 1) beyond it.
        half = math.acos(self.radius / (self.radius + ROUNDNESS))
        angle = np.linspace(0.0, 2 * np.pi, math.ceil(np.pi / half), endpoint=False)
        radius = self.radius / math.cos(np.pi / angle.size)
        local = radius * np.column_stack([np.cos(angle), np.sin(angle)])
        return np.asarray(local + self.position)

    def collisions(self, height: float) -> list[Collision]:
        """Return an exact cylinder."""
        return [Collision(f'<cylinder radius="{self.radius!r}" length="{height}"/>')]

    def thickness(self) -> float:
        """Return its diameter (m)."""
        return 2 * self.radius
