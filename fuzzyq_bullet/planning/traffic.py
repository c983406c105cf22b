"""A planner among what moves: it tracks, gives way, waits without losing patience, keeps clear."""

from __future__ import annotations

from dataclasses import replace

from fuzzyq_bullet.planning.aim import Aim
from fuzzyq_bullet.planning.base import Floats, Observation
from fuzzyq_bullet.planning.closing import give_room
from fuzzyq_bullet.planning.cost_to_go import NO_HITS
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.give_way import GiveWay
from fuzzyq_bullet.planning.tracking import Tracker, Traffic


class TrafficSense:
    """All that a planner does about what moves, for one episode. Without any it does nothing."""

    def __init__(self) -> None:
        self._tracker = Tracker()
        self._give_way = GiveWay()
        self._traffic: Traffic | None = None
        self._waited, self._before = 0.0, 0.0
        self._held = False

    def update(self, observation: Observation) -> None:
        """Take one more reading."""
        self._traffic = self._tracker.update(observation)
        if self._held:
            self._waited += observation.time - self._before
        self._before = observation.time

    @property
    def moving(self) -> Floats:
        """Points (m) of what moves, shape (M, 2)."""
        return NO_HITS if self._traffic is None else self._traffic.moving

    def patient(self, observation: Observation) -> Observation:
        """Return what is observed by a clock that stands while the robot waits or gives way.

        Waiting is no failure: no path is given up because of it.
        """
        if self._waited == 0.0:
            return observation
        return replace(observation, time=observation.time - self._waited)

    def aim(self, observation: Observation, aim: Aim) -> Aim:
        """Return the aim, or a temporary goal that gives way."""
        if self._traffic is None or aim.hopeless:
            return aim
        given = self._give_way.aim(observation, aim, self._traffic)
        self._held = self._give_way.gives_way
        return given

    def limit(self, decision: Decision, observation: Observation) -> Decision:
        """Return the decision, slow enough for what may come."""
        if self._traffic is None:
            return decision
        limited = give_room(decision, observation, self._traffic)
        self._held = self._held or limited.reach < decision.reach
        return limited
