"""Detection lines: corridors a little wider than the robot, each sensed by a bundle of rays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]

SPREAD = np.array([0.11, 0.33, 0.55, 0.75, 0.91, 1.0])
"""Offsets of the rays on either side, as parts of the corridor's half width.

Neighbours are at most 0.0484 m apart, less than the least width of an obstacle, and denser towards
the rim, where the front of the disc falls back ever faster. The last but one runs just outside the
robot's own side, so that not even the flattest graze along a wall gets past it.
"""


class LineBundle:
    """Turns headings into rays and ray hits into the free travel of a disc.

    The rays of one line run parallel. They start on the disc's diameter and the travel is counted
    from its front rim. The two outermost rays start outside the robot, within the margin, where
    there may be an obstacle already; a probe from the robot's side to each of these two starts
    tells, and such a ray is left out: what stands beside the robot does not stop it.

    Args:
        radius: Radius of the robot (m).
        margin: How much wider than the robot the corridor is, on either side (m).
        reach: Longest travel told (m).
        height: Height of the rays above the ground (m).
    """

    def __init__(self, radius: float, margin: float, reach: float, height: float) -> None:
        wide = radius + margin
        offset = wide * np.concatenate([-SPREAD[::-1], SPREAD])
        rim = np.sqrt(wide**2 - offset**2)
        self.reach = reach
        self._height = height
        self._rims: list[float] = rim.tolist()
        self._lengths: list[float] = (rim + reach).tolist()
        # Points of the plane as complex numbers, so that a turn is one product: the starts of all
        # rays and of the right and left probe, then their ends, for a robot that faces along x.
        starts = np.concatenate([1j * offset, [-1j * radius, 1j * radius]])
        ends = np.concatenate([rim + reach + 1j * offset, [-1j * wide, 1j * wide]])
        self._local = np.array([starts, ends])[:, None, :]

    def rays(self, origin: tuple[float, float], headings: Sequence[float]) -> tuple[Floats, Floats]:
        """Return the start and end points of all rays and probes, each of shape (K·14, 3)."""
        turns = [[complex(math.cos(one), math.sin(one))] for one in headings]
        turned = self._local * np.array(turns)
        turned += complex(*origin)
        count = turned.size // 2
        points = np.empty((2, count, 3))
        points[:, :, :2] = turned.view(np.float64).reshape(2, count, 2)
        points[:, :, 2] = self._height
        return points[0], points[1]

    def travel(self, fractions: Sequence[float]) -> Floats:
        """Return the free travel (m) along each heading, shape (K,), in [0, reach].

        Args:
            fractions: Where each ray ended as a part of its length (1: no hit), K·14 of them.
        """
        # Plain numbers: for so few of them an array costs more than it saves.
        rays = len(self._rims)
        travels = []
        for first in range(0, len(fractions), rays + 2):
            right, left = fractions[first + rays : first + rays + 2]
            inner = slice(right < 1.0, rays - (left < 1.0))
            ended = fractions[first : first + rays][inner]
            least = self.reach
            for fraction, length, rim in zip(
                ended, self._lengths[inner], self._rims[inner], strict=True
            ):
                # A free line is exactly as long as the range, not rounded.
                if fraction < 1.0 and fraction * length - rim < least:
                    least = fraction * length - rim
            travels.append(least if least > 0.0 else 0.0)
        return np.array(travels)
