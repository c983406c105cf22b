"""Fields of thin pillars, clumped by a cellular automaton: a usual benchmark of navigation."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import DECIMALS, MIN_RADIUS, Count, Number
from fuzzyq_bullet.scenario.layouts.base import Conflict, Layout, register_layout, too_many
from fuzzyq_bullet.scenario.layouts.placing import kept_clear, leaves_a_way
from fuzzyq_bullet.shapes import Cylinder

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fuzzyq_bullet.scenario.models import Scenario

_ATTEMPTS = 200
"""Fields drawn before there is taken to be none with a way."""
_BORN, _DIES = 5, 1
"""With so many filled neighbours, of eight, an empty cell is filled; with so few a filled one is
emptied."""


@register_layout
class Cellular(Layout):
    """Cells filled at random and smoothed by a cellular automaton; a pillar stands in each.

    The cells fill the arena. Those about start and goal stay empty, and a field that leaves no way
    is drawn again.
    """

    layout: Literal["cellular"]
    fill: Annotated[Number, Field(ge=0.0, le=0.5)] = Field(
        default=0.2, description="Probability that a cell is filled at first."
    )
    smoothing: Annotated[Count, Field(ge=0, le=20)] = Field(
        default=4, description="Steps of the cellular automaton."
    )
    cell: Annotated[Number, Field(ge=2 * MIN_RADIUS, le=10.0)] = Field(
        default=0.15, description="Side of a cell (m); a pillar is as wide."
    )
    margin: Annotated[Number, Field(ge=0.0, le=100.0)] = Field(
        default=0.1, description="Least gap to the robot at the start and to the goal disc (m)."
    )

    def conflicts(self, scenario: Scenario) -> list[Conflict]:
        """Return cells too small for so large an arena: they might be more than is allowed."""
        columns, rows = self._cells(scenario)
        return too_many(scenario, columns * rows, "cell")

    def draw(self, scenario: Scenario, rng: np.random.Generator) -> tuple[Cylinder, ...]:
        """Draw fields until one leaves a way."""
        for _ in range(_ATTEMPTS):
            pillars = self._pillars(scenario, self._filled(scenario, rng))
            if leaves_a_way(scenario, pillars):
                return pillars
        raise UserError(
            f"{scenario.name}: random.fill: no field of {_ATTEMPTS} left a way; fill fewer cells"
        )

    def _cells(self, scenario: Scenario) -> tuple[int, int]:
        width, depth = scenario.arena.size
        return math.floor(width / self.cell), math.floor(depth / self.cell)

    def _filled(self, scenario: Scenario, rng: np.random.Generator) -> NDArray[np.bool_]:
        """Return which cells are filled in the end, shape (columns, rows)."""
        filled = rng.random(self._cells(scenario)) < self.fill
        for _ in range(self.smoothing):
            around = np.pad(filled, 1).astype(int)
            columns, rows = filled.shape
            neighbours = sum(
                around[1 + right : 1 + right + columns, 1 + up : 1 + up + rows]
                for right in (-1, 0, 1)
                for up in (-1, 0, 1)
                if right or up
            )
            filled = (neighbours >= _BORN) | (filled & (neighbours > _DIES))
        return filled

    def _pillars(self, scenario: Scenario, filled: NDArray[np.bool_]) -> tuple[Cylinder, ...]:
        """Return a pillar for each filled cell that is clear of start and goal."""
        places = ((np.argwhere(filled) + 0.5) * self.cell).round(DECIMALS)
        radius = self.cell / 2
        for centre, clear in kept_clear(scenario, self.margin):
            places = places[np.hypot(*(places - centre).T) > clear + radius]
        return tuple(
            Cylinder(shape="cylinder", position=(x, y), radius=radius) for x, y in places.tolist()
        )
