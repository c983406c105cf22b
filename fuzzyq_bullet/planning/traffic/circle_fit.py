"""The circle through what a scan sees of a moving obstacle."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.planning.base import Floats

LARGEST_RADIUS = 0.8
"""A larger circle (m) does not describe a moving obstacle."""
FEWEST_POINTS = 4
"""With fewer points no circle is fitted."""


class Circle(NamedTuple):
    """A circle in place of a moving obstacle.

    Attributes:
        centre: Its centre (m).
        radius: Its radius (m).
        fits: Whether the points lie on it. If not, it is one around them.
        back: How much farther from the robot it must be (m), in x and y, to reach no nearer than
            anything that is seen; 0 if it fits.
    """

    centre: tuple[float, float]
    radius: float
    fits: bool
    back: tuple[float, float] = (0.0, 0.0)


def fit_circle(points: Floats, origin: Floats, tolerance: float) -> Circle:
    """Return the circle that fits points best, or if none fits, one around them.

    This is the algebraic least-squares fit (Kåsa 1976), which needs no first guess and is exact
    for points without noise.

    Args:
        points: What is seen of the obstacle (m), shape (K, 2).
        origin: From where it is seen (m): the centre lies behind the points.
        tolerance: How far off the circle the points may be (m).
    """
    distances = np.linalg.norm(points - origin, axis=1)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2.0
    if len(points) >= FEWEST_POINTS:
        local = points - middle
        # x² + y² = 2ax + 2by + c, with r² = c + a² + b².
        table = np.column_stack([2.0 * local, np.ones(len(local))])
        (a, b, c), *_ = np.linalg.lstsq(table, (local**2).sum(axis=1), rcond=None)
        radius = math.sqrt(max(0.0, c + a * a + b * b))
        centre = middle + np.array([a, b])
        off = np.abs(np.linalg.norm(points - centre, axis=1) - radius).max()
        behind = np.linalg.norm(centre - origin) > distances.min()
        if off <= tolerance and radius <= LARGEST_RADIUS and behind:
            return Circle((float(centre[0]), float(centre[1])), radius, fits=True)
    radius = float(np.linalg.norm(points - middle, axis=1).max())
    apart = max(float(np.linalg.norm(middle - origin)), 1e-6)
    nearer = float(distances.min()) + radius - apart
    back = (middle - origin) * (nearer / apart)
    return Circle(
        (float(middle[0]), float(middle[1])), radius, False, (float(back[0]), float(back[1]))
    )
