"""Learning weights, the paper's problem: for every encounter, choose what weighs how much."""

from __future__ import annotations

from fuzzyq_bullet.learning.linear import Features
from fuzzyq_bullet.planning.encounter import Encounters
from fuzzyq_bullet.planning.improved import Weighed
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.planning.weighing import ACTIONS, features_of
from fuzzyq_bullet.training.practice import Practice
from fuzzyq_bullet.training.tasks import Tasks

MOST_LOST = 5.0
"""The most that the time lost in one encounter counts for (s): of a longer search for a way out,
most is chance."""


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
        self._encounters = Encounters()
        self._look()
        return features_of(self._situation)

    def step(self, action: int, /) -> tuple[Features, float, bool]:
        """Drive through an encounter with the weights of an action."""
        weights, lost, fate = ACTIONS[action], 0.0, 0.0
        while True:
            decision = self._planner.act(
                self._observation, self._situation, weights[:2], weights.breakout_at
            )
            reward = self._practice.advance(decision)
            lost += reward.time + reward.progress
            fate += reward.contact + reward.given_up
            if self._look() or self._practice.over:
                earned = max(lost, -MOST_LOST) + fate
                return features_of(self._situation), earned, self._practice.over

    @property
    def outcome(self) -> str:
        """How the episode stands."""
        return self._practice.outcome

    def _look(self) -> bool:
        """Look where the robot is now, and return whether an encounter begins here."""
        self._observation = self._practice.observe()
        self._situation = seen = self._planner.sense(self._observation)
        return self._encounters.begins(seen.to_goal, self._planner.mode, clear=seen.clear)
