"""What a planner does about moving obstacles: it tracks, gives way, waits, and stays safe."""

from __future__ import annotations

from dataclasses import replace

from fuzzyq_bullet.planning.aim import Aim
from fuzzyq_bullet.planning.base import Floats, Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.escape.cost_to_go import NO_HITS
from fuzzyq_bullet.planning.traffic.give_way import GiveWay
from fuzzyq_bullet.planning.traffic.going_on import GoingOn
from fuzzyq_bullet.planning.traffic.passive_safety import PassiveSafety
from fuzzyq_bullet.planning.traffic.tracker import Tracker, Traffic


class TrafficAvoidance:
    """Avoids moving obstacles during one episode; before the first ``update`` it does nothing.

    A decision calls ``update``, ``aim`` and ``limit`` in this order.
    """

    def __init__(self) -> None:
        self._tracker = Tracker()
        self._give_way = GiveWay()
        self._safety = PassiveSafety()
        self._going_on = GoingOn()
        self._traffic: Traffic | None = None
        self._updated_at = 0.0
        self._waited = 0.0  # seconds during which the robot gave way or was slowed down
        self._waits = False

    def update(self, observation: Observation) -> None:
        """Scan all around, and track what moves."""
        self._traffic = self._tracker.update(observation)
        if self._waits:
            self._waited += observation.time - self._updated_at
        self._updated_at = observation.time

    @property
    def moving(self) -> Floats:
        """Points (m) of what moves, shape (M, 2)."""
        return NO_HITS if self._traffic is None else self._traffic.moving

    def without_waiting(self, observation: Observation) -> Observation:
        """Return the observation with a clock that stands still while the robot waits.

        So the escape gives up no path because the robot waited for an obstacle to pass.
        """
        if self._waited == 0.0:
            return observation
        return replace(observation, time=observation.time - self._waited)

    def aim(self, observation: Observation, aim: Aim) -> Aim:
        """Return the aim, or a temporary goal that gives way."""
        if self._traffic is None or aim.hopeless:
            return aim
        given = self._give_way.aim(observation, aim, self._traffic)
        self._waits = self._give_way.gives_way
        return given

    def limit(self, decision: Decision, observation: Observation) -> Decision:
        """Return the decision, limited so that the robot is passively safe.

        It is not limited if only going on leads clear: a robot that brakes would be run into.
        """
        if self._traffic is None:
            return decision
        kept = self._going_on.kept(decision, observation, self._traffic)
        if kept is not None:
            self._waits = True
            return kept
        limited = self._safety.limit(decision, observation, self._traffic)
        if limited.reach < decision.reach:
            if self._going_on.begins(decision, observation, self._traffic):
                return decision
            self._waits = True
        return limited
