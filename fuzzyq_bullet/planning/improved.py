"""The planner ``improved-fuzzy``: the routine part under the guard."""

from __future__ import annotations

from fuzzyq_bullet.planning.base import Decision, Observation
from fuzzyq_bullet.planning.guard import guarded
from fuzzyq_bullet.planning.routine import Routine
from fuzzyq_bullet.planning.settings import ImprovedFuzzySettings


class ImprovedFuzzyPlanner:
    """The fuzzy controller's step, never longer than what is free."""

    def __init__(self, settings: ImprovedFuzzySettings) -> None:
        self._routine = Routine(settings)
        self._guard = settings.guard

    def decide(self, observation: Observation, /) -> Decision:
        """Return the controller's step, capped by the guard."""
        decision = self._routine.decide(observation)
        return guarded(decision, observation) if self._guard else decision
