"""Tasks for sweeps: a seed becomes a start, a goal and obstacles between them."""

from __future__ import annotations

import numpy as np

from fuzzyq_bullet.scenario.models import Arena, Goal, Scenario, Start

SIDE = 10.0
"""Of the arena (m)."""
_INSET = 1.0
"""How far from both walls a corner's place is (m)."""
_JITTER = 0.3
"""How far a place is moved along each axis, at most (m)."""


def random_task(
    seed: int,
    *,
    count: int | None = 50,
    layout: str = "scatter",
) -> Scenario:
    """Return a scenario with start and goal near two different corners of the arena.

    Its obstacles are still to be drawn (``realise``), with the same seed. Which corners, and where
    about them, has a stream of the seed to itself: layouts and counts can be compared on the same
    starts and goals.

    Args:
        seed: 0 to 2⁶³ − 1.
        count: How many obstacles, for layouts that have a count; None for those without.
        layout: Name of a layout.

    Raises:
        pydantic.ValidationError: If the layout does not exist, or has no count.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(2,)))
    corners = rng.permutation(4)[:2]
    far = np.column_stack([corners % 2, corners // 2]).astype(bool)
    places = np.where(far, SIDE - _INSET, _INSET) + rng.uniform(-_JITTER, _JITTER, (2, 2))
    start, goal = ((float(x), float(y)) for x, y in places.round(4))
    return Scenario.model_validate(
        {
            "name": f"{layout}-{seed}",
            "seed": seed,
            "arena": Arena(size=(SIDE, SIDE)),
            "start": Start(position=start),
            "goal": Goal(position=goal),
            "random": {"layout": layout} if count is None else {"layout": layout, "count": count},
        }
    )
