"""Driving along a way that is remembered: from point to point, with what is free now in mind."""

from __future__ import annotations

import math
from typing import NamedTuple

from fuzzyq_bullet.geometry import wrap_angle
from fuzzyq_bullet.planning.base import STEP_UNIT, Observation
from fuzzyq_bullet.planning.view import Point

AHEAD = 3
"""How many points of the way are tried for a short cut."""
REACHED = 0.03
"""How near to a point of the way the robot has reached it (m)."""
NEARER = 0.05 * STEP_UNIT
"""What counts as having come nearer (m)."""
PATIENCE = 3.0
"""Time without coming nearer to the next point after which the way is given up (s); longer for a
slow robot."""
NARROW = math.radians(4.0)
"""Where the way is not free by so much to either side it is narrow: the robot must face it ..."""
FACING = math.radians(2.0)
"""... as exactly as this before it enters (rad)."""
BESIDE = 0.15
"""A point of the way as near as this (m) ..."""
ASKEW = math.radians(30.0)
"""... and as far off where the robot faces (rad) cannot be met on an arc, only circled."""
ASIDE = tuple(
    math.radians(side * degrees)
    for degrees in (0.7, 1.5, 2.5, 4, 6, 9, 13, 18, 25, 35, 50, 70, 90)
    for side in (1, -1)
)
"""Turns away from the way seen before, where the robot cannot take it quite as it was seen."""
SLIGHT = ASIDE[:2]
"""Those that are tried together with the way itself: half the time one of them is free."""
AT_ONCE = 6
"""How many of the others are tried in one batch of rays."""
LEAST = 0.5 * STEP_UNIT
"""What must be free to go aside (m)."""


class Leg(NamedTuple):
    """The next piece of a way.

    Attributes:
        heading: World heading (rad).
        way: Length (m).
        reach: How far the robot may move before it decides again (m): 0 to turn on the spot first.
    """

    heading: float
    way: float
    reach: float = math.inf


class Course:
    """A way through points.

    Args:
        points: Points to pass (m); from each to the next the way was driven or seen to be free.
    """

    def __init__(self, points: list[Point]) -> None:
        self._points = points
        self._closest = math.inf
        self._since = math.inf

    def next(self, observation: Observation) -> Leg | None:
        """Return the way to the farthest point that can be reached straight on.

        None when the robot does not get on.
        """
        here, points = observation.position, self._points
        while len(points) > 1 and math.dist(here, points[0]) <= REACHED:
            self._drop(1)
        ahead = points[:AHEAD]
        ways = [math.dist(here, point) for point in ahead]
        headings = [math.atan2(y - here[1], x - here[0]) for x, y in ahead]
        # In the same batch what will be asked next: slight turns, and where the body faces.
        soon = [headings[0] + turn for turn in SLIGHT]
        if observation.motion is not None:
            soon.append(observation.heading)
        free = observation.sense([*headings, *soon])[: len(headings)]
        seen = [k for k in range(len(ahead)) if free[k] >= min(ways[k], observation.range)]
        target = seen[-1] if seen else 0
        heading, way = headings[target], ways[target]
        if target:
            self._drop(target)
        if not self._comes_nearer(way, observation):
            return None
        if not seen:
            return _aside(observation, heading, min(way, LEAST))
        # A point that is no end must be reached: what comes after it is not free from here.
        stop = way if len(points) > 1 else math.inf
        return Leg(heading, way, 0.0 if _must_aim(observation, heading, way) else stop)

    def _drop(self, count: int) -> None:
        del self._points[:count]
        self._closest = math.inf

    def _comes_nearer(self, way: float, observation: Observation) -> bool:
        now = observation.time
        if way < self._closest - NEARER:
            self._closest, self._since = way, now
        return now - self._since <= PATIENCE * observation.slowness


def _must_aim(observation: Observation, heading: float, way: float) -> bool:
    """Return whether the robot must turn on the spot before it takes a way.

    So it must where the way is narrow, and where its end lies so far beside that an arc misses it.
    """
    turn = abs(wrap_angle(heading - observation.heading))
    if observation.motion is None or turn <= FACING:
        return False
    if way <= BESIDE and turn > ASKEW:
        return True
    beside = observation.sense([heading - NARROW, heading + NARROW])
    return min(beside) < min(way, 2.0 * LEAST)


def _aside(observation: Observation, heading: float, enough: float) -> Leg | None:
    """Return the least turn from a heading that is free for long enough, if one is."""
    further = range(len(SLIGHT), len(ASIDE), AT_ONCE)
    for turns in (SLIGHT, *(ASIDE[first : first + AT_ONCE] for first in further)):
        headings = [heading + turn for turn in turns]
        for other, length in zip(headings, observation.sense(headings), strict=True):
            if length >= enough:
                return Leg(other, enough)
    return None
