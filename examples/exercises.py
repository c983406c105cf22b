"""Three exercises in learning whose solutions are known: a corridor, a random walk, a cliff.

    python examples/exercises.py

prints how far from the solution Q(λ) still is in the corridor after 1, 10 and 100 episodes: with a
long trace one episode tells the whole way back from the door, without one a step of it. Change
the numbers at the end, or the problem.
"""

from __future__ import annotations

import numpy as np

from fuzzyq_bullet.learning import QLambda, Schedule, Setup, episode_rng, train
from fuzzyq_bullet.learning.learners import Floats

_START = (3, 0)
_GOAL = (3, 11)


class Corridor:
    """A corridor with a door at its right end: back (0) or forth (1), −1 for every step.

    Attributes:
        states: Places in it; the episode begins at 0 and ends beyond the last.
        outcome: ``door`` once it is reached.
    """

    actions = 2

    def __init__(self, states: int = 10) -> None:
        self.states = states
        self.outcome = "lost"
        self._place = 0

    def reset(self, episode: int, /) -> int:
        """Begin at the left end."""
        self.outcome, self._place = "lost", 0
        return 0

    def step(self, action: int, /) -> tuple[int, float, bool]:
        """Go one place back or forth."""
        self._place = max(0, self._place + (1 if action == 1 else -1))
        over = self._place == self.states
        if over:
            self.outcome = "door"
        return self._place, -1.0, over

    def solution(self, discount: float) -> Floats:
        """Return the optimal Q, shape (S, 2)."""
        values = [returns(self.states - place, discount) for place in range(self.states + 1)]
        places = range(self.states)
        return np.array(
            [[-1.0 + discount * values[to] for to in (max(0, p - 1), p + 1)] for p in places]
        )


class RandomWalk:
    """To the left or right by chance, until one end: +1 on the right, ``left`` on the left.

    There is one action only, so that Q is the value of the walk (Sutton & Barto, Examples 6.2 and
    7.1).

    Attributes:
        states: Places, an odd number; the episode begins in the middle.
        outcome: ``left`` or ``right``.
    """

    actions = 1

    def __init__(self, states: int = 5, *, left: float = 0.0, seed: int = 0) -> None:
        self.states = states
        self.outcome = "lost"
        self._left = left
        self._seed = seed
        self._place = 0
        self._rng = episode_rng(seed, 0, 1)

    def reset(self, episode: int, /) -> int:
        """Begin in the middle."""
        self._rng = episode_rng(self._seed, episode, 1)
        self.outcome, self._place = "lost", self.states // 2
        return self._place

    def step(self, action: int, /) -> tuple[int, float, bool]:
        """Go where chance leads; there is but one action."""
        self._place += 1 if self._rng.random() < 0.5 else -1
        if 0 <= self._place < self.states:
            return self._place, 0.0, False
        self.outcome = "left" if self._place < 0 else "right"
        return 0, self._left if self._place < 0 else 1.0, True

    def solution(self) -> Floats:
        """Return the values with discount 1, shape (S, 1): a straight line between the ends."""
        return np.linspace(self._left, 1.0, self.states + 2)[1:-1, np.newaxis]


class CliffWalk:
    """4 × 12 squares, the goal behind a cliff (Sutton & Barto, Example 6.6).

    Up, right, down or left cost −1; a step into the cliff costs −100 and leads back to the start.

    Attributes:
        outcome: ``goal`` once it is reached.
    """

    states, actions = 48, 4

    def __init__(self) -> None:
        self.outcome = "lost"
        self._at = _START

    def reset(self, episode: int, /) -> int:
        """Begin in the lower left corner."""
        self.outcome, self._at = "lost", _START
        return self._number(self._at)

    def step(self, action: int, /) -> tuple[int, float, bool]:
        """Go one square."""
        self._at, reward = self._move(self._at, action)
        over = self._at == _GOAL
        if over:
            self.outcome = "goal"
        return self._number(self._at), reward, over

    def solution(self, discount: float) -> Floats:
        """Return the optimal Q, shape (48, 4); NaN where nobody ever stands."""
        q = np.full((self.states, self.actions), np.nan)
        for at in [(r, c) for r in range(4) for c in range(12) if r < 3 or c == 0]:
            for action in range(self.actions):
                (row, column), reward = self._move(at, action)
                # Along the cliff's edge and down; from its foot at the start, up first.
                way = 11 - column + (3 - row if (row, column) != _START else 2)
                q[self._number(at), action] = reward + discount * returns(way, discount)
        return q

    @staticmethod
    def _move(at: tuple[int, int], action: int) -> tuple[tuple[int, int], float]:
        down, right = ((-1, 0), (0, 1), (1, 0), (0, -1))[action]
        row, column = min(3, max(0, at[0] + down)), min(11, max(0, at[1] + right))
        if row == 3 and 0 < column < 11:
            return _START, -100.0
        return (row, column), -1.0

    @staticmethod
    def _number(at: tuple[int, int]) -> int:
        return at[0] * 12 + at[1]


def returns(steps: int, discount: float) -> float:
    """Return the discounted return (Eq. 6) of so many steps at −1 each."""
    return -float(sum(discount**k for k in range(steps)))


if __name__ == "__main__":
    for trace in (0.0, 0.5, 0.9):
        for episodes in (1, 10, 100):
            learner = QLambda(10, Corridor.actions)
            how = Setup(episodes, rate=Schedule(0.5), trace_decay=Schedule(trace))
            train(Corridor(), learner, how)
            off = abs(learner.table - Corridor().solution(learner.discount)).max()
            print(f"λ = {trace}, {episodes:3} episodes: {off:.2f} off at most")
