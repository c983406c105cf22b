"""Arcs of overlapping cylinders that open towards the start; the semicircle is one of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from fuzzyq_bullet.scenario.layouts.trap import Trap, drawn
from fuzzyq_bullet.scenario.shapes import MIN_RADIUS, Cylinder, Number

if TYPE_CHECKING:
    import numpy as np


class _Curved(Trap):
    """Cylinders along a part of a circle."""

    radius: Annotated[Number, Field(ge=0.2, le=500.0)] | None = Field(
        default=None,
        description="Radius of the arc, to the cylinders' centres (m); default: drawn.",
    )
    thickness: Annotated[Number, Field(ge=2 * MIN_RADIUS, le=100.0)] = Field(
        default=0.4, description="Diameter of the cylinders (m), which overlap by half."
    )

    def along(self, angle: float, reach: float, rng: np.random.Generator) -> tuple[Cylinder, ...]:
        """Return cylinders no more than half their diameter apart along an arc of that angle."""
        radius = drawn(self.radius, rng, 0.12 * reach, 0.25 * reach, least=0.6)
        pieces = max(1, math.ceil(radius * angle / (self.thickness / 2)))
        bearings = [math.pi + angle * (k / pieces - 0.5) for k in range(pieces + 1)]
        return tuple(
            Cylinder(
                shape="cylinder",
                position=(radius * math.cos(b), radius * math.sin(b)),
                radius=self.thickness / 2,
            )
            for b in bearings
        )


class Semicircle(_Curved):
    """Half a circle of overlapping cylinders: the trap that breakout alone never leaves."""

    layout: Literal["semicircle"]

    def build(self, reach: float, rng: np.random.Generator) -> tuple[Cylinder, ...]:
        """Return half a circle about the origin, opening along x."""
        return self.along(math.pi, reach, rng)


class Arc(_Curved):
    """Any part of a circle of overlapping cylinders."""

    layout: Literal["arc"]
    angle: Annotated[Number, Field(ge=0.2, le=5.5)] | None = Field(
        default=None, description="How far it goes round (rad); default: drawn, 100° to 250°."
    )

    def build(self, reach: float, rng: np.random.Generator) -> tuple[Cylinder, ...]:
        """Return an arc about the origin, opening along x."""
        angle = drawn(self.angle, rng, math.radians(100), math.radians(250))
        return self.along(angle, reach, rng)
