"""The planner ``fuzzy``: the traditional baseline, the fuzzy controller and nothing else."""

from __future__ import annotations

from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.routine import Routine
from fuzzyq_bullet.planning.settings import FuzzySettings


class FuzzyPlanner:
    """Takes every step that the controller proposes; no guard, no way out of a dead end."""

    def __init__(self, settings: FuzzySettings) -> None:
        self._routine = Routine(settings)
        self._weights = settings.weights

    def decide(self, observation: Observation, /) -> Decision:
        """Return the controller's step, braking for what the middle line sees."""
        return self._routine.step(self._routine.sense(observation), self._weights)
