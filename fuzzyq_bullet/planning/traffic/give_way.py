"""Giving way: a temporary goal, if a moving obstacle would hit the robot on its way to its aim.

If the way to the aim comes too near to an obstacle, the best of the other candidates becomes a
temporary goal. If every candidate comes too near, it is the one with the widest gap.
"""

from __future__ import annotations

import math

import numpy as np

from fuzzyq_bullet.planning.aim import Aim, along_heading
from fuzzyq_bullet.planning.base import Floats, Motion, Observation
from fuzzyq_bullet.planning.rollout import angle_between
from fuzzyq_bullet.planning.traffic.candidates import (
    STOP_SHORT,
    Candidates,
    candidates_towards,
    predict,
)
from fuzzyq_bullet.planning.traffic.passive_safety import safe_speed
from fuzzyq_bullet.planning.traffic.tracker import Traffic

CREEP_SPEED = 0.1
"""A candidate is rejected if it is not passively safe above this speed (m/s), or above the present
one if that is less."""
GAP_WEIGHT = 4.0
"""What a metre of gap is worth, in metres nearer to the aim ..."""
WIDEST_GAP = 0.3
"""... up to this gap (m)."""
TURN_COST = 0.15
"""What a turn of 1 rad costs (m)."""
HYSTERESIS = 0.3
"""Another candidate than that of the last decision must be worth so much more (m)."""
SAME_HEADING = 0.2
"""Headings no farther apart than this (rad) are those of the same candidate."""
TIE_BREAK = 0.05
"""Weight of a candidate's value if all come too near, when the gap counts first."""


class GiveWay:
    """Gives way during one episode.

    Attributes:
        gives_way: Whether the latest aim is a temporary goal.
    """

    def __init__(self) -> None:
        self.gives_way = False
        # Heading, speed and whether it backs up: the last candidate.
        self._last: tuple[float, float, bool] | None = None

    def aim(self, observation: Observation, aim: Aim, traffic: Traffic) -> Aim:
        """Return the aim, or a temporary goal if an obstacle would hit the robot on its way.

        Args:
            observation: What is observed.
            aim: Where the robot wants to go.
            traffic: What moves.
        """
        motion = observation.motion
        if motion is None or not traffic.tracks:
            return self._keep(aim)
        candidates = candidates_towards(observation, motion, aim, traffic)
        gaps, _ = predict(observation, motion, candidates.first(), traffic)
        if (gaps > 0.0).all():
            return self._keep(aim)
        gaps, positions = predict(observation, motion, candidates, traffic)
        values = self._values(observation, aim, candidates, gaps, positions)
        chosen = _choose(observation, motion, candidates, gaps, values, traffic)
        heading, speed, length, backward = (column[chosen].item() for column in candidates)
        self.gives_way, self._last = True, (heading, speed, backward)
        given = _temporary_goal(observation, motion, heading, speed, length)
        return given._replace(backward=backward)

    def _keep(self, aim: Aim) -> Aim:
        self.gives_way, self._last = False, None
        return aim

    def _values(
        self,
        observation: Observation,
        aim: Aim,
        candidates: Candidates,
        gaps: Floats,
        positions: Floats,
    ) -> Floats:
        """Return the value of each candidate (m): progress, a wide gap, little to turn, no change.

        Value = progress + 4·min(gap, 0.3 m) − 0.15 m/rad·|turn| + 0.3 m for the last one again.
        """
        towards = np.array([math.cos(aim.bearing), math.sin(aim.bearing)])
        progress = (positions[-1] - positions[0]) @ towards
        front = observation.heading + np.where(candidates.backward, math.pi, 0.0)
        turn = np.abs(angle_between(candidates.headings, front))
        same = np.zeros(len(candidates.headings))
        if self._last is not None:
            heading, speed, backward = self._last
            off = np.abs(angle_between(candidates.headings, heading))
            again = (candidates.speeds == speed) & (candidates.backward == backward)
            same = np.where((off < SAME_HEADING) & again, 1.0, 0.0)
        gap = np.minimum(gaps.min(axis=0), WIDEST_GAP)
        return np.asarray(progress + GAP_WEIGHT * gap - TURN_COST * turn + HYSTERESIS * same)


def _choose(
    observation: Observation,
    motion: Motion,
    candidates: Candidates,
    gaps: Floats,
    values: Floats,
    traffic: Traffic,
) -> int:
    """Return the best candidate that keeps clear and is passively safe, or the widest gap."""
    clear = (gaps > 0.0).all(axis=0)
    for k in np.argsort(-values, kind="stable").tolist():
        if not clear[k]:
            continue
        if candidates.speeds[k] == 0.0:
            return int(k)
        heading, length = candidates.headings[k], candidates.lengths[k]
        driven = observation.backwards() if candidates.backward[k] else observation
        speed = safe_speed(heading, length, driven, motion, traffic)
        if speed is not None and speed > min(max(driven.speed, 0.0), CREEP_SPEED):
            return int(k)
    return int((gaps.min(axis=0) + TIE_BREAK * values).argmax())


def _temporary_goal(
    observation: Observation, motion: Motion, heading: float, speed: float, length: float
) -> Aim:
    """Return the aim of a candidate, no farther than the robot may go at its speed (m/s)."""
    distance = max(length, STOP_SHORT)
    x, y = observation.position
    point = x + distance * math.cos(heading), y + distance * math.sin(heading)
    aim = along_heading(observation, heading, distance, "routine", point)
    reach = speed * (motion.period + motion.latency) + motion.way_to_stop(speed)
    return aim._replace(exact=True, reach=min(length, reach) if speed else 0.0)
