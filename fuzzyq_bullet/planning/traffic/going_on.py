"""Going on: if braking leads into a contact, and driving on leads clear of it, the robot drives on.

A robot that stands is passively safe, but it may be run into.
"""

from __future__ import annotations

import math

import numpy as np

from fuzzyq_bullet.planning.base import LONGEST_STRIDE, Floats, Motion, Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.rollout import stoppable
from fuzzyq_bullet.planning.traffic.candidates import DT, STOP_SHORT, Candidates, predict
from fuzzyq_bullet.planning.traffic.passive_safety import (
    RESERVE,
    STANDSTILL,
    Course,
    keeping,
    safe_speed_of,
)
from fuzzyq_bullet.planning.traffic.tracker import Traffic


class GoingOn:
    """Decides during one episode when the robot goes on, and on which course.

    A robot that first goes on and then brakes is hit while it moves. So it begins only if it leaves
    ``RESERVE``. Then it keeps its course, even if it would choose another by now, until it need not
    go on any more.
    """

    def __init__(self) -> None:
        self._course: Course | None = None

    def kept(
        self, decision: Decision, observation: Observation, traffic: Traffic
    ) -> Decision | None:
        """Return the decision to go on as before; None if the robot need not go on.

        Args:
            decision: What the robot would do otherwise.
            observation: What was observed.
            traffic: What moves.
        """
        motion, course = observation.motion, self._course
        if motion is None or course is None:
            return None
        on = keeping(course, decision, observation)
        is_safe = safe_speed_of(on, observation, motion, traffic) == math.inf
        if is_safe or not _must_go_on(on, observation, motion, traffic, reserve=0.0):
            self._course = None
            return None
        # On record it is what it has become: a temporary goal that gives way.
        x, y = observation.position
        point = x + on.guard * math.cos(course.heading), y + on.guard * math.sin(course.heading)
        return on._replace(mode="routine", target=point, aim=point, exact=1.0)

    def begins(self, decision: Decision, observation: Observation, traffic: Traffic) -> bool:
        """Return whether the robot goes on with a decision that is not passively safe.

        Args:
            decision: A decision that the safety filter has passed.
            observation: What was observed.
            traffic: What moves.
        """
        motion = observation.motion
        if motion is None or not _must_go_on(
            decision, observation, motion, traffic, reserve=RESERVE
        ):
            return False
        self._course = Course(decision.heading, decision.backward)
        return True


def _must_go_on(
    decision: Decision,
    observation: Observation,
    motion: Motion,
    traffic: Traffic,
    *,
    reserve: float,
) -> bool:
    """Return whether braking leads into a contact, and a decision to none, or to one much later.

    Later is late enough if the robot could still stop and stand before it. Both are predicted as
    far ahead as ``predict`` looks.

    Args:
        decision: The decision.
        observation: What was observed.
        motion: What the robot's body can do.
        traffic: What moves.
        reserve: A narrower gap (m) than this counts as a contact of the decision.
    """
    if not traffic.tracks:
        return False
    # It may go as far as is free: the robot decides again before it has driven its reach. But its
    # reach limits its speed, and so does its step, of which the longest is driven at full speed.
    free = max(decision.guard - STOP_SHORT, 0.0)
    share = min(decision.step / (LONGEST_STRIDE * observation.unit), 1.0)
    speed = min(share * motion.max_speed, float(stoppable(np.array(decision.reach), motion)))
    pair = Candidates(
        headings=np.array([decision.heading, observation.heading]),
        speeds=np.array([speed, 0.0]),
        lengths=np.array([free, 0.0]),
        backward=np.array([decision.backward, False]),
    )
    gaps, _ = predict(observation, motion, pair, traffic, margins=False)
    after_going_on, after_braking = _first_contacts(gaps, [reserve, 0.0])
    if after_braking == math.inf:
        return False
    to_stop = motion.latency + motion.period + motion.max_speed / motion.acceleration
    return after_going_on - after_braking >= to_stop + STANDSTILL


def _first_contacts(gaps: Floats, least: list[float]) -> list[float]:
    """Return when each of C gaps (m), shape (S, C), first is too narrow (s); infinite if never."""
    narrow = gaps <= least
    times = np.where(narrow.any(axis=0), narrow.argmax(axis=0) * DT, math.inf)
    return [float(time) for time in times]
