"""Frontiers: where what a scan has shown to be free borders on what it could not see.

The lengths are those for the usual robot: they are so many times as long for a larger one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from fuzzyq_bullet.planning.scan import JUMP, Point, Scan

SHORTEST = 0.1
"""A frontier nearer than this leads nowhere (m)."""
PEEK = 0.3
"""How far the robot goes past the end of what hides something, to look behind it (m)."""
SHY = 0.25
"""How far before the end of its sight the robot stops to scan again (m)."""
BEHIND = 0.02
"""How far beyond the border of what is seen the point lies that must be seen next (m)."""
APART = math.radians(15.0)
"""Where the sight is free, there is one frontier for every so many radians."""
SHALLOW = 0.15
"""A corner no deeper than this is no gap, however narrow (m)."""


class Frontier(NamedTuple):
    """A place to go to, from which more can be seen.

    Attributes:
        node: Index of the node of the exploration graph that it was seen from.
        point: Where it is (m); the straight line from the node to it is free.
        heading: World heading from the node to the point (rad).
        distance: From the node to the point (m).
        beyond: A point that is not seen yet (m). Once it is, the frontier has nothing more to show.
            None for a gap: only from within it can be seen whether it leads on.
        ahead: Whether ``beyond`` lies straight on, where the sight ended and nothing stood.
    """

    node: int
    point: Point
    heading: float
    distance: float
    beyond: Point | None
    ahead: bool = False


def find_frontiers(node: int, here: Point, scan: Scan) -> Iterator[Frontier]:
    """Yield the frontiers of a scan: beside what hides something, in gaps, where the sight ends.

    Args:
        node: Index of the node that the scan was made at.
        here: Its position (m).
        scan: What was seen from there.
    """
    count, last, size = len(scan.lengths), -math.inf, scan.size
    for k, (heading, free) in enumerate(zip(scan.headings, scan.lengths, strict=True)):
        if free < SHORTEST * size:
            continue
        if free >= scan.range and heading - last >= APART:
            last = heading
            distance = free - SHY * size
            beyond = along(here, heading, free + BEHIND * size)
            point = along(here, heading, distance)
            yield Frontier(node, point, heading, distance, beyond, ahead=True)
        for beside, side in ((k - 1, -1), ((k + 1) % count, 1)):
            hidden = scan.lengths[beside]
            if free - hidden > JUMP * size:
                distance = min(hidden + PEEK * size, free)
                point = along(here, heading, distance)
                beyond = along(point, heading + side * math.pi / 2, BEHIND * size)
                yield Frontier(node, point, heading, distance, beyond)
    for k in scan.gaps:
        if SHORTEST * size < scan.lengths[k] < scan.range:
            yield _gap(node, here, scan, k)


def find_concave_corners(node: int, here: Point, scan: Scan) -> Iterator[Frontier]:
    """Yield a frontier in every corner of a scan: seen from within, what seems closed may be a gap.

    The arguments are those of ``find_frontiers``.
    """
    count = len(scan.lengths)
    for k, free in enumerate(scan.lengths):
        if (
            free > SHALLOW * scan.size
            and scan.lengths[k - 1] < free >= scan.lengths[(k + 1) % count]
        ):
            yield _gap(node, here, scan, k)


def along(origin: Point, heading: float, distance: float) -> Point:
    """Return the point at a distance (m) from another along a heading (rad)."""
    return origin[0] + distance * math.cos(heading), origin[1] + distance * math.sin(heading)


def _gap(node: int, here: Point, scan: Scan, k: int) -> Frontier:
    heading, distance = scan.headings[k], scan.lengths[k]
    return Frontier(node, along(here, heading, distance), heading, distance, None)
