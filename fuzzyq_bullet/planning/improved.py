"""The planner ``improved-fuzzy``: the routine part, ways out of dead ends, and the guard."""

from __future__ import annotations

from fuzzyq_bullet.planning.base import Decision, Observation
from fuzzyq_bullet.planning.escape import Escape
from fuzzyq_bullet.planning.guard import guarded
from fuzzyq_bullet.planning.routine import Routine
from fuzzyq_bullet.planning.settings import ImprovedFuzzySettings


class ImprovedFuzzyPlanner:
    """The fuzzy controller's step, or a way out where it finds none; never longer than is free."""

    def __init__(self, settings: ImprovedFuzzySettings) -> None:
        self._routine = Routine(settings)
        self._escape = Escape(following=settings.following) if settings.breakout else None
        self._guard = settings.guard

    def decide(self, observation: Observation, /) -> Decision:
        """Return the next step, capped by the guard."""
        decision = self._routine.decide(observation)
        if self._escape is not None:
            decision = self._escape.decide(decision, observation)
        return guarded(decision, observation) if self._guard else decision
