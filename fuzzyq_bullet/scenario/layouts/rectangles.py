"""Boxes of random sizes at random places, along the axes or turned."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from fuzzyq_bullet import geometry
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import DECIMALS, MAX_OBSTACLES, MIN_RADIUS, Count, Flag, Number
from fuzzyq_bullet.scenario.layouts.base import Conflict, Layout, register_layout, too_many
from fuzzyq_bullet.scenario.layouts.placing import is_clear, is_inside, separated
from fuzzyq_bullet.shapes import Box, Obstacle

if TYPE_CHECKING:
    from fuzzyq_bullet.scenario.models import Scenario

_IDLE = 2000
"""Draws in a row that find no place, after which there is taken to be none."""

_Side = Annotated[Number, Field(ge=2 * MIN_RADIUS, le=1000.0)]


@register_layout
class Rectangles(Layout):
    """Boxes at random places, as many as asked for, wholly within the arena."""

    layout: Literal["rectangles"]
    count: Annotated[Count, Field(ge=0, le=MAX_OBSTACLES)] = Field(description="How many.")
    shortest: _Side = Field(default=0.2, description="Least length of a side (m).")
    longest: _Side = Field(default=1.0, description="Greatest length of a side (m).")
    turned: Flag = Field(default=False, description="Whether they stand at any angle.")
    margin: Annotated[Number, Field(ge=0.0, le=100.0)] = Field(
        default=0.1, description="Least gap to the robot at the start and to the goal disc (m)."
    )
    overlap: Flag = Field(default=True, description="Whether obstacles may overlap one another.")

    def conflicts(self, scenario: Scenario) -> list[Conflict]:
        """Return what is too large for the arena, too many, or the wrong way round."""
        if self.count == 0:
            return []
        found: list[Conflict] = []
        if self.shortest > self.longest:
            if "longest" in self.model_fields_set:
                key, message = "longest", f"must be at least shortest, {self.shortest:g}"
            else:
                key, message = "shortest", f"must be at most longest, {self.longest:g}"
            found.append(((key,), f"{message}, got {getattr(self, key):g}"))
        least = min(scenario.arena.size)
        if self.shortest > least:
            message = f"must be at most {least:g} to fit, got {self.shortest:g}"
            found.append((("shortest",), message))
        return found + too_many(scenario, self.count)

    def draw(self, scenario: Scenario, rng: np.random.Generator) -> tuple[Box, ...]:
        """Draw the boxes, exactly as many."""
        placed: list[Box] = []
        idle = 0
        listed = geometry.Field.of(scenario.obstacles)
        while len(placed) < self.count:
            box = self._one(scenario.arena.size, rng)
            idle += 1
            if (
                is_inside(box, scenario.arena.size)
                and is_clear(scenario, (box,), self.margin)
                and (self.overlap or self._stands_alone(box, placed, scenario.obstacles, listed))
            ):
                placed.append(box)
                idle = 0
            elif idle > _IDLE:
                raise UserError(
                    f"{scenario.name}: random.count: cannot place {self.count} rectangles in "
                    f"{scenario.arena.size[0]:g} × {scenario.arena.size[1]:g} m clear of start and "
                    "goal; use fewer, smaller ones or a smaller margin"
                    + ("" if self.overlap else ", or allow overlap")
                )
        return tuple(placed)

    def _one(self, size: tuple[float, float], rng: np.random.Generator) -> Box:
        x, y = rng.uniform((0.0, 0.0), size).round(DECIMALS).tolist()
        a, b = rng.uniform(self.shortest, self.longest, 2).round(DECIMALS).tolist()
        turn = round(float(rng.uniform(0.0, math.pi)), DECIMALS)
        a, b = max(a, 2 * MIN_RADIUS), max(b, 2 * MIN_RADIUS)
        return Box(shape="box", position=(x, y), size=(a, b), yaw=turn if self.turned else 0.0)

    def _stands_alone(
        self,
        box: Box,
        placed: list[Box],
        others: tuple[Obstacle, ...],
        listed: geometry.Field,
    ) -> bool:
        reach = math.hypot(*box.size) / 2
        near = np.flatnonzero(listed.distances(box.position) < reach).tolist()
        return not any(overlap(box, other) for other in [*placed, *(others[i] for i in near)])


def overlap(box: Box, other: Obstacle) -> bool:
    """Tell whether a box and an obstacle share more than an edge (separating axes, exactly)."""
    points, radius = other.corners()
    if len(points) == 1:
        gap = geometry.Field.of([box]).nearest(other.position)[1]
        return gap < radius
    apart = math.dist(box.position, other.position)
    if apart >= box.extent() + other.extent():
        return False
    return any(not separated(box.outline(), piece) for piece in other.pieces())
