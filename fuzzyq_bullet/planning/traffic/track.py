"""A track: a moving obstacle as a circle, whose velocity is fitted to its latest positions."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.planning.base import Floats
from fuzzyq_bullet.planning.traffic.circle_fit import Circle

WINDOW = 0.5
"""The velocity is fitted to the positions of the latest so many seconds."""
FEWEST_POSITIONS = 3
"""The velocity is fitted to so many positions at least."""
LINE_TOLERANCE = 0.015
"""If a position is farther than this (m) off the fitted straight line, apart from sensor noise, the
obstacle has changed its direction."""
SPEED_TOLERANCE = 0.05
"""By how much a velocity may be wrong (m/s)."""
RADIUS_CHANGE = 0.04
"""If the fitted radius changes by more than this (m), the earlier centres were wrong."""
UNEXPLAINED = 0.15
"""When tracks pass each other, this share of the points may lie on no track's circle."""
FEWEST_ON_CIRCLE = 2
"""So many points at least lie on the circle of each of these tracks."""


class Track(NamedTuple):
    """The state of a moving obstacle at one time.

    Attributes:
        centre: Centre of its circle (m).
        radius: Radius of its circle (m).
        velocity: Its velocity (m/s); None while it is not known yet.
        straight_for: Time until it meets a standing obstacle, and turns (s); infinite if it meets
            none.
    """

    centre: tuple[float, float]
    radius: float
    velocity: tuple[float, float] | None
    straight_for: float = math.inf


@dataclass(slots=True)
class TrackHistory:
    """What is known of a moving obstacle: its latest positions, and the velocity fitted to them.

    Attributes:
        radius: Radius of its circle (m).
        positions: Its latest positions: time (s), x and y of the centre (m).
        velocity: Its velocity (m/s); None while it is not known.
        back: How much farther back its circle is taken to be (m), in x and y; see ``Circle``. It
            changes with the robot's place, so it is no part of the positions.
    """

    radius: float
    positions: deque[tuple[float, float, float]] = field(default_factory=deque)
    velocity: tuple[float, float] | None = None
    back: tuple[float, float] = (0.0, 0.0)

    @property
    def last_seen(self) -> float:
        """Time of its latest position (s)."""
        return self.positions[-1][0]

    def predict(self, time: float) -> tuple[float, float]:
        """Return its centre (m) at a time (s), at constant velocity."""
        then, x, y = self.positions[-1]
        vx, vy = self.velocity or (0.0, 0.0)
        return x + vx * (time - then), y + vy * (time - then)

    def state(self, standing: Floats, time: float) -> Track:
        """Return its state at a time (s), among standing points (m) of shape (H, 2)."""
        straight_for = self.straight_for(standing, time)
        x, y = self.predict(time)
        centre = x + self.back[0], y + self.back[1]
        return Track(centre, self.radius, self.velocity, straight_for)

    def max_speed(self, limit: float) -> float:
        """Return how fast (m/s) it may be at most: a limit if its velocity is not known."""
        if self.velocity is None:
            return limit
        return min(limit, math.hypot(*self.velocity) + SPEED_TOLERANCE)

    def straight_for(self, standing: Floats, time: float) -> float:
        """Return the time (s) until its circle meets one of the standing points (m), (H, 2)."""
        if self.velocity is None or not len(standing):
            return math.inf
        speed = max(math.hypot(*self.velocity), 1e-6)
        ahead = np.array(self.velocity) / speed
        relative = standing - self.predict(time)
        along, across = relative @ ahead, relative @ np.array([-ahead[1], ahead[0]])
        in_the_way = (np.abs(across) < self.radius) & (along > 0.0)
        free = along[in_the_way] - np.sqrt(self.radius**2 - across[in_the_way] ** 2)
        return max(0.0, float(free.min(initial=math.inf))) / speed

    def coast(self, time: float) -> None:
        """Take the predicted position at a time (s) for the seen one: it is partly hidden."""
        self.positions.append((time, *self.predict(time)))

    def add(self, time: float, circle: Circle, tolerance: float, limit: float) -> None:
        """Add a position, and fit the velocity again.

        Args:
            time: When it was seen (s).
            circle: Its circle.
            tolerance: How far off a straight line its positions may be (m).
            limit: A greater speed (m/s) is a mistake of the fit.
        """
        turned = self.velocity and math.dist(self.predict(time), circle.centre) > tolerance
        if turned or abs(circle.radius - self.radius) > RADIUS_CHANGE:
            self.positions.clear()  # the velocity is fitted anew
        self.radius, self.back = circle.radius, circle.back
        self.positions.append((time, *circle.centre))
        while time - self.positions[0][0] > WINDOW:
            self.positions.popleft()
        self.velocity = self._fit_velocity(tolerance, limit)

    def _fit_velocity(self, tolerance: float, limit: float) -> tuple[float, float] | None:
        """Fit a constant velocity by least squares; drop positions from before a change of it."""
        while len(self.positions) >= FEWEST_POSITIONS:
            t, x, y = np.array(self.positions).T
            t = t - t.mean()
            spread = float(t @ t)
            vx, vy = float(t @ x) / spread, float(t @ y) / spread
            off = np.hypot(x - x.mean() - vx * t, y - y.mean() - vy * t).max()
            if off <= tolerance or len(self.positions) == FEWEST_POSITIONS:
                return (vx, vy) if math.hypot(vx, vy) <= limit else None
            self.positions.popleft()
        return None


def tracks_that_explain(
    points: Floats, tracks: Sequence[TrackHistory], time: float, tolerance: float
) -> list[TrackHistory]:
    """Return the tracks on whose predicted circles the points lie, if they explain all points.

    Two obstacles that pass each other are seen as one: its points lie on two circles.

    Args:
        points: What is seen (m), shape (K, 2).
        tracks: The tracks in question.
        time: The present time (s).
        tolerance: How far off a circle a point may be (m), besides ``LINE_TOLERANCE``.

    Returns:
        No tracks if too many points are left over.
    """
    found, left = [], np.ones(len(points), dtype=bool)
    for track in tracks:
        if track.velocity is None:
            continue
        off = np.abs(np.hypot(*(points - track.predict(time)).T) - track.radius)
        on_circle = off <= tolerance + LINE_TOLERANCE
        if on_circle.sum() >= FEWEST_ON_CIRCLE:
            found.append(track)
            left &= ~on_circle
    return found if left.mean() <= UNEXPLAINED else []
