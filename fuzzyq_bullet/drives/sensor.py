"""The range sensor of one instant: no line is cast twice."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.physics.sight import Sight

MOST_HEADINGS = 1000
"""Most that may be asked for at once: PyBullet silently drops what is too much for one batch."""


class CastOnce:
    """A range sensor at one place: the parts of a planner ask it in turn, often for the same.

    Args:
        world: What there is to be seen.
        origin: Centre of the robot (m).
    """

    def __init__(self, world: Sight, origin: tuple[float, float]) -> None:
        self._world = world
        self._origin = origin
        self._known: dict[float, float] = {}

    def __call__(self, headings: Sequence[float]) -> list[float]:
        """Return the free distance (m) along each of the world headings (rad).

        Raises:
            ValueError: If one is no finite number, or there are too many.
        """
        _check(headings)
        known = self._known
        missing = [heading for heading in dict.fromkeys(headings) if heading not in known]
        if missing:
            told = self._world.sense(self._origin, missing)
            known.update(zip(missing, told, strict=True))
        return [known[heading] for heading in headings]

    def look(self, headings: Sequence[float]) -> NDArray[np.float64]:
        """Return the distance (m) to what stands there along each of the world headings (rad).

        Raises:
            ValueError: If one is no finite number, or there are too many.
        """
        _check(headings)
        return self._world.look(self._origin, headings) if len(headings) else np.empty(0)


def _check(headings: Sequence[float]) -> None:
    """Let nothing through that PyBullet would answer with nonsense.

    Raises:
        ValueError: If a heading is no finite number, or there are too many.
    """
    if len(headings) > MOST_HEADINGS:
        raise ValueError(f"{len(headings)} headings at once; at most {MOST_HEADINGS} are allowed")
    for heading in headings:
        if not isinstance(heading, Real) or not math.isfinite(heading):
            raise ValueError(f"a heading must be a finite number, got {heading!r:.60}")
