"""Giving way: a temporary goal, if a moving obstacle would hit the robot on its way to its aim.

Obstacles keep their velocity, as for velocity obstacles (Fiorini, Shiller 1998). But each candidate
motion of the robot is simulated with its own turning and acceleration, as for the dynamic window.
If the way to the aim comes too near to an obstacle, the best of the other headings and speeds
becomes a temporary goal. If every candidate comes too near, it is the one with the widest gap.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.planning.aim import Aim, along_heading
from fuzzyq_bullet.planning.base import Floats, Motion, Observation
from fuzzyq_bullet.planning.rollout import angle_between, rollout
from fuzzyq_bullet.planning.traffic.passive_safety import safe_speed
from fuzzyq_bullet.planning.traffic.tracker import Traffic

HORIZON = 2.5
"""How far ahead the motion is predicted (s)."""
DT = 0.1
"""Time step of the prediction (s)."""
MARGIN = 0.05
"""Gap to a moving obstacle now (m) ..."""
MARGIN_GROWTH = 0.05
"""... and what is added for each second ahead (m/s): its velocity is not known exactly."""
AFTER_STRAIGHT = 0.5
"""After it has met a standing one, an obstacle is expected within this part of speed × time."""
HEADINGS = 24
"""Number of headings that are tried, all around."""
SLOW = 0.5
"""The lower speed that is tried, as a part of the greatest."""
STOP_SHORT = 0.05
"""How much of the free distance is not used (m)."""
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


class _Candidates(NamedTuple):
    """C motions of the robot: the way to the aim, standing still, and others.

    Attributes:
        headings: World heading (rad), shape (C,).
        speeds: Speed (m/s), shape (C,).
        lengths: Length (m), shape (C,).
    """

    headings: Floats
    speeds: Floats
    lengths: Floats

    def first(self) -> _Candidates:
        """Return the way to the aim alone."""
        return _Candidates(*(values[:1] for values in self))


class GiveWay:
    """Gives way during one episode.

    Attributes:
        gives_way: Whether the latest aim is a temporary goal.
    """

    def __init__(self) -> None:
        self.gives_way = False
        self._last: tuple[float, float] | None = None  # heading and speed of the last candidate

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
        candidates = _candidates(observation, motion, aim, traffic)
        gaps, _ = _predict(observation, motion, candidates.first(), traffic)
        if (gaps > 0.0).all():
            return self._keep(aim)
        gaps, positions = _predict(observation, motion, candidates, traffic)
        values = self._values(observation, aim, candidates, gaps, positions)
        chosen = _choose(observation, motion, candidates, gaps, values, traffic)
        heading, speed, length = (float(column[chosen]) for column in candidates)
        self.gives_way, self._last = True, (heading, speed)
        return _temporary_goal(observation, motion, heading, speed, length)

    def _keep(self, aim: Aim) -> Aim:
        self.gives_way, self._last = False, None
        return aim

    def _values(
        self,
        observation: Observation,
        aim: Aim,
        candidates: _Candidates,
        gaps: Floats,
        positions: Floats,
    ) -> Floats:
        """Return the value of each candidate (m): progress, a wide gap, little to turn, no change.

        Value = progress + 4·min(gap, 0.3 m) − 0.15 m/rad·|turn| + 0.3 m for the last one again.
        """
        towards = np.array([math.cos(aim.bearing), math.sin(aim.bearing)])
        progress = (positions[-1] - positions[0]) @ towards
        turn = np.abs(angle_between(candidates.headings, observation.heading))
        same = np.zeros(len(candidates.headings))
        if self._last is not None:
            heading, speed = self._last
            off = np.abs(angle_between(candidates.headings, heading))
            same = np.where((off < SAME_HEADING) & (candidates.speeds == speed), 1.0, 0.0)
        gap = np.minimum(gaps.min(axis=0), WIDEST_GAP)
        return np.asarray(progress + GAP_WEIGHT * gap - TURN_COST * turn + HYSTERESIS * same)


def _candidates(
    observation: Observation, motion: Motion, aim: Aim, traffic: Traffic
) -> _Candidates:
    """Return the way to the aim, standing still, and all headings at two speeds."""
    around = np.float64(aim.bearing) + np.arange(HEADINGS) * (math.tau / HEADINGS)
    free = _free_distance(observation, traffic.standing, around)
    free = np.maximum(free - STOP_SHORT, 0.0)
    fast, slow = np.full(HEADINGS, motion.max_speed), np.full(HEADINGS, SLOW * motion.max_speed)
    return _Candidates(
        headings=np.concatenate([[aim.bearing, observation.heading], around, around]),
        speeds=np.concatenate([[motion.max_speed, 0.0], fast, slow]),
        lengths=np.concatenate([[min(aim.reach, free[0]), 0.0], free, free]),
    )


def _predict(
    observation: Observation, motion: Motion, candidates: _Candidates, traffic: Traffic
) -> tuple[Floats, Floats]:
    """Simulate candidates among moving obstacles.

    Returns:
        The least gap to an obstacle, less the margin (m), shape (S, C), and the robot's positions
        (m), shape (S, C, 2).
    """
    headings, speeds, lengths = candidates
    positions = rollout(
        observation, motion, headings, (speeds, speeds), lengths, seconds=HORIZON, dt=DT
    )
    positions = _stop_at_standing(positions, traffic.standing, motion.radius)
    times = np.arange(len(positions)) * DT
    gaps = np.full(positions.shape[:2], np.inf)
    for track in traffic.tracks:
        known = track.velocity is not None
        velocity = np.array(track.velocity if known else (0.0, 0.0))
        speed = float(np.hypot(*velocity)) if known else observation.closing_speed
        straight = np.minimum(times, track.straight_for if known else 0.0)
        centres = np.array(track.centre) + straight[:, None] * velocity
        apart = np.linalg.norm(positions - centres[:, None], axis=2)
        least = track.radius + motion.radius + MARGIN + MARGIN_GROWTH * straight
        least = least + AFTER_STRAIGHT * speed * (times - straight)
        np.minimum(gaps, apart - least[:, None], out=gaps)
    return gaps, positions


def _choose(
    observation: Observation,
    motion: Motion,
    candidates: _Candidates,
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
        speed = safe_speed(heading, length, observation, motion, traffic)
        if speed is not None and speed > min(observation.speed, CREEP_SPEED):
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


def _stop_at_standing(positions: Floats, standing: Floats, radius: float) -> Floats:
    """Return positions (m), shape (S, C, 2), that end before the disc meets a standing point.

    A disc that touches one at the start may still move, as long as it comes no nearer to any.
    """
    if not len(standing):
        return positions
    x = positions[..., 0, None] - standing[:, 0]
    y = positions[..., 1, None] - standing[:, 1]
    gap = np.sqrt((x * x + y * y).min(axis=2))
    hit = (gap < radius) & (gap < gap[0])
    last = np.where(hit.any(axis=0), np.maximum(hit.argmax(axis=0) - 1, 0), len(positions))
    at = np.minimum(np.arange(len(positions))[:, None], last)
    return np.asarray(np.take_along_axis(positions, at[..., None], axis=0))


def _free_distance(observation: Observation, standing: Floats, headings: Floats) -> Floats:
    """Return how far (m) the disc can go along each heading before it meets a standing point."""
    if not len(standing):
        return np.full(len(headings), observation.range)
    local = (standing - observation.position) @ np.array([1.0, 1j])
    seen = local[None] * np.exp(-1j * headings)[:, None]
    wide = min(observation.radius, float(np.abs(local).min()) - 1e-3)
    depth = wide**2 - seen.imag**2
    ahead = (seen.real > 0.0) & (depth > 0.0)
    free = np.where(ahead, seen.real - np.sqrt(np.maximum(depth, 0.0)), np.inf)
    return np.asarray(np.clip(free.min(axis=1), 0.0, observation.range))
