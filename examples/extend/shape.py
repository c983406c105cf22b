"""A new shape of obstacle: the pillar with as many sides as you like.

    fuzzyq run pillars.yaml --plugin examples/extend/shape.py

In the scenario file: ``- {shape: pillar, position: [4.0, 5.0], radius: 0.4, sides: 6}``.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from fuzzyq_bullet.quantities import Angle, Count, Length
from fuzzyq_bullet.shapes import ConvexShape, register_shape


@register_shape
class Pillar(ConvexShape):
    """An upright prism over a regular polygon."""

    shape: Literal["pillar"]
    radius: Length = Field(description="From its centre to its corners (m).")
    sides: Annotated[Count, Field(ge=3, le=100)] = Field(default=6, description="How many sides.")
    yaw: Angle = Field(default=0.0, description="Direction of its first corner (rad).")

    def polygon(self) -> list[tuple[float, float]]:
        """Return the corners, anticlockwise. Distance, solid, rays and drawing follow from them."""
        x, y = self.position
        angles = [self.yaw + k * math.tau / self.sides for k in range(self.sides)]
        return [(x + self.radius * math.cos(a), y + self.radius * math.sin(a)) for a in angles]
