"""Detection lines: corridors a little wider than the robot, each sensed by a bundle of rays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

Point: TypeAlias = tuple[float, float, float]

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
        # All rays, then the right and the left probe, of a robot that faces along x: how far to its
        # left they start, and how far ahead and to its left they end.
        self._starts: list[float] = [*offset.tolist(), -radius, radius]
        self._ends: list[tuple[float, float]] = [
            *zip(self._lengths, offset.tolist(), strict=True),
            (0.0, -wide),
            (0.0, wide),
        ]

    def rays(
        self, origin: tuple[float, float], headings: Sequence[float]
    ) -> tuple[list[Point], list[Point]]:
        """Return the start and end points (m) of all rays and probes, K·14 of each."""
        # Plain numbers, here and below: for so few of them an array costs more than it saves.
        (x, y), z = origin, self._height
        starts: list[Point] = []
        ends: list[Point] = []
        for heading in headings:
            cos, sin = math.cos(heading), math.sin(heading)
            starts += [(x - left * sin, y + left * cos, z) for left in self._starts]
            ends += [
                (x + (ahead * cos - left * sin), y + (ahead * sin + left * cos), z)
                for ahead, left in self._ends
            ]
        return starts, ends

    def travel(self, fractions: Sequence[float]) -> list[float]:
        """Return the free travel (m) along each of the K headings, in [0, reach].

        Args:
            fractions: Where each ray ended as a part of its length (1: no hit), K·14 of them.
        """
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
        return travels
