"""What moves is taken for a circle; where its centre was in the latest readings tells its speed."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.planning.base import Floats

LARGEST = 0.8
"""A circle larger than this (m) does not describe what moves."""
WINDOW = 0.5
"""The velocity is that of the latest so many seconds."""
FASTER = 0.05
"""What moves may become faster than it was seen to be by this (m/s)."""
GROWN = 0.04
"""A circle that has grown or shrunk by more than this (m) since the last reading is another."""
UNEXPLAINED = 0.15
"""Points on the edge of two that pass each other may be off both: no more than this part."""
LEAST = 3
"""Places of its centre that a velocity is told from, at least."""
BEND = 0.015
"""Its centres lie no farther than this (m) off a straight way, beside what the sensor may be wrong
by; else it has changed its direction."""


class Track(NamedTuple):
    """Something that moves.

    Attributes:
        centre: Centre of the circle that it is taken for (m).
        radius: Radius of that circle (m).
        velocity: Its velocity (m/s); None while it cannot be told yet.
        until: When it meets something that stands, and turns (s from now); infinite if not soon.
    """

    centre: tuple[float, float]
    radius: float
    velocity: tuple[float, float] | None
    until: float = math.inf

    @property
    def speed(self) -> float | None:
        """Its speed (m/s); None while it cannot be told yet."""
        return None if self.velocity is None else math.hypot(*self.velocity)


@dataclass(slots=True)
class Followed:
    """Something that moves, as it was seen so far.

    Attributes:
        radius: Of the circle that it is taken for (m).
        seen: When (s) its centre was where (x, y; m), lately.
        velocity: Its velocity (m/s); None while it cannot be told.
    """

    radius: float
    seen: deque[tuple[float, float, float]] = field(default_factory=deque)
    velocity: tuple[float, float] | None = None

    def expected(self, time: float) -> tuple[float, float]:
        """Return where its centre is (m) at a time (s) if it goes on."""
        then, x, y = self.seen[-1]
        vx, vy = self.velocity or (0.0, 0.0)
        return x + vx * (time - then), y + vy * (time - then)

    def track(self, standing: Floats, time: float) -> Track:
        """Return what is told of it at a time (s), among points (m) that stand."""
        return Track(self.expected(time), self.radius, self.velocity, self.until(standing, time))

    def fastest(self, limit: float) -> float:
        """Return how fast (m/s) it may come, whichever way it turns: no faster than the limit."""
        if self.velocity is None:
            return limit
        return min(limit, math.hypot(*self.velocity) + FASTER)

    def until(self, standing: Floats, time: float) -> float:
        """Return when (s from now) it meets something that stands, points (m) of shape (H, 2)."""
        if self.velocity is None or not len(standing):
            return math.inf
        speed = max(math.hypot(*self.velocity), 1e-6)
        ahead = np.array(self.velocity) / speed
        rel = standing - self.expected(time)
        along, across = rel @ ahead, rel @ np.array([-ahead[1], ahead[0]])
        near = (np.abs(across) < self.radius) & (along > 0.0)
        room = along[near] - np.sqrt(self.radius**2 - across[near] ** 2)
        return max(0.0, float(room.min(initial=math.inf))) / speed

    def see(
        self,
        time: float,
        centre: tuple[float, float],
        radius: float,
        bend: float,
        fastest: float,
    ) -> None:
        """Add where its centre (m) is, and tell its velocity from the latest straight piece.

        Args:
            time: When (s).
            centre: Its centre (m).
            radius: Its radius (m).
            bend: How far off a straight way its centres may be (m).
            fastest: How fast it may be (m/s).
        """
        if abs(radius - self.radius) > GROWN:
            self.seen.clear()  # more of it is seen than before: its centre was not known
        self.radius = radius
        self.seen.append((time, *centre))
        while time - self.seen[0][0] > WINDOW:
            self.seen.popleft()
        self.velocity = None
        while len(self.seen) >= LEAST:
            t, x, y = np.array(self.seen).T
            t = t - t.mean()
            spread = float(t @ t)
            vx, vy = float(t @ x) / spread, float(t @ y) / spread
            off = np.hypot(x - x.mean() - vx * t, y - y.mean() - vy * t).max()
            if off <= bend or len(self.seen) == LEAST:
                if math.hypot(vx, vy) <= fastest:
                    self.velocity = vx, vy
                return
            self.seen.popleft()


def explaining(
    points: Floats, known: Sequence[Followed], time: float, tolerance: float
) -> list[Followed]:
    """Return the known ones on whose circles, where they are expected, the points (m) lie.

    None if that leaves points over.
    """
    found, left = [], np.ones(len(points), dtype=bool)
    for one in known:
        if one.velocity is None:
            continue
        off = np.abs(np.hypot(*(points - one.expected(time)).T) - one.radius)
        on = off <= tolerance + BEND
        if on.sum() >= 2:
            found.append(one)
            left &= ~on
    return found if left.mean() <= UNEXPLAINED else []


def circle_of(
    points: Floats, origin: Floats, tolerance: float
) -> tuple[tuple[float, float], float, bool]:
    """Return centre (m) and radius (m) of the circle that fits points, shape (K, 2), best.

    Where none fits, as on something straight, it is the circle around them, and the third is False
    (Kåsa's fit, which needs no first guess, is exact for points without noise).

    Args:
        points: What is seen of something (m).
        origin: From where (m): the centre lies behind the points.
        tolerance: How far the points may be off the circle (m).
    """
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2.0
    around = float(np.linalg.norm(points - middle, axis=1).max())
    if len(points) >= 4:
        local = points - middle
        table = np.column_stack([2.0 * local, np.ones(len(local))])
        (a, b, c), *_ = np.linalg.lstsq(table, (local**2).sum(axis=1), rcond=None)
        radius = math.sqrt(max(0.0, c + a * a + b * b))
        centre = middle + np.array([a, b])
        off = np.abs(np.linalg.norm(points - centre, axis=1) - radius).max()
        behind = np.linalg.norm(centre - origin) > np.linalg.norm(points - origin, axis=1).min()
        if off <= tolerance and radius <= LARGEST and behind:
            return (float(centre[0]), float(centre[1])), radius, True
    return (float(middle[0]), float(middle[1])), around, False
