"""The planner ``improved-fuzzy``: the routine part, ways out of dead ends, and the guard."""

from __future__ import annotations

from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.decision import Decision, Mode
from fuzzyq_bullet.planning.escape import Escape
from fuzzyq_bullet.planning.guard import guarded
from fuzzyq_bullet.planning.routine import Routine, Situation
from fuzzyq_bullet.planning.settings import ImprovedFuzzySettings, WaysOutSettings


class Weighed:
    """A decision in two halves, with room for weights between them.

    The fuzzy controller's step, or a way out where it finds none; never longer than is free.

    Attributes:
        mode: The mode of the latest decision.
    """

    def __init__(self, settings: WaysOutSettings) -> None:
        self._routine = Routine(settings)
        self._escape = Escape(following=settings.following) if settings.breakout else None
        self._guard = settings.guard
        self._breakout_at = settings.breakout_at
        self.mode: Mode = "routine"

    def sense(self, observation: Observation) -> Situation:
        """Return what there is to be weighed: the first half."""
        return self._routine.sense(observation)

    def act(
        self,
        observation: Observation,
        situation: Situation,
        weights: tuple[float, float],
        breakout_at: float | None = None,
    ) -> Decision:
        """Return the decision with these weights, capped by the guard: the second half.

        Args:
            observation: What was sensed.
            situation: What ``sense`` made of it.
            weights: (ω1, ω2) of Eq. 17.
            breakout_at: c_f in units of S_p, if another than that of the settings.
        """
        if self._escape is None:
            decision = self._routine.step(situation, weights)
        else:
            c_f = self._breakout_at if breakout_at is None else breakout_at
            decision = self._routine.step(situation, weights, c_f)
            decision = self._escape.decide(decision, observation)
        self.mode = decision.mode
        return guarded(decision, observation) if self._guard else decision


class ImprovedFuzzyPlanner(Weighed):
    """The improved planner with weights that stay as they are."""

    def __init__(self, settings: ImprovedFuzzySettings) -> None:
        super().__init__(settings)
        self._weights = settings.weights

    def decide(self, observation: Observation, /) -> Decision:
        """Return the next step with the weights of the settings."""
        return self.act(observation, self.sense(observation), self._weights)
