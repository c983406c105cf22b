"""Going on: if braking leads into a contact, and driving on leads clear of it, the robot drives on.

A robot that stands is passively safe, but it may be run into.
"""

from __future__ import annotations

import math

import numpy as np

from fuzzyq_bullet.planning.base import LONGEST_STRIDE, Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.traffic.candidates import DT, STOP_SHORT, Candidates, predict
from fuzzyq_bullet.planning.traffic.passive_safety import RESERVE, STANDSTILL, Way, along
from fuzzyq_bullet.planning.traffic.tracker import Traffic


class GoingOn:
    """Decides during one episode when the robot goes on, and keeps to it as long as that helps.

    A robot that first goes on and then brakes is hit while it moves. So it begins only if it leaves
    ``RESERVE``, and then keeps its way even if it would choose another now.
    """

    def __init__(self) -> None:
        self._way: Way | None = None

    def kept(
        self, decision: Decision, observation: Observation, traffic: Traffic
    ) -> Decision | None:
        """Return the decision to go on as before; None if that is not called for any more.

        Args:
            decision: What the robot would do otherwise.
            observation: What was observed.
            traffic: What moves.
        """
        if self._way is None:
            return None
        kept = along(self._way, decision, observation)
        if _must_go_on(kept, observation, traffic, reserve=0.0):
            return kept
        self._way = None
        return None

    def begins(self, decision: Decision, observation: Observation, traffic: Traffic) -> bool:
        """Return whether the robot goes on with a decision that is not passively safe.

        Args:
            decision: A decision that the safety filter has passed.
            observation: What was observed.
            traffic: What moves.
        """
        if not _must_go_on(decision, observation, traffic, reserve=RESERVE):
            return False
        self._way = Way(decision.heading, decision.backward)
        return True


def _must_go_on(
    decision: Decision, observation: Observation, traffic: Traffic, *, reserve: float
) -> bool:
    """Return whether braking leads into a contact, and a decision to none, or to one much later.

    Later is late enough if the robot could still stop and stand before it.

    Args:
        decision: The decision.
        observation: What was observed.
        traffic: What moves.
        reserve: A narrower gap (m) than this counts as a contact of the decision.
    """
    motion = observation.motion
    if motion is None or not traffic.tracks:
        return False
    # Not its reach: the robot decides again before it has driven so far.
    free = max(decision.guard - STOP_SHORT, 0.0) if decision.reach else 0.0
    # The longest step is driven at full speed.
    share = min(decision.step / (LONGEST_STRIDE * observation.unit), 1.0)
    pair = Candidates(
        headings=np.array([decision.heading, observation.heading]),
        speeds=np.array([share * motion.max_speed, 0.0]),
        lengths=np.array([free, 0.0]),
        backward=np.array([decision.backward, False]),
    )
    gaps, _ = predict(observation, motion, pair, traffic, margins=False)
    # What is too near already and comes no nearer is no contact: its circle may be too wide.
    meets = (gaps <= [reserve, 0.0]) & (gaps < gaps[0])
    times = np.where(meets.any(axis=0), meets.argmax(axis=0) * DT, math.inf)
    after_going_on, after_braking = times.tolist()
    if after_braking == math.inf:
        return False
    return bool(
        after_going_on - after_braking >= motion.max_speed / motion.acceleration + STANDSTILL
    )
