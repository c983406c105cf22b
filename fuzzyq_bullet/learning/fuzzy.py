"""Fuzzy Q(λ): every fuzzy rule learns what is best for itself (Jouffe 1998).

A state is the degrees φ_i(s) to which the rules fire, Σ φ_i = 1. Each rule i has the same J actions
to choose from, chooses its own, j_i, and has a value q(i, j) for each. Together

    Q(s, j) = Σ φ_i·q(i, j_i)        V(s) = Σ φ_i·max_j q(i, j)

so ∂Q/∂q(i, j_i) = φ_i. This is the gradient that Eqs. 18 and 19 ask for and a table does not have:

    δ = r + γ·V(s') − Q(s, j)        δ_V = r + γ·V(s') − V(s)
    e ← γλ·e;   q ← q + η·δ_V·e
    q(i, j_i) ← q(i, j_i) + η·δ·φ_i;   e(i, j_i) ← e(i, j_i) + φ_i

Where every rule takes its best action δ_V = δ, and with one rule that fires in each state this is
Q(λ) in a table.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.learning.choices import greedy
from fuzzyq_bullet.learning.learners import FAINT, Floats, TraceKind
from fuzzyq_bullet.learning.schedules import TABLE_1


class FuzzyQLambda:
    """Fuzzy Q(λ). Nothing cuts its traces.

    Watkins ends them after an action that is not the best. Where 25 rules each try things for
    themselves hardly a step is the best in all of them, and there would be no traces at all. So
    earlier steps share in δ_V instead, in which what was tried for its own sake has no part (Peng
    and Williams 1996); with δ in its place the values would grow without end.

    Attributes:
        discount: γ of Eqs. 18 and 19.
        kind: ``accumulating``: e + φ, as the equations say; or ``replacing``: e becomes φ where
            that is more.
        twins: For each rule the number of its mirror image, shape (R,); its own if it is that
            itself. Every step is learned from as its mirror image too. Empty: none.
        patience: For how many steps a rule stands by what it tries, on average. One that changes
            its mind at every step does nothing that lasts long enough to show.
    """

    def __init__(
        self,
        rules: int,
        actions: int,
        *,
        discount: float = TABLE_1.discount,
        kind: TraceKind = "accumulating",
        twins: Sequence[int] = (),
        patience: float = 1.0,
    ) -> None:
        self.discount = discount
        self.kind = kind
        self.patience = patience
        self.twins = tuple(twins)
        # A rule that is its own mirror image learns once, not twice.
        alone = np.array([twin == rule for rule, twin in enumerate(twins)], dtype=bool)
        self._reflected = np.where(alone, 0.0, 1.0)[:, np.newaxis]
        self._mirror: NDArray[np.intp] = np.array(self.twins, dtype=np.intp)
        self._q = np.full((rules, actions), TABLE_1.initial_value)
        self._traces = np.full((rules, actions), TABLE_1.initial_trace)
        self._tried: list[int | None] = []
        self._rate = 0.0
        self._fade = 0.0

    def begin(self, rate: float, trace_decay: float) -> None:
        """Begin an episode with the learning rate η and trace decay λ: all traces are 0."""
        self._rate = rate
        self._fade = self.discount * trace_decay
        self._traces.fill(TABLE_1.initial_trace)
        self._tried = []

    def choose(
        self, state: Floats, epsilon: float, rng: np.random.Generator, *, random_ties: bool = False
    ) -> tuple[int, ...]:
        """Let every rule choose ε-greedily for itself, whether it fires here or not.

        It stands by what it tries for ``patience`` steps on average, at most to the episode's end.

        Args:
            state: φ(s), shape (R,).
            epsilon: ε, the chance of each rule to take any of its actions.
            rng: The episode's own generator.
            random_ties: Whether equals are drawn from too; else the first of them is taken.

        Returns:
            j, one action for each rule.
        """
        rules, actions = self._q.shape
        if not self._tried:
            self._tried, changes = [None] * rules, np.ones(rules, dtype=bool)
        else:
            changes = rng.random(rules) < 1.0 / self.patience
        for rule in np.flatnonzero(changes).tolist():
            tries = rng.random() < epsilon
            self._tried[rule] = int(rng.integers(actions)) if tries else None
        ties = rng if random_ties else None
        return tuple(
            greedy(row, ties) if tried is None else tried
            for row, tried in zip(self._q.tolist(), self._tried, strict=True)
        )

    def value(self, state: Floats, actions: Sequence[int]) -> float:
        """Return Q(s, j).

        Args:
            state: φ(s), shape (R,).
            actions: j, shape (R,).
        """
        # An exact sum: others round differently on other processors.
        return math.fsum((state * self._q[np.arange(len(state)), actions]).tolist())

    def best(self, state: Floats) -> float:
        """Return V(s): Q where every rule takes its best action."""
        return math.fsum((state * self._q.max(axis=1)).tolist())

    def learn(
        self, state: Floats, actions: Sequence[int], reward: float, after: Floats | None
    ) -> float:
        """Learn from one step (Eqs. 18 and 19 with the gradient φ).

        Args:
            state: φ(s), where it was, shape (R,).
            actions: j, what each rule chose there, shape (R,).
            reward: r, what that earned.
            after: φ(s'), where it led to; None if the episode is over.

        Returns:
            δ, the error that was found.
        """
        found = reward + (0.0 if after is None else self.discount * self.best(after))
        delta = found - self.value(state, actions)
        here = np.arange(len(state)), actions

        traces = self._traces
        traces *= self._fade
        traces[traces <= FAINT] = 0.0
        grown = traces[here] + state if self.kind == "accumulating" else state
        traces[here] = np.maximum(traces[here], grown)
        of_best = found - self.best(state)
        change = of_best * traces
        change[here] += (delta - of_best) * state
        if self.twins:
            change += change[self._mirror] * self._reflected
        self._q += self._rate * change
        return delta

    @property
    def table(self) -> Floats:
        """The values q, shape (R, J): a copy to read; assign to it to go on from others."""
        return self._q.copy()

    @table.setter
    def table(self, table: Floats) -> None:
        if table.shape != self._q.shape:
            raise ValueError(f"a table of shape {table.shape} for a learner of {self._q.shape}")
        self._q = np.array(table, dtype=np.float64)

    @property
    def traces(self) -> Floats:
        """The traces e, shape (R, J): a copy."""
        return self._traces.copy()

    def describe(self) -> dict[str, str | float]:
        """Return what it takes to build such a learner, beside its table."""
        return {
            "learner": "fuzzy-q-lambda",
            "discount": self.discount,
            "traces": self.kind,
            "patience": self.patience,
        }
