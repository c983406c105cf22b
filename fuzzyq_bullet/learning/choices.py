"""How an action is chosen: the best one, or any for the sake of learning."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def greedy(values: Sequence[float], rng: np.random.Generator | None = None) -> int:
    """Return the number of the best action.

    Args:
        values: Q(s, ·), one value an action.
        rng: Chooses among equals; without it the first of them is taken.
    """
    best = max(values)
    if rng is None:
        return values.index(best)
    equals = [action for action, value in enumerate(values) if value == best]
    return equals[int(rng.integers(len(equals)))] if len(equals) > 1 else equals[0]


def epsilon_greedy(
    values: Sequence[float],
    epsilon: float,
    rng: np.random.Generator,
    *,
    random_ties: bool = False,
) -> int:
    """Explore: return any action with the chance ``epsilon``, else the best.

    Args:
        values: Q(s, ·), one value an action.
        epsilon: ε, the chance (0 to 1) of an action drawn from all, the best included.
        rng: The episode's own generator.
        random_ties: Whether equals are drawn from too; else the first of them is taken.
    """
    if rng.random() < epsilon:
        return int(rng.integers(len(values)))
    return greedy(values, rng if random_ties else None)
