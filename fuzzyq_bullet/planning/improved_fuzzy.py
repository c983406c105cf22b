"""The planner ``improved-fuzzy``: the routine part, the escape, and the safety filter."""

from __future__ import annotations

import math

from fuzzyq_bullet.planning.aim import towards_goal
from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.decision import Decision, Mode
from fuzzyq_bullet.planning.escape.escape import Escape
from fuzzyq_bullet.planning.escape.exploration import ExplorationGraph, Judge, ToGo, knowing
from fuzzyq_bullet.planning.fuzzy import Routine, Situation
from fuzzyq_bullet.planning.safety_filter import safety_filter
from fuzzyq_bullet.planning.settings import ImprovedFuzzySettings, RecoverySettings
from fuzzyq_bullet.planning.traffic.avoidance import TrafficAvoidance


class ImprovedFuzzyBase:
    """What the improved planners share: they differ only in where the weights come from.

    A decision is made in two halves, and the weights are chosen between them: ``sense`` (Steps 4 to
    9), then ``act`` (Steps 7, 8 and 11), which breaks out where the routine part fails and limits
    the step to what is free.

    Attributes:
        mode: The mode of the latest decision.
    """

    def __init__(self, settings: RecoverySettings) -> None:
        self._routine = Routine(settings)
        self._escape = Escape(following=settings.following) if settings.breakout else None
        self._guard = settings.guard
        self._breakout_at = settings.breakout_at
        self._traffic = TrafficAvoidance()
        self.mode: Mode = "routine"

    def know(self, to_go: ToGo) -> None:
        """Choose ways out by the true way on, which no robot knows: for bounds and training."""
        self.choose_exits_by(knowing(to_go))

    def keep_map(self, graph: ExplorationGraph) -> None:
        """Begin with what was explored in episodes before, and add to it."""
        if self._escape is not None:
            self._escape = Escape(graph=graph)

    def choose_exits_by(self, judge: Judge) -> None:
        """Let somebody else judge ways out from now on."""
        if self._escape is not None:
            self._escape.choose_by(judge)

    def sense(self, observation: Observation) -> Situation:
        """Choose the aim, and return what is seen towards it: the first half (Steps 4 to 9)."""
        aim, among_movers = None, observation.closing_speed > 0.0
        if among_movers:
            self._traffic.update(observation)
        if self._escape is not None:
            self._escape.moving = self._traffic.moving
            aim = self._escape.aim(self._traffic.without_waiting(observation), self._breakout_at)
        if among_movers:
            aim = self._traffic.aim(observation, aim or towards_goal(observation))
        if aim is not None:
            self.mode = aim.mode
        return self._routine.sense(observation, aim)

    def act(
        self,
        observation: Observation,
        situation: Situation,
        weights: tuple[float, float],
    ) -> Decision:
        """Return the decision with these weights: the second half (Steps 10 and 11).

        Args:
            observation: What was observed.
            situation: What ``sense`` returned for it.
            weights: (ω1, ω2) of Eq. 17.
        """
        c_f = math.nan if self._escape is None else self._breakout_at
        decision = self._routine.step(situation, weights, c_f)
        if not self._guard:
            return decision
        decision = safety_filter(decision, observation)
        return self._traffic.limit(decision, observation)


class ImprovedFuzzyPlanner(ImprovedFuzzyBase):
    """The improved planner with constant weights."""

    def __init__(self, settings: ImprovedFuzzySettings) -> None:
        super().__init__(settings)
        self._weights = settings.weights

    def decide(self, observation: Observation, /) -> Decision:
        """Return the decision with the weights of the settings."""
        return self.act(observation, self.sense(observation), self._weights)
