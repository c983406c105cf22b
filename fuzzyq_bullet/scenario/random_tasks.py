"""Tasks for sweeps: a seed becomes a start, a goal and obstacles between them."""

from __future__ import annotations

from typing import Any

import numpy as np

from fuzzyq_bullet.scenario.models import Arena, Goal, Scenario, Start

_INSET = 0.1
"""How far from both walls a corner's place is, as a share of the arena's sides."""
_LEAST_INSET = 0.6
"""The same in metres, at least."""
_JITTER = 0.3
"""How far a place is moved along each axis, at most (m)."""


def random_task(
    seed: int,
    *,
    count: int | None = 50,
    layout: str = "scatter",
    size: tuple[float, float] = (10.0, 10.0),
    walls: bool = True,
    goal_radius: float = 0.2,
    **parameters: Any,
) -> Scenario:
    """Return a scenario with start and goal near two different corners of the arena.

    Its obstacles are still to be drawn (``realise``), with the same seed. Which corners, and where
    about them, has a stream of the seed to itself: layouts and counts can be compared on the same
    starts and goals.

    Args:
        seed: 0 to 2⁶³ − 1.
        count: How many obstacles, for layouts that have a count; None for those without.
        layout: Name of a layout.
        size: Width and depth of the arena (m), at least 2 m each.
        walls: Whether walls stand on its edges.
        goal_radius: Radius of the goal disc (m).
        **parameters: Other parameters of the layout.

    Raises:
        pydantic.ValidationError: If the layout does not exist or has no such parameters.
        ValueError: If the arena is too small for four corners.
    """
    if min(size) < 2.0:
        raise ValueError(f"the arena must be at least 2 × 2 m, got {size[0]:g} × {size[1]:g}")
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(2,)))
    sides = np.array(size)
    inset = np.maximum(_INSET * sides, _LEAST_INSET)
    corners = rng.permutation(4)[:2]
    far = np.column_stack([corners % 2, corners // 2]).astype(bool)
    places = np.where(far, sides - inset, inset) + rng.uniform(-_JITTER, _JITTER, (2, 2))
    start, goal = ((float(x), float(y)) for x, y in places.round(4))
    given = {"layout": layout, **parameters}
    if count is not None:
        given["count"] = count
    return Scenario.model_validate(
        {
            "name": f"{layout}-{seed}",
            "seed": seed,
            "arena": Arena(size=size, walls=walls),
            "start": Start(position=start),
            "goal": Goal(position=goal, radius=goal_radius),
            "random": given,
        }
    )
