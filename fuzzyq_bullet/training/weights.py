"""Learning weights, the paper's problem: at every decision, choose what to put on the situation."""

from __future__ import annotations

from fuzzyq_bullet.learning.linear import Features
from fuzzyq_bullet.planning.improved import Weighed
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.planning.weighing import ACTIONS, features_of
from fuzzyq_bullet.training.practice import Practice
from fuzzyq_bullet.training.tasks import Tasks


class WeightsProblem:
    """The problem that ``fuzzy-q-lambda`` learns (``learning.Problem``).

    States and actions are those of ``planning.weighing``, the reward is ``training.rewards`` with
    progress along the true shortest way (``training.ways``).

    Args:
        tasks: Where it is learned.
    """

    def __init__(self, tasks: Tasks) -> None:
        self._practice = Practice(tasks, true_ways=True)

    def reset(self, episode: int, /) -> Features:
        """Begin an episode."""
        self._practice.begin(episode)
        self._planner = Weighed(FuzzyQLambdaSettings())
        return self._look()

    def step(self, action: int, /) -> tuple[Features, float, bool]:
        """Decide with the weights of an action."""
        weights = ACTIONS[action]
        reward = self._practice.advance(
            self._planner.act(self._observation, self._situation, weights[:2], weights.breakout_at)
        )
        return self._look(), reward.total, self._practice.over

    @property
    def outcome(self) -> str:
        """How the episode stands."""
        return self._practice.outcome

    def _look(self) -> Features:
        self._observation = self._practice.observe()
        self._situation = self._planner.sense(self._observation)
        return features_of(self._situation, self._planner.mode)
