"""The planner ``fuzzy-q-lambda``, the paper's own: the improved one with learned weights."""

from __future__ import annotations

from fuzzyq_bullet.learning import Policy, greedy
from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.encounter import Encounters
from fuzzyq_bullet.planning.improved import Weighed
from fuzzyq_bullet.planning.routine import Situation
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.planning.weighing import ACTIONS, Weights, features_of


class FuzzyQLambdaPlanner(Weighed):
    """Takes, for every encounter, the weights that were worth most when it learned.

    Args:
        settings: The planner's settings.
        policy: What it learned: a row of weights for each feature, a column for each action.
    """

    def __init__(self, settings: FuzzyQLambdaSettings, policy: Policy) -> None:
        super().__init__(settings)
        self._table = policy.array()
        self._encounters = Encounters()
        self._chosen = ACTIONS[0]

    def decide(self, observation: Observation, /) -> Decision:
        """Return the next step with the weights that were worth most where the encounter began."""
        situation = self.sense(observation)
        if self._encounters.begins(situation.to_goal, self.mode, clear=situation.clear):
            self._chosen = self._best(situation)
        return self.act(observation, situation, self._chosen[:2], self._chosen.breakout_at)

    def _best(self, situation: Situation) -> Weights:
        state = features_of(situation)
        # Added row by row, as in learning: matrix products round differently on other processors.
        values = (self._table[state.indices] * state.values[:, None]).sum(axis=0)
        return ACTIONS[greedy(values.tolist())]
