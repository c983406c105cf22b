"""Traps between start and goal: arcs, dead ends, walls; where they stand and how they open."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import MAX_OBSTACLES, MIN_RADIUS, Angle, Number, Point
from fuzzyq_bullet.scenario.layouts.base import Layout, register_layout
from fuzzyq_bullet.scenario.layouts.placing import (
    is_clear,
    is_inside,
    leaves_a_way,
)
from fuzzyq_bullet.shapes import Box, Cylinder, Obstacle

if TYPE_CHECKING:
    import numpy as np
    from typing_extensions import Self

    from fuzzyq_bullet.scenario.models import Scenario

_ATTEMPTS = 100
"""Draws after which a trap is taken not to fit."""
_SHRINK = 0.6
"""How much smaller drawn sizes are in the last of these draws than in the first."""
_ALONG = (0.35, 0.65)
"""Share of the way from start to goal at which a drawn trap stands."""
_ASIDE = 0.08
"""How far a drawn trap stands beside that way, at most, as a share of it."""
_TURN = 0.6
"""How far the opening of a drawn trap is turned away from the start, at most (rad)."""
_SHIFT = 0.45
"""How far a wall is shifted along itself, at most, as a share of its length."""
_Side = Annotated[Number, Field(ge=0.4, le=500.0)]


class Trap(Layout):
    """Something that stands in the way and opens towards the start.

    What is not given is drawn, again and again until the trap lies within the arena, keeps clear
    of start and goal, and surely leaves the robot a way round.
    """

    position: Point | None = Field(
        default=None, description="Its middle (m); default: drawn, between start and goal."
    )
    direction: Angle | None = Field(
        default=None, description="Where it opens to (rad); default: drawn, towards the start."
    )
    margin: Annotated[Number, Field(ge=0.0, le=100.0)] = Field(
        default=0.3, description="Least gap to the robot at the start and to the goal disc (m)."
    )

    def moved(self, x: float, y: float) -> Self:
        """Return it with its middle moved (m), if that is given."""
        if self.position is None:
            return self
        at = (self.position[0] + x, self.position[1] + y)
        return self.model_copy(update={"position": at})

    def build(self, reach: float, rng: np.random.Generator) -> tuple[Obstacle, ...]:
        """Return the trap with its middle at the origin, opening along x.

        Args:
            reach: Length (m) by which drawn sizes are measured: the distance from start to goal,
                or less after draws that did not fit.
            rng: Draws the sizes that are not given.
        """
        raise NotImplementedError

    def draw(self, scenario: Scenario, rng: np.random.Generator) -> tuple[Obstacle, ...]:
        """Draw the trap, again until it can stay."""
        start, goal = scenario.start.position, scenario.goal.position
        reach = math.dist(start, goal)
        room = MAX_OBSTACLES - len(scenario.obstacles)
        refused: set[tuple[Obstacle, ...]] = set()
        for attempt in range(_ATTEMPTS):
            x, y = self._middle(start, goal, rng)
            turn = self._opening((x, y), start, rng)
            parts = self.build(reach * (1.0 - _SHRINK * attempt / _ATTEMPTS), rng)
            if len(parts) > room:
                break
            placed = tuple(part.moved(x, y, turn) for part in parts)
            if placed in refused:  # nothing of it is drawn
                continue
            if (
                all(is_inside(part, scenario.arena.size) for part in placed)
                and is_clear(scenario, placed, self.margin)
                and leaves_a_way(scenario, placed)
            ):
                return placed
            refused.add(placed)
        width, depth = scenario.arena.size
        raise UserError(
            f"{scenario.name}: random.layout: cannot place {self.layout} within {width:g} × "
            f"{depth:g} m, clear of start and goal and with a way round; make it smaller, or start "
            "and goal farther apart"
        )

    def _middle(self, start: Point, goal: Point, rng: np.random.Generator) -> Point:
        along, aside = rng.uniform(*_ALONG), rng.uniform(-_ASIDE, _ASIDE)
        if self.position is not None:
            return self.position
        dx, dy = goal[0] - start[0], goal[1] - start[1]
        return start[0] + along * dx - aside * dy, start[1] + along * dy + aside * dx

    def _opening(self, middle: Point, start: Point, rng: np.random.Generator) -> float:
        turn = rng.uniform(-_TURN, _TURN)
        if self.direction is not None:
            return self.direction
        return math.atan2(start[1] - middle[1], start[0] - middle[0]) + float(turn)


def drawn(
    given: float | None, rng: np.random.Generator, low: float, high: float, least: float = 0.0
) -> float:
    """Return what is given, or draw it from ``low`` to ``high``, but at least ``least``."""
    value = max(float(rng.uniform(low, high)), least)  # drawn anyway: the rest stays the same
    return value if given is None else given


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


@register_layout
class Semicircle(_Curved):
    """Half a circle of overlapping cylinders: the trap that breakout alone never leaves."""

    layout: Literal["semicircle"]

    def build(self, reach: float, rng: np.random.Generator) -> tuple[Cylinder, ...]:
        """Return half a circle about the origin, opening along x."""
        return self.along(math.pi, reach, rng)


@register_layout
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


@register_layout
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


@register_layout
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
