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
        self._radius = radius
        self._wide = wide = radius + margin
        self._reach = reach
        self._height = height
        aside = wide * SPREAD
        rims = np.sqrt(wide**2 - aside**2)
        # The pairs of rays, one on the right and one on the left, from the inside out: how far
        # aside they run, and how far ahead they end.
        self._pairs: list[tuple[float, float]] = list(
            zip(aside.tolist(), (rims + reach).tolist(), strict=True)
        )
        # For each ray its length, and how far of it the front rim is.
        self._lengths: list[float] = np.repeat(rims + reach, 2).tolist()
        self._rims: list[float] = np.repeat(rims, 2).tolist()

    def rays(
        self, origin: tuple[float, float], headings: Sequence[float]
    ) -> tuple[list[Point], list[Point]]:
        """Return the start and end points (m) of all rays: for each heading 12, and 2 probes."""
        # Plain numbers, here and below: for so few of them an array costs more than it saves.
        (x, y), z = origin, self._height
        starts: list[Point] = []
        ends: list[Point] = []
        for heading in headings:
            cos, sin = math.cos(heading), math.sin(heading)
            for aside, ahead in self._pairs:
                dx = aside * sin
                dy = aside * cos
                far_x = ahead * cos
                far_y = ahead * sin
                starts.append((x + dx, y - dy, z))
                starts.append((x - dx, y + dy, z))
                ends.append((x + (far_x + dx), y + (far_y - dy), z))
                ends.append((x + (far_x - dx), y + (far_y + dy), z))
            for side in (-1, 1):
                for radius, points in ((self._radius, starts), (self._wide, ends)):
                    points.append((x - side * radius * sin, y + side * radius * cos, z))
        return starts, ends

    def travel(self, fractions: list[float]) -> list[float]:
        """Return the free travel (m) along each of the K headings, in [0, reach].

        Args:
            fractions: Where each ray ended as a part of its length (1: no hit), in the order of
                ``rays``.
        """
        count, lengths, rims = len(self._lengths), self._lengths, self._rims
        travels = []
        for first in range(0, len(fractions), count + 2):
            ended = fractions[first : first + count]
            for ray in (-2, -1):  # the outermost; its probe comes as far after the last
                if fractions[first + count + 2 + ray] < 1.0:
                    ended[ray] = 1.0
            least = self._reach
            if min(ended) < 1.0:
                # A free line is exactly as long as the range, not rounded.
                met = [
                    fraction * length - rim
                    for fraction, length, rim in zip(ended, lengths, rims, strict=True)
                    if fraction < 1.0
                ]
                least = max(0.0, min(least, *met))
            travels.append(least)
        return travels
