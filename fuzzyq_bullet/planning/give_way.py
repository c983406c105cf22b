"""Giving way: where to go when what moves would hit the robot on its way, or where it stands.

What moves is expected to go on as it does. The robot's own turning and acceleration are simulated
along its way; if that meets something, other headings, a lower speed and standing still are tried,
and the one that brings it nearest to its aim becomes a temporary goal. Where everything meets
something, it is the one that does so last.
"""

from __future__ import annotations

import math

import numpy as np

from fuzzyq_bullet.planning.aim import Aim, along_heading
from fuzzyq_bullet.planning.base import Floats, Motion, Observation
from fuzzyq_bullet.planning.closing import safe_speed
from fuzzyq_bullet.planning.rollout import rollout
from fuzzyq_bullet.planning.tracking import Traffic

HORIZON = 2.5
"""How far ahead it looks (s)."""
DT = 0.1
"""Time between two places that are looked at (s)."""
MARGIN = 0.05
"""Gap (m) that it keeps to what moves now ..."""
GROWS = 0.05
"""... and how much more with every second ahead (m/s): the velocity is not known exactly."""
HEADINGS = 24
"""Headings that are tried, all around."""
SLOW = 0.5
"""The lower speed that is tried, as a part of the greatest."""
KEPT = 0.3
"""Another way than that of the last decision must be worth so much more (m)."""
ROOMY = 4.0
"""What a metre of gap is worth, in metres nearer to the aim ..."""
ENOUGH = 0.3
"""... up to so much gap (m)."""
TURNING = 0.15
"""What a turn of 1 rad costs (m)."""
AFTER = 0.5
"""What has met something that stands is expected within this part of its speed times the time."""
LEAST = 0.1
"""A way that is not safe at this speed (m/s), or at that which the robot has, is none."""
SHORT = 0.05
"""How much of what is free is not used (m)."""


