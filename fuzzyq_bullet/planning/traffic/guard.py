"""The key ``guard``: what limits the answers of planners that have no avoidance of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fuzzyq_bullet.planning.base import Motion, Observation
from fuzzyq_bullet.planning.commands import TwistCommand
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.safety_filter import safety_filter
from fuzzyq_bullet.planning.traffic.passive_safety import PassiveSafety
from fuzzyq_bullet.planning.traffic.tracker import Tracker, Traffic
from fuzzyq_bullet.planning.traffic.twist_safety import safe_twists
from fuzzyq_bullet.planning.twist_filter import first_free, slower, twist_filter


class Guard:
    """Limits answers during one episode: to what is free, and among what moves to what is safe.

    Where nothing moves it is the safety filter alone. Elsewhere it tracks what moves and keeps the
    robot passively safe. Each observation is to be told once.
    """

    def __init__(self) -> None:
        self._tracker = Tracker()
        self._safety = PassiveSafety()
        self._way_out: TwistCommand | None = None

    def limit_decision(self, decision: Decision, observation: Observation) -> Decision:
        """Return the decision, limited."""
        decision = safety_filter(decision, observation)
        if observation.closing_speed == 0.0:
            return decision
        return self._safety.limit(decision, observation, self._traffic(observation))

    def limit_twist(
        self, twist: TwistCommand, observation: Observation, motion: Motion
    ) -> tuple[TwistCommand, float]:
        """Return the twist, limited, and the shortest free length (m) towards its arc.

        Its speed is lowered until it is free and passively safe. If it never is, the robot goes on
        with the latest twist that was, if that still is; else it brakes.
        """
        if observation.closing_speed == 0.0:
            return twist_filter(twist, observation, motion)
        traffic, shortest = self._traffic(observation), 0.0
        for wanted in (twist, self._way_out):
            if wanted is None:
                break
            tried = slower(wanted, motion)
            safe = safe_twists(tried, observation, motion, traffic).tolist()
            well = [one for one, is_safe in zip(tried, safe, strict=True) if is_safe]
            self._way_out, shortest = first_free(well, observation, motion)
            if self._way_out is not None:
                return self._way_out._replace(told=twist.told), shortest
        return twist._replace(speed=0.0, turn_rate=0.0), shortest

    def _traffic(self, observation: Observation) -> Traffic:
        """Return what moves, and may turn at any time.

        These planners do not give way, and drive close beside what moves. To trust it to go
        straight on would be too risky.
        """
        traffic = self._tracker.update(observation)
        return replace(traffic, straight_for=np.zeros_like(traffic.straight_for))
