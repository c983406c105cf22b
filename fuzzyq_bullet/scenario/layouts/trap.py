"""Traps between start and goal: what they share is where they stand and which way they open."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario.layouts.base import Layout
from fuzzyq_bullet.scenario.layouts.placing import (
    DECIMALS,
    is_clear,
    is_inside,
    leaves_a_way,
)
from fuzzyq_bullet.scenario.shapes import MAX_OBSTACLES, Angle, Box, Number, Obstacle, Point

if TYPE_CHECKING:
    import numpy as np

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
            placed = tuple(_moved(part, x, y, turn) for part in parts)
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


def _moved(part: Obstacle, x: float, y: float, turn: float) -> Obstacle:
    cos, sin = math.cos(turn), math.sin(turn)
    px, py = part.position
    at = round(x + cos * px - sin * py, DECIMALS), round(y + sin * px + cos * py, DECIMALS)
    if isinstance(part, Box):
        yaw = round(math.remainder(part.yaw + turn, math.tau), 2 + DECIMALS)
        size = round(part.size[0], DECIMALS), round(part.size[1], DECIMALS)
        return Box(shape="box", position=at, size=size, yaw=yaw)
    return part.model_copy(update={"position": at})
