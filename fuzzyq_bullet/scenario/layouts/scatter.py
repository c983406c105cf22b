"""Obstacles scattered at random: Algorithm 2 of the paper, with its intent restored.

As printed, Algorithm 2 deletes obstacles while it loops over them and leaves fewer than asked for,
its distance lacks the root, its intervals are empty when start and goal share a coordinate, and it
protects the goal only in a corner. What it is for (Section 4.1, Eq. 23): no obstacle overlaps the
start or the goal. Here the count is exact, both discs keep a margin, every obstacle lies wholly
within the arena, and what cannot be done is said.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field as Given

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.quantities import (
    DECIMALS,
    MAX_OBSTACLES,
    MIN_RADIUS,
    TOUCH,
    Count,
    Flag,
    Number,
)
from fuzzyq_bullet.scenario.layouts.base import Conflict, Layout, register_layout, too_many
from fuzzyq_bullet.scenario.layouts.placing import kept_clear
from fuzzyq_bullet.shapes import Cylinder

if TYPE_CHECKING:
    from fuzzyq_bullet.scenario.models import Scenario

Floats: TypeAlias = NDArray[np.float64]

_BATCH = 1024
"""Places drawn at once. Fixed, so that a larger count begins with the places of a smaller one."""
_MAX_IDLE = 50
"""Batches in a row without a single place found after which there is taken to be none."""
_DENSEST = math.pi / math.sqrt(12.0)
"""Share of the plane that equal discs can cover at most without overlap."""


@register_layout
class Random(Layout):
    """Obstacles at random places: Algorithm 2, with its intent restored."""

    layout: Literal["scatter"] = "scatter"
    count: Annotated[Count, Given(ge=0, le=MAX_OBSTACLES)] = Given(description="How many.")
    radius: Annotated[Number, Given(ge=MIN_RADIUS, le=1000.0)] = Given(
        default=0.2, description="Radius of each (m)."
    )
    margin: Annotated[Number, Given(ge=0.0, le=100.0)] = Given(
        default=0.1, description="Least gap to the robot at the start and to the goal disc (m)."
    )
    overlap: Flag = Given(default=True, description="Whether obstacles may overlap one another.")

    def conflicts(self, scenario: Scenario) -> list[Conflict]:
        """Return what is too large for the arena or too many."""
        if self.count == 0:
            return []
        found: list[Conflict] = []
        least = min(scenario.arena.size)
        if 2.0 * self.radius > least:
            message = f"must be at most {least / 2:g} to fit, got {self.radius:g}"
            found.append((("radius",), message))
        return found + too_many(scenario, self.count)

    def draw(self, scenario: Scenario, rng: np.random.Generator) -> tuple[Cylinder, ...]:
        """Draw the cylinders, exactly as many."""
        if self.count and too_many(scenario, self.count):
            raise UserError(
                f"{scenario.name}: random.count: with the listed obstacles it makes more than "
                f"{MAX_OBSTACLES}"
            )
        places = np.empty((0, 2))
        idle = batches = 0
        hopeless = not self.overlap and self._too_dense(scenario.arena.size)
        while len(places) < self.count:
            if hopeless or idle > _MAX_IDLE or batches > _MAX_IDLE + self.count // 20:
                raise UserError(
                    f"{scenario.name}: random.count: cannot place {self.count} obstacles of radius "
                    f"{self.radius:g} in {scenario.arena.size[0]:g} × {scenario.arena.size[1]:g} m "
                    "clear of start and goal; use fewer, smaller ones or a smaller margin"
                    + ("" if self.overlap else ", or allow overlap")
                )
            fresh = self._free_of_one_another(self._batch(scenario, rng), places)
            places = np.concatenate([places, fresh])
            idle = 0 if len(fresh) else idle + 1
            batches += 1
        return tuple(
            Cylinder(shape="cylinder", position=(x, y), radius=self.radius)
            for x, y in places[: self.count].tolist()
        )

    def _batch(self, scenario: Scenario, rng: np.random.Generator) -> Floats:
        """Draw places at once; return, shape (K, 2), those that suit the arena, start and goal."""
        size = np.array(scenario.arena.size)
        r = self.radius
        low, high = np.minimum(r, size / 2), np.maximum(size - r, size / 2)
        drawn = rng.uniform(low, high, (_BATCH, 2)).round(DECIMALS)
        fits = np.all((drawn >= r - TOUCH) & (drawn <= size - r + TOUCH), axis=1)
        for centre, radius in kept_clear(scenario, self.margin):
            fits &= np.linalg.norm(drawn - centre, axis=1) > r + radius
        places: Floats = drawn[fits]
        if not self.overlap and scenario.obstacles:
            places = places[Field.of(scenario.obstacles).clearance(places) >= r]
        return places

    def _free_of_one_another(self, drawn: Floats, places: Floats) -> Floats:
        """Return those of ``drawn`` that overlap neither ``places`` nor an earlier one of them."""
        if self.overlap or not len(drawn):
            return drawn
        from scipy.spatial import KDTree  # only who draws obstacles waits for it to load

        if len(places):
            nearest, _ = KDTree(places).query(drawn)
            drawn = drawn[nearest >= 2 * self.radius]
        if not len(drawn):
            return drawn
        keep = np.ones(len(drawn), dtype=bool)
        pairs = KDTree(drawn).query_pairs(2 * self.radius, output_type="ndarray")
        for first, second in sorted(map(tuple, pairs.tolist())):
            if keep[first]:
                keep[second] = False
        kept: Floats = drawn[keep]
        return kept

    def _too_dense(self, size: tuple[float, float]) -> bool:
        """Tell whether discs without overlap would need more room than there is, however packed."""
        # A strip of one radius around makes up for the discs at the edge (Oler's inequality).
        width, depth = (side + 2 * self.radius for side in size)
        return self.count * math.pi * self.radius**2 > _DENSEST * width * depth
