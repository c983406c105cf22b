"""The planner ``fuzzy-q-lambda``, the paper's own: the improved one with learned weights."""

from __future__ import annotations

from fuzzyq_bullet.learning import Policy, greedy
from fuzzyq_bullet.planning.base import Decision, Observation
from fuzzyq_bullet.planning.improved import Weighed
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.planning.weighing import ACTIONS, features_of


class FuzzyQLambdaPlanner(Weighed):
    """Takes, in every situation, the weights that were worth most when it learned.

    Args:
        settings: The planner's settings.
        policy: What it learned: a row of weights for each feature, a column for each action.
    """

    def __init__(self, settings: FuzzyQLambdaSettings, policy: Policy) -> None:
        super().__init__(settings)
        self._table = policy.array()

    def decide(self, observation: Observation, /) -> Decision:
        """Return the next step with the weights that are worth most here."""
        situation = self.sense(observation)
        state = features_of(situation, self.mode)
        # Added row by row, as in learning: matrix products round differently on other processors.
        values = (self._table[state.indices] * state.values[:, None]).sum(axis=0)
        action = ACTIONS[greedy(values.tolist())]
        return self.act(observation, situation, action[:2], action.breakout_at)
