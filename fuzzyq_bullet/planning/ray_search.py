"""Ray search: turn a ray until it is free, for the plain breakout (4.2, Fig. 6)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from fuzzyq_bullet.planning.base import Sense

COARSE = math.radians(2.5)
"""Angle between neighbouring rays (rad). The paper's 45° find no path through a dense field."""
FINE = 4
"""The last step is divided into so many parts, so that the robot passes close to the obstacle."""
EASE = tuple(math.radians(degrees) for degrees in (10.0, 5.0, 2.0))
"""Turns further away from the obstacle (rad); the widest that is free is taken. Along its very edge
the slightest error of the heading would leave nothing free."""
AT_ONCE = 16
"""Rays cast in one batch; most searches end within the first."""


class FreeHeading(NamedTuple):
    """The first free heading of a search.

    Attributes:
        heading: World heading (rad).
        free: Free distance along it (m).
        turned: How far the ray turned to find it (rad), at least 0.
        blocked: Heading and free distance of the last ray that was not free, if one was not.
    """

    heading: float
    free: float
    turned: float
    blocked: tuple[float, float] | None


def ray_search(
    sense: Sense, start: float, side: int, enough: float, limit: float = math.tau
) -> FreeHeading | None:
    """Turn from ``start`` to one side until a ray is free.

    Args:
        sense: The range sensor.
        start: World heading to start from (rad).
        side: +1 to the left, −1 to the right.
        enough: What counts as free (m).
        limit: How far to turn (rad).

    Returns:
        The first free heading, or None if there is none within the limit.
    """
    blocked: tuple[float, float] | None = None
    turned_blocked = 0.0
    for turned, free in _rays(sense, start, side, 0.0, COARSE, round(limit / COARSE) + 1):
        if free < enough:
            blocked, turned_blocked = (start + side * turned, free), turned
            continue
        if blocked is None:
            return FreeHeading(start + side * turned, free, turned, None)
        finer = (turned - turned_blocked) / FINE
        for closer, length in _rays(sense, start, side, turned_blocked + finer, finer, FINE - 1):
            if length >= enough:
                return FreeHeading(start + side * closer, length, closer, blocked)
            blocked = (start + side * closer, length)
        return FreeHeading(start + side * turned, free, turned, blocked)
    return None


def eased(sense: Sense, found: FreeHeading, side: int, enough: float) -> FreeHeading:
    """Return a heading found at the edge of an obstacle, turned a little further away from it.

    Args:
        sense: The range sensor.
        found: The first free heading of a search.
        side: The side it turned to: +1 left, −1 right.
        enough: What counts as free (m).
    """
    if found.blocked is None:
        return found
    headings = [found.heading + side * ease for ease in EASE]
    for heading, free in zip(headings, sense(headings), strict=True):
        if free >= min(enough, found.free):
            return found._replace(heading=heading, free=free)
    return found


def _rays(
    sense: Sense, start: float, side: int, first: float, step: float, count: int
) -> Iterator[tuple[float, float]]:
    """Yield how far the ray is turned and its free distance; cast a batch only when asked for."""
    for begin in range(0, count, AT_ONCE):
        turns = [first + k * step for k in range(begin, min(begin + AT_ONCE, count))]
        lengths = sense([start + side * turn for turn in turns])
        yield from zip(turns, lengths, strict=True)
