"""A new layout of random obstacles: rows of pillars, like an orchard, a little out of line.

    fuzzyq run orchard.yaml --plugin examples/extend/layout.py

In the scenario file: ``random: {layout: orchard, spacing: 1.2}``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from fuzzyq_bullet.quantities import Number
from fuzzyq_bullet.scenario.layouts import Layout, register_layout
from fuzzyq_bullet.scenario.layouts.placing import is_clear
from fuzzyq_bullet.shapes import Cylinder

if TYPE_CHECKING:
    from fuzzyq_bullet import Scenario


@register_layout
class Orchard(Layout):
    """Cylinders on a grid, each moved at random; none where the robot starts or arrives."""

    layout: Literal["orchard"]
    spacing: Annotated[Number, Field(ge=0.8, le=100.0)] = Field(
        default=1.2, description="From tree to tree (m)."
    )
    radius: Annotated[Number, Field(ge=0.05, le=10.0)] = Field(
        default=0.1, description="Radius of each (m)."
    )

    def draw(self, scenario: Scenario, rng: np.random.Generator) -> tuple[Cylinder, ...]:
        """Draw the trees. The same generator gives the same trees."""
        width, depth = scenario.arena.size
        half = self.spacing / 2
        grid = np.meshgrid(
            np.arange(half, width, self.spacing), np.arange(half, depth, self.spacing)
        )
        places = np.stack(grid, axis=-1).reshape(-1, 2)
        places = (places + rng.uniform(-0.1, 0.1, places.shape)).round(4)
        trees = [
            Cylinder(shape="cylinder", position=(x, y), radius=self.radius)
            for x, y in places.tolist()
        ]
        return tuple(tree for tree in trees if is_clear(scenario, [tree], 0.1))
