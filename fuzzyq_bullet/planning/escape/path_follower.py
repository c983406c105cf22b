"""Following a path of the exploration graph from point to point, as far as it is free now."""

from __future__ import annotations

import math
from typing import NamedTuple

from fuzzyq_bullet.geometry import wrap_angle
from fuzzyq_bullet.planning.base import STEP_UNIT, Observation
from fuzzyq_bullet.planning.scan import Point

SHORTCUTS = 3
"""How many points of a path are usually tried for a short cut."""
REACHED = 0.03
"""A point as near as this is reached (m)."""
NEARER = 0.05 * STEP_UNIT
"""How much nearer counts as progress (m), beside what the robot cannot tell for certain."""
PATIENCE = 3.0
"""Time without progress towards the next point after which the path is given up (s); longer for a
slow robot."""
NARROW = math.radians(4.0)
"""Where headings so far to either side (rad) are not free, the path is narrow: the robot must face
along it ..."""
FACING = math.radians(2.0)
"""... as exactly as this before it goes on (rad)."""
BESIDE = 0.15
"""A point as near as this (m) ..."""
ASKEW = math.radians(30.0)
"""... and as far off the robot's heading as this (rad) cannot be reached on an arc."""
ASIDE = tuple(
    math.radians(side * degrees)
    for degrees in (0.7, 1.5, 2.5, 4, 6, 9, 13, 18, 25, 35, 50, 70, 90)
    for side in (1, -1)
)
"""Turns aside (rad) to try where the path is not free exactly as it was seen."""
SLIGHT = ASIDE[:2]
"""Those that are sensed together with the path itself: half the time one of them is free."""
AT_ONCE = 6
"""How many of the others are tried in one batch of rays."""
CREEP = 0.03
"""With no more free than this the robot does not move at all (m)."""
LEAST = 0.5 * STEP_UNIT
"""How much must be free to turn aside (m)."""


class Segment(NamedTuple):
    """The next piece of a path, straight on.

    Attributes:
        heading: World heading (rad).
        length: Length (m).
        reach: How far the robot may move before it decides again (m): 0 to turn on the spot first.
    """

    heading: float
    length: float
    reach: float = math.inf
    exact: bool = False


class PathFollower:
    """Drives the robot along a path. Its lengths are so many times as long for a larger robot.

    Args:
        points: Points to pass (m); each line from one to the next was driven or seen to be free.
        shortcuts: How many of them are tried for a short cut.
    """

    def __init__(self, points: list[Point], shortcuts: int = SHORTCUTS) -> None:
        self._points = points
        self._shortcuts = shortcuts
        self._closest = math.inf
        self._since = math.inf

    def next(self, observation: Observation) -> Segment | None:
        """Return the segment to the farthest point that can be reached straight on.

        None if the robot makes no progress.
        """
        here, points, size = observation.position, self._points, observation.size
        while len(points) > 1 and math.dist(here, points[0]) <= REACHED * size:
            self._drop(1)
        ahead = points[: self._shortcuts]
        lengths = [math.dist(here, point) for point in ahead]
        headings = [math.atan2(y - here[1], x - here[0]) for x, y in ahead]
        # Cast with the same batch what is asked for next: slight turns, and the robot's heading.
        soon = [headings[0] + turn for turn in SLIGHT]
        if observation.motion is not None:
            soon.append(observation.heading)
        free = observation.sense([*headings, *soon])[: len(headings)]
        seen = [k for k in range(len(ahead)) if free[k] >= min(lengths[k], observation.range)]
        target = seen[-1] if seen else 0
        heading, length = headings[target], lengths[target]
        if target:
            self._drop(target)
        if not self._comes_nearer(length, observation):
            return None
        if not seen:
            return _aside(observation, heading, min(length, LEAST * size))
        # Every point but the last must be reached: the next one is not free from here.
        stop = length if len(points) > 1 else math.inf
        narrow = _is_narrow(observation, heading, length)
        must = _must_aim(observation, heading, length, narrow)
        return Segment(heading, length, 0.0 if must else stop, exact=narrow)

    def _drop(self, count: int) -> None:
        del self._points[:count]
        self._closest = math.inf

    def _comes_nearer(self, length: float, observation: Observation) -> bool:
        now = observation.time
        progress = NEARER * observation.size + observation.uncertainty
        if length < self._closest - progress:
            self._closest, self._since = length, now
        return now - self._since <= PATIENCE * observation.slowness


def _is_narrow(observation: Observation, heading: float, length: float) -> bool:
    """Return whether a heading slightly to either side is not free."""
    beside = observation.sense([heading - NARROW, heading + NARROW])
    return min(beside) < min(length, 2.0 * LEAST * observation.size)


def _must_aim(observation: Observation, heading: float, length: float, narrow: bool) -> bool:
    """Return whether the robot must turn on the spot before it drives a segment.

    It must if the segment is narrow, or so short and so far to the side that an arc misses its end.
    """
    turn = abs(wrap_angle(heading - observation.heading))
    if observation.motion is None or turn <= FACING:
        return False
    return narrow or (length <= BESIDE * observation.size and turn > ASKEW)


def _aside(observation: Observation, heading: float, enough: float) -> Segment | None:
    """Return the least turn from a heading that is free for long enough.

    Where none is, the robot stands in a gap that is hardly wider than itself: it leaves by the
    turn that lets it move farthest.
    """
    creep = CREEP * observation.size
    most = creep, heading
    further = range(len(SLIGHT), len(ASIDE), AT_ONCE)
    for turns in (SLIGHT, *(ASIDE[first : first + AT_ONCE] for first in further)):
        headings = [heading + turn for turn in turns]
        for other, free in zip(headings, observation.sense(headings), strict=True):
            if free >= enough:
                return Segment(other, enough)
            most = max(most, (free, other))
    return Segment(most[1], most[0], exact=True) if most[0] > creep else None
