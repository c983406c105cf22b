"""What every layout is: parameters that a scenario gives, and how to draw from them."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from fuzzyq_bullet.scenario.shapes import MAX_OBSTACLES, Model, Obstacle

if TYPE_CHECKING:
    import numpy as np

    from fuzzyq_bullet.scenario.models import Scenario

Conflict: TypeAlias = tuple[tuple[str, ...], str]
"""The keys below ``random`` that lead to what cannot be right, and what is wrong with it."""


class Layout(Model):
    """The ``random`` part of a scenario. Subclasses narrow ``layout`` to their own name."""

    layout: str

    def draw(self, scenario: Scenario, rng: np.random.Generator) -> tuple[Obstacle, ...]:
        """Return the obstacles, beside those that the scenario lists.

        The same scenario and generator give the same obstacles; none of them overlaps the start or
        the goal disc; coordinates are rounded to 0.1 mm.

        Raises:
            UserError: If they cannot be placed.
        """
        raise NotImplementedError

    def conflicts(self, scenario: Scenario) -> list[Conflict]:
        """Return what can be known to be impossible without drawing."""
        return []


def too_many(scenario: Scenario, count: int, key: str = "count") -> list[Conflict]:
    """Return the conflict of more obstacles than a scenario may have, if it is one."""
    room = MAX_OBSTACLES - len(scenario.obstacles)
    if count <= room:
        return []
    return [((key,), f"must be at most {room} beside the listed obstacles, got {count}")]
