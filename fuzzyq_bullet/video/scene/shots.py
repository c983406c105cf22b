"""A long way is filmed in several shots, each from so near that robot and lines are legible.

The map shows the whole way meanwhile. When the robot leaves what one shot shows, the next begins.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fuzzyq_bullet.video.scene.viewpoint import way

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.map.footprints import Floats

WHOLE = 14.0
"""A way that spans no more (m) is filmed in one shot."""
SPAN = 8.0
"""What the robot drives in each of several shots spans so much at most (m)."""
_SHOWN = 3.0
"""The goal is in the picture if the robot comes so near to it (m)."""
_MOST_POINTS = 500


class Shot(NamedTuple):
    """What is filmed from one place.

    Attributes:
        tick: The first tick of it.
        points: What has to be in the picture (m), shape (N, 2).
        whole: Whether this is all of the run.
    """

    tick: int
    points: Floats
    whole: bool


class Shots:
    """The shots of one run, which depend on nothing but its record.

    Args:
        trajectory: The run.
        whole: A way that spans no more (m) is one shot.
        span: What the robot drives in each of several shots spans so much at most (m).
    """

    def __init__(self, trajectory: Trajectory, whole: float = WHOLE, span: float = SPAN) -> None:
        points = way(trajectory)
        if np.ptp(points, axis=0).max() <= whole:
            self._shots = [Shot(0, points, whole=True)]
        else:
            self._shots = _divided(trajectory, span)
        self._ticks = [shot.tick for shot in self._shots]

    def __getitem__(self, number: int) -> Shot:
        return self._shots[number]

    def __len__(self) -> int:
        return len(self._shots)

    def at(self, tick: int) -> int:
        """Return the number of the shot that shows a tick."""
        return bisect_right(self._ticks, tick) - 1


def _divided(trajectory: Trajectory, span: float) -> list[Shot]:
    path, goal = trajectory.ticks.position, trajectory.scenario.goal.position
    firsts = [0]
    low = high = path[0]
    for tick, place in enumerate(path):
        low, high = np.minimum(low, place), np.maximum(high, place)
        if (high - low).max() > span:
            firsts.append(tick)
            low = high = place
    found = []
    for first, end in zip(firsts, [*firsts[1:], len(path)], strict=True):
        points = path[first:end]
        points = np.concatenate([points[:: 1 + len(points) // _MOST_POINTS], points[-1:]])
        if min(math.dist(one, goal) for one in points.tolist()) <= _SHOWN:
            points = np.concatenate([points, [goal]])
        found.append(Shot(first, points, whole=False))
    return found
