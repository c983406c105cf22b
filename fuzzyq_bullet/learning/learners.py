"""The learners with a table: Q-learning (Eq. 7) and Watkins's Q(λ) (Eqs. 18 and 19).

States are the numbers 0 … S−1, actions 0 … A−1.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.learning.choices import epsilon_greedy
from fuzzyq_bullet.learning.schedules import TABLE_1

Floats: TypeAlias = NDArray[np.float64]
TraceKind: TypeAlias = Literal["accumulating", "replacing"]

FAINT = 1e-9
"""Traces no larger than this are dropped: they would move a value by a billionth of an error."""


class QLearning:
    """Q-learning (Eq. 7): each step updates the value of one state and action.

    Attributes:
        discount: ξ of Eq. 7.
    """

    def __init__(self, states: int, actions: int, *, discount: float = TABLE_1.decay) -> None:
        self.discount = discount
        self._q = [[TABLE_1.initial_value] * actions for _ in range(states)]
        self._rate = 0.0

    def begin(self, rate: float, trace_decay: float) -> None:
        """Begin an episode with the learning rate α. Q-learning has no traces to decay."""
        self._rate = rate

    def values(self, state: int) -> list[float]:
        """Return Q(s, ·), shape (A,), to look at."""
        return self._q[state]

    def choose(
        self, state: int, epsilon: float, rng: np.random.Generator, *, random_ties: bool = False
    ) -> int:
        """Choose an action ε-greedily."""
        return epsilon_greedy(self._q[state], epsilon, rng, random_ties=random_ties)

    def learn(self, state: int, action: int, reward: float, after: int | None) -> float:
        """Learn from one step (Eq. 7).

        Args:
            state: s, where it was.
            action: a, what it did there.
            reward: r, what that earned.
            after: s', where it led to; None if the episode is over, and nothing more is earned.

        Returns:
            δ, the temporal-difference error.
        """
        row = self._q[state]
        best = 0.0 if after is None else max(self._q[after])
        delta = reward + self.discount * best - row[action]
        row[action] += self._rate * delta
        return delta

    @property
    def table(self) -> Floats:
        """Q, shape (S, A): a copy to read; assign to it to go on from another one."""
        return np.array(self._q)

    @table.setter
    def table(self, table: Floats) -> None:
        shape = (len(self._q), len(self._q[0]))
        if table.shape != shape:
            raise ValueError(f"a table of shape {table.shape} for a learner of shape {shape}")
        self._q = table.tolist()

    def describe(self) -> dict[str, str | float]:
        """Return what it takes to build such a learner, beside its table."""
        return {"learner": "q-learning", "discount": self.discount}


class QLambda(QLearning):
    """Watkins's Q(λ) (Eq. 18): earlier greedy steps share in every error by their traces.

    In a table Q(s, a) is its own parameter, so the gradient in Eq. 18 is 1 for the pair at hand and
    0 for all others: e ← γλe, then e(s, a) + 1.

    Attributes:
        discount: γ of Eq. 18.
        kind: ``accumulating`` as Eq. 18 says, or ``replacing``: e(s, a) becomes 1 and no more.
    """

    def __init__(
        self,
        states: int,
        actions: int,
        *,
        discount: float = TABLE_1.discount,
        kind: TraceKind = "accumulating",
    ) -> None:
        super().__init__(states, actions, discount=discount)
        self.kind = kind
        self._traces: dict[tuple[int, int], float] = {}
        self._fade = 0.0

    def begin(self, rate: float, trace_decay: float) -> None:
        """Begin an episode with the learning rate α and trace decay λ: all traces are 0."""
        self._rate = rate
        self._fade = self.discount * trace_decay
        self._traces = {}

    def learn(self, state: int, action: int, reward: float, after: int | None) -> float:
        """Learn from one step (Eq. 18); arguments and result as those of Q-learning."""
        row = self._q[state]
        best = 0.0 if after is None else max(self._q[after])
        delta = reward + self.discount * best - row[action]

        # Watkins: after an action that was not the best, earlier traces end.
        fade = self._fade if row[action] == max(row) else 0.0
        traces = {pair: fade * e for pair, e in self._traces.items() if fade * e > FAINT}
        here = (state, action)
        traces[here] = 1.0 + (traces.get(here, 0.0) if self.kind == "accumulating" else 0.0)
        self._traces = traces

        step = self._rate * delta
        for (s, a), e in traces.items():
            self._q[s][a] += step * e
        return delta

    @property
    def traces(self) -> Floats:
        """The traces e, shape (S, A): a copy."""
        traces = np.zeros((len(self._q), len(self._q[0])))
        for pair, e in self._traces.items():
            traces[pair] = e
        return traces

    def describe(self) -> dict[str, str | float]:
        """Return what it takes to build such a learner, beside its table."""
        return {"learner": "q-lambda", "discount": self.discount, "traces": self.kind}
