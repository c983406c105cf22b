"""The two protocols of learning: a problem, and a learner."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol, TypeVar

from fuzzyq_bullet.learning.tabular import Floats

State = TypeVar("State")
StateOut = TypeVar("StateOut", covariant=True)
StateIn = TypeVar("StateIn", contravariant=True)


class Problem(Protocol[StateOut]):
    """A Markov decision process to be learned in episodes.

    Nothing may be carried from one episode into the next, and all chance must come from the
    episode's number (``training.episode_rng``): this is what lets a training be interrupted and
    resumed without a trace.
    """

    def reset(self, episode: int, /) -> StateOut:
        """Begin an episode, counted from 1, and return its first state."""
        ...

    def step(self, action: int, /) -> tuple[StateOut, float, bool]:
        """Do an action.

        Returns:
            The state it leads to; the reward; and whether the task is over, so that nothing
            more can be earned and the state does not count. Running out of steps is not the end
            of the task: leave that to ``Setup.max_steps``.
        """
        ...

    @property
    def outcome(self) -> str:
        """How the episode stands, in at most 16 plain letters, such as ``goal``."""
        ...


class Learner(Protocol[StateIn]):
    """Learns the values of actions."""

    def begin(self, rate: float, trace_decay: float) -> None:
        """Begin an episode with the learning rate α and trace decay λ; all traces are 0."""
        ...

    def values(self, state: StateIn, /) -> Sequence[float]:
        """Return Q(s, ·), shape (A,)."""
        ...

    def learn(self, state: StateIn, action: int, reward: float, after: StateIn | None, /) -> float:
        """Learn from one step and return its error δ; ``after`` is None when the task is over."""
        ...

    @property
    def table(self) -> Floats:
        """All that was learned, shape (S, A) or (F, A); may be assigned."""
        ...

    @table.setter
    def table(self, table: Floats, /) -> None: ...

    def describe(self) -> Mapping[str, str | float]:
        """Return what it takes to build such a learner, beside its table."""
        ...