class GiveWay:
    """Looks ahead and chooses where to go, for one episode.

    Attributes:
        gives_way: Whether the latest aim is a temporary goal of its own.
    """

    def __init__(self) -> None:
        self.gives_way = False
        self._last: tuple[float, float] | None = None

    def aim(self, observation: Observation, aim: Aim, traffic: Traffic) -> Aim:
        """Return the aim, or a temporary goal where something would hit the robot on its way.

        Args:
            observation: What is observed.
            aim: Where the robot wants to go.
            traffic: What moves.
        """
        motion = observation.motion
        if motion is None or not traffic.tracks:
            return self._go_on(aim)
        around = np.float64(aim.bearing) + np.arange(HEADINGS) * (math.tau / HEADINGS)
        free: Floats = np.maximum(_free(observation, traffic.standing, around) - SHORT, 0.0)
        wanted = min(aim.reach, max(free[0], 0.0))
        headings = np.concatenate([[aim.bearing, observation.heading], around, around])
        fast = motion.max_speed
        speeds = np.concatenate(
            [[fast, 0.0], np.full(HEADINGS, fast), np.full(HEADINGS, SLOW * fast)]
        )
        lengths = np.concatenate([[wanted, 0.0], free, free])
        ahead = headings[:1], speeds[:1], lengths[:1]
        gaps, places = self._looked_ahead(observation, motion, *ahead, traffic)
        if (gaps > 0.0).all():
            return self._go_on(aim)
        gaps, places = self._looked_ahead(observation, motion, headings, speeds, lengths, traffic)
        clear = gaps > 0.0
        towards = np.array([math.cos(aim.bearing), math.sin(aim.bearing)])
        gain = (places[-1] - places[0]) @ towards
        room, fine = gaps.min(axis=0), clear.all(axis=0)
        turn = np.abs(np.remainder(headings - observation.heading + math.pi, math.tau) - math.pi)
        same = np.zeros(len(headings))
        if self._last is not None:
            off = np.abs(np.remainder(headings - self._last[0] + math.pi, math.tau) - math.pi)
            same = np.where((off < 0.2) & (speeds == self._last[1]), 1.0, 0.0)
        worth = gain + ROOMY * np.minimum(room, ENOUGH) - TURNING * turn + KEPT * same
        for k in np.argsort(-worth, kind="stable").tolist():
            # A way that the robot may not take at this speed is none.
            if fine[k] and (
                speeds[k] == 0.0 or self._may(observation, motion, headings[k], lengths[k], traffic)
            ):
                chosen = int(k)
                break
        else:
            chosen = int((room + 0.05 * worth).argmax())
        return self._go(
            observation, float(headings[chosen]), float(speeds[chosen]), float(lengths[chosen])
        )

    def _may(
        self,
        observation: Observation,
        motion: Motion,
        heading: float,
        length: float,
        traffic: Traffic,
    ) -> bool:
        speed = safe_speed(heading, length, observation, motion, traffic)
        return speed is None or speed > min(observation.speed, LEAST)

    def _go_on(self, aim: Aim) -> Aim:
        self.gives_way, self._last = False, None
        return aim

    def _go(self, observation: Observation, heading: float, speed: float, length: float) -> Aim:
        self.gives_way, self._last = True, (heading, speed)
        distance = max(length, SHORT)
        x, y = observation.position
        point = x + distance * math.cos(heading), y + distance * math.sin(heading)
        aim = along_heading(observation, heading, distance, "routine", point)
        assert observation.motion is not None
        motion = observation.motion
        slow = speed * (motion.period + motion.latency) + motion.way_to_stop(speed)
        return aim._replace(exact=True, reach=min(length, slow) if speed else 0.0)

    def _looked_ahead(
        self,
        observation: Observation,
        motion: Motion,
        headings: Floats,
        speeds: Floats,
        lengths: Floats,
        traffic: Traffic,
    ) -> tuple[Floats, Floats]:
        """Return the least gap beside the margin (m), shape (S, C), and the places (m)."""
        places = rollout(
            observation, motion, headings, (speeds, speeds), lengths, seconds=HORIZON, dt=DT
        )
        places = _stopped(places, traffic.standing, motion.radius)
        times = np.arange(len(places)) * DT
        gaps = np.full(places.shape[:2], np.inf)
        for one in traffic.tracks:
            known = one.velocity is not None
            velocity = np.array(one.velocity if known else (0.0, 0.0))
            speed = float(np.hypot(*velocity)) if known else observation.closing_speed
            straight = np.minimum(times, one.until if known else 0.0)
            there = np.array(one.centre) + straight[:, None] * velocity
            apart = np.linalg.norm(places - there[:, None], axis=2)
            room = one.radius + motion.radius + MARGIN + GROWS * straight
            room = room + AFTER * speed * (times - straight)
            np.minimum(gaps, apart - room[:, None], out=gaps)
        return gaps, places


def _stopped(places: Floats, standing: Floats, radius: float) -> Floats:
    """Return the places (m), shape (S, C, 2), of a robot that stops before it meets what stands."""
    if not len(standing):
        return places
    x, y = places[..., 0, None] - standing[:, 0], places[..., 1, None] - standing[:, 1]
    gap = np.sqrt((x * x + y * y).min(axis=2))
    hit = (gap < radius) & (gap < gap[0])  # what it stands beside already does not hold it
    steps = np.arange(len(places))[:, None]
    last = np.where(hit.any(axis=0), np.maximum(hit.argmax(axis=0) - 1, 0), len(places))
    at = np.minimum(steps, last)
    return np.asarray(np.take_along_axis(places, at[..., None], axis=0))


def _free(observation: Observation, standing: Floats, headings: Floats) -> Floats:
    """Return how far (m) the disc can go along each heading among points that stand."""
    if not len(standing):
        return np.full(len(headings), observation.range)
    local = (standing - observation.position) @ np.array([1.0, 1j])
    seen = local[None] * np.exp(-1j * headings)[:, None]
    wide = min(observation.radius, float(np.abs(local).min()) - 1e-3)
    depth = wide**2 - seen.imag**2
    way = np.where(
        (seen.real > 0.0) & (depth > 0.0), seen.real - np.sqrt(np.maximum(depth, 0.0)), np.inf
    )
    return np.asarray(np.clip(way.min(axis=1), 0.0, observation.range))
