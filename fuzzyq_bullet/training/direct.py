"""Learning headings: the problem of ``q-learning`` and ``q-lambda``."""

from __future__ import annotations

from fuzzyq_bullet.planning.direct import act, sense
from fuzzyq_bullet.training.practice import Practice
from fuzzyq_bullet.training.tasks import Tasks


class DirectProblem:
    """The problem that the direct planners learn (``learning.Problem``).

    States and actions are those of ``planning.direct``, the reward is ``training.rewards``. An
    episode does not end with a contact: the robot is put back and goes on. With nothing that guards
    it, hardly an episode would get far otherwise, and most states would never be seen.

    Args:
        tasks: Where it is learned.
    """

    def __init__(self, tasks: Tasks) -> None:
        self._practice = Practice(tasks, hits_end=False)

    def reset(self, episode: int, /) -> int:
        """Begin an episode."""
        self._practice.begin(episode)
        return self._look()

    def step(self, action: int, /) -> tuple[int, float, bool]:
        """Take the step of an action."""
        reward = self._practice.advance(act(self._sight, action))
        return self._look(), reward.total, self._practice.over

    @property
    def outcome(self) -> str:
        """How the episode stands; ``collision`` once anything was hit, whatever came after."""
        return self._practice.outcome

    def _look(self) -> int:
        self._sight = sense(self._practice.observe())
        return self._sight.state
