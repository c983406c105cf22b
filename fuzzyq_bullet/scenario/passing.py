"""When via points are passed, by where the robot was: for drives, and for all who read a record."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from fuzzyq_bullet.quantities import Point
from fuzzyq_bullet.scenario.places import Via


class Passing:
    """Counts the via points that a robot has passed, in their order.

    Args:
        via: The via points.
        at: Where the robot is at first (m).

    Attributes:
        passed: How many were passed so far.
    """

    def __init__(self, via: Sequence[Via], at: Point) -> None:
        self._via = via
        self._at = at
        self.passed = 0
        self.move(at)

    def move(self, to: Point) -> None:
        """Follow the robot on a straight line to a point (m)."""
        at = self._at
        while self.passed < len(self._via):
            via = self._via[self.passed]
            entered = _entry(at, to, via.position, via.radius)
            if entered is None:
                break
            at, self.passed = entered, self.passed + 1
        self._at = to


def passed_along(via: Sequence[Via], positions: Iterable[Sequence[float]]) -> list[int]:
    """Return how many via points were passed by each of the positions (m) of a run."""
    track = [(float(x), float(y)) for x, y in positions]
    passing, counts = Passing(via, track[0]), []
    for point in track:
        passing.move(point)
        counts.append(passing.passed)
    return counts


def _entry(start: Point, end: Point, centre: Point, radius: float) -> Point | None:
    """Return the first point (m) of a straight line that lies within a disc; None if none does."""
    ax, ay = start[0] - centre[0], start[1] - centre[1]
    dx, dy = end[0] - start[0], end[1] - start[1]
    outside = ax * ax + ay * ay - radius * radius
    if outside <= 0.0:
        return start
    # |a + t·d|² = radius², the smaller t
    square, half = dx * dx + dy * dy, ax * dx + ay * dy
    under = half * half - square * outside
    if square == 0.0 or under < 0.0:
        return None
    t = (-half - math.sqrt(under)) / square
    return (start[0] + t * dx, start[1] + t * dy) if 0.0 <= t <= 1.0 else None
