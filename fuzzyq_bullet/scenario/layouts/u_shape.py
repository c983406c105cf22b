"""A dead end of three boxes that opens towards the start."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from fuzzyq_bullet.scenario.layouts.trap import Trap, drawn
from fuzzyq_bullet.scenario.shapes import MIN_RADIUS, Box, Number

if TYPE_CHECKING:
    import numpy as np

_Side = Annotated[Number, Field(ge=0.4, le=500.0)]


class UShape(Trap):
    """A back and two legs that point towards the start."""

    layout: Literal["u-shape"]
    width: _Side | None = Field(
        default=None, description="From outside to outside of the legs (m); default: drawn."
    )
    depth: _Side | None = Field(
        default=None, description="From the back's outside to the legs' ends (m); default: drawn."
    )
    thickness: Annotated[Number, Field(ge=2 * MIN_RADIUS, le=100.0)] = Field(
        default=0.2, description="Of back and legs (m)."
    )

    def build(self, reach: float, rng: np.random.Generator) -> tuple[Box, ...]:
        """Return back and legs, with the origin in the middle of what they enclose."""
        thick = self.thickness
        width = drawn(self.width, rng, 0.2 * reach, 0.4 * reach, least=2 * thick + 0.8)
        depth = drawn(self.depth, rng, 0.15 * reach, 0.3 * reach, least=thick + 0.6)
        back = ((thick - depth) / 2, 0.0, thick, width)
        legs = ((0.0, side * (width - thick) / 2, depth, thick) for side in (1, -1))
        return tuple(
            Box(shape="box", position=(x, y), size=(sx, sy)) for x, y, sx, sy in (back, *legs)
        )
