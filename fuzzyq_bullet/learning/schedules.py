"""The paper's parameters of learning: Table 1, and Eqs. 20 and 21 over the episodes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fuzzyq_bullet.errors import UserError


@dataclass(frozen=True, slots=True)
class Table1:
    """Initial setting parameters of the algorithm (Table 1).

    The paper has two discounts. Each is used by the equation that prints its symbol, and both do
    the same: a reward one step later counts that much less.

    Attributes:
        initial_value: Q before any learning.
        initial_trace: e at the beginning of every episode.
        decay: ξ, the discount of Q-learning (Eq. 7).
        discount: γ, the discount of the return (Eq. 6) and of Q(λ) (Eqs. 18 and 19).
    """

    initial_value: float = 0.0
    initial_trace: float = 0.0
    decay: float = 0.9
    discount: float = 0.95


TABLE_1 = Table1()


@dataclass(frozen=True, slots=True)
class Schedule:
    """A quantity that falls in a straight line over the episodes: start − drop·(i / N).

    Attributes:
        start: Where it begins, within [0, 1].
        drop: How much it has fallen in the last episode; 0 for a constant.
    """

    start: float
    drop: float = 0.0

    def __post_init__(self) -> None:
        values = (self.start, self.start - self.drop)
        if not all(math.isfinite(value) and 0.0 <= value <= 1.0 for value in values):
            raise UserError(
                f"a schedule must stay between 0 and 1, got {values[0]:g} to {values[1]:g}"
            )

    def at(self, episode: int, episodes: int) -> float:
        """Return the value in one episode.

        Args:
            episode: i of Eqs. 20 and 21, counted from 1, so that the last one ends the line.
            episodes: Max.Episodes.
        """
        return self.start - self.drop * (episode / episodes)


LEARNING_RATE = Schedule(0.1, 0.09)
"""η of Eq. 20, the α of Eqs. 7 and 18: 0.1 − 0.09·(i / Max.Episodes)."""
TRACE_DECAY = Schedule(0.01, 0.009)
"""λ of Eq. 21: 0.01 − 0.009·(i / Max.Episodes). So small a λ is almost Q-learning."""
EXPLORATION = Schedule(0.5, 0.45)
"""ε, of which the paper says nothing: the chance of an action at random falls from 0.5 to 0.05."""
