"""Wandering obstacles at random places, beside whatever a layout lets stand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field as Given
from pydantic import field_validator
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import DECIMALS, MIN_RADIUS, TOUCH, Count, Model, Number
from fuzzyq_bullet.scenario.movers import standing_field
from fuzzyq_bullet.shapes import Cylinder
from fuzzyq_bullet.shapes.motion import MAX_MOTION_SPEED
from fuzzyq_bullet.shapes.motions import Speed, Wander
from fuzzyq_bullet.wording import shorten

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fuzzyq_bullet.scenario.models import Scenario
    from fuzzyq_bullet.shapes import Obstacle

STREAM = 21
"""Stream of the seed that draws them: what stands is where it would be without them."""
START_GAP = 1.0
"""Least gap between the robot at the start and each of them (m): it sees what comes."""
MOST = 200
_USUAL_SPEED = (0.1, 0.5)
_BATCH = 256
"""Places drawn at once. Fixed, so that a larger count begins with those of a smaller one."""
_MOST_BATCHES = 40


class Wanderers(Model):
    """Round obstacles that wander: ``random.movers`` of a scenario file."""

    count: Annotated[Count, Given(ge=0, le=MOST)] = Given(description="How many.")
    radius: Annotated[Number, Given(ge=MIN_RADIUS, le=10.0)] = Given(
        default=0.25, description="Radius of each (m)."
    )
    speed: tuple[Speed, Speed] = Given(
        default=_USUAL_SPEED,
        description="Least and greatest speed (m/s); each has its own between.",
    )

    @field_validator("speed", mode="before")
    @classmethod
    def _two_in_order(cls, value: Any) -> Any:
        """Refuse what is not a least and a greatest speed; their bounds are checked afterwards."""
        given = value if isinstance(value, list | tuple) else [value]
        numbers = [v for v in given if isinstance(v, int | float) and not isinstance(v, bool)]
        if len(given) == len(numbers) == 2 and not numbers[0] > numbers[1]:
            return value
        allowed = numbers and all(0.0 < one <= MAX_MOTION_SPEED for one in numbers)
        least, greatest = (min(numbers), max(numbers)) if allowed else _USUAL_SPEED
        raise PydanticCustomError(
            "speed",
            "must be the least and the greatest speed (m/s), such as {right}; got {value}",
            {"right": f"[{least:g}, {greatest:g}]", "value": shorten(value)},
        )

    def conflicts(self, scenario: Scenario) -> list[tuple[str, str]]:
        """Return what can be known to be impossible without drawing: keys, and messages."""
        least = min(scenario.arena.size)
        if self.count == 0 or 2.0 * self.radius < least:
            return []
        return [("radius", f"must be less than {least / 2:g} to fit, got {self.radius:g}")]

    def draw(
        self, scenario: Scenario, standing: Sequence[Obstacle], seed: int
    ) -> tuple[Cylinder, ...]:
        """Draw them: 1 m clear of the robot at the start, off the goal, and in nothing that stands.

        Args:
            scenario: The scenario, whose arena, start and goal count.
            standing: All its obstacles, drawn ones included.
            seed: The seed of the run.

        Raises:
            UserError: If there is no room for them.
        """
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(STREAM,)))
        left, bottom, right, top = scenario.arena.bounds
        field, start, goal = standing_field(standing, scenario.arena), scenario.start, scenario.goal
        kept_clear = (
            (start.position, scenario.robot.radius + START_GAP),
            (goal.position, max(goal.radius, scenario.robot.radius)),
        )
        found: list[list[float]] = []
        for _ in range(_MOST_BATCHES):
            if len(found) >= self.count:
                break
            drawn = rng.uniform((left, bottom, 0.0), (right, top, 1.0), (_BATCH, 3))
            places = drawn[:, :2] = drawn[:, :2].round(DECIMALS)
            fits = field.clearance(places) > self.radius + 2 * TOUCH
            for centre, radius in kept_clear:
                fits &= np.hypot(*(places - centre).T) > self.radius + radius
            found += drawn[fits].tolist()
        else:
            raise UserError(
                f"{scenario.name}: random.movers.count: cannot place {self.count} of radius "
                f"{self.radius:g} clear of start, goal and what stands; use fewer or smaller ones"
            )
        least, greatest = self.speed
        return tuple(
            Cylinder(
                shape="cylinder",
                position=(x, y),
                radius=self.radius,
                motion=Wander(
                    kind="wander", speed=round(least + part * (greatest - least), DECIMALS)
                ),
            )
            for x, y, part in found[: self.count]
        )
