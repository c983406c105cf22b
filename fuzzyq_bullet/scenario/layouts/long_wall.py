"""A long straight wall across the way from start to goal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from fuzzyq_bullet.scenario.layouts.trap import Trap, drawn
from fuzzyq_bullet.scenario.shapes import MIN_RADIUS, Box, Number

if TYPE_CHECKING:
    import numpy as np

_SHIFT = 0.45
"""How far a wall is shifted along itself, at most, as a share of its length."""


class LongWall(Trap):
    """One box that faces the start; at least one of its ends leaves room to pass.

    Where its position is drawn, the way from start to goal meets it anywhere, not in its middle.
    """

    layout: Literal["long-wall"]
    length: Annotated[Number, Field(ge=0.4, le=1000.0)] | None = Field(
        default=None, description="From end to end (m); default: drawn."
    )
    thickness: Annotated[Number, Field(ge=2 * MIN_RADIUS, le=100.0)] = Field(
        default=0.2, description="Of the wall (m)."
    )

    def build(self, reach: float, rng: np.random.Generator) -> tuple[Box, ...]:
        """Return the wall along y through the origin."""
        length = drawn(self.length, rng, 0.35 * reach, 0.8 * reach, least=0.4)
        shift = float(rng.uniform(-_SHIFT, _SHIFT)) * length
        y = shift if self.position is None else 0.0
        return (Box(shape="box", position=(0.0, y), size=(self.thickness, length)),)
