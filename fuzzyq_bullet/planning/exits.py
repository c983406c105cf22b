"""Exits: ways that begin where the robot looked about, and lead to what it could not see."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from fuzzyq_bullet.planning.view import JUMP, Point, View

SHORTEST = 0.1
"""An exit shorter than this leads nowhere (m)."""
PEEK = 0.3
"""How far past the end of what hides something the robot goes to look behind it (m)."""
SHY = 0.25
"""How far before the end of its sight the robot stops to look again (m)."""
BEHIND = 0.02
"""How far behind the end of what is seen it is that must be seen next (m)."""
APART = math.radians(15.0)
"""Where the sight is free, one heading stands for all within so much (rad)."""
SHALLOW = 0.15
"""Ways into the open no longer than this are no gaps, however narrow (m)."""


class Exit(NamedTuple):
    """A way that begins at a place and was not gone yet.

    Attributes:
        place: Index of the place.
        point: Where it leads (m); the straight way there is free.
        heading: The way's heading (rad).
        way: From the place to the point (m).
        beyond: What is not seen yet (m); once it is, there is no more to find out here. None for a
            gap: whether it leads on is only seen from within.
        ahead: Whether that lies straight on, where the sight ended and nothing stood.
    """

    place: int
    point: Point
    heading: float
    way: float
    beyond: Point | None
    ahead: bool = False


def exits_of(place: int, here: Point, view: View) -> Iterator[Exit]:
    """Yield the exits of a view: past what hides something, into gaps, and where the sight ends."""
    count, last = len(view.lengths), -math.inf
    for k, (heading, free) in enumerate(zip(view.headings, view.lengths, strict=True)):
        if free < SHORTEST:
            continue
        if free >= view.range and heading - last >= APART:
            last = heading
            way = free - SHY
            beyond = along(here, heading, free + BEHIND)
            yield Exit(place, along(here, heading, way), heading, way, beyond, ahead=True)
        for beside, side in ((k - 1, -1), ((k + 1) % count, 1)):
            hidden = view.lengths[beside]
            if free - hidden > JUMP:
                way = min(hidden + PEEK, free)
                point = along(here, heading, way)
                beyond = along(point, heading + side * math.pi / 2, BEHIND)
                yield Exit(place, point, heading, way, beyond)
    for k in view.gaps:
        if SHORTEST < view.lengths[k] < view.range:
            yield _into(place, here, view, k)


def doubtful_exits_of(place: int, here: Point, view: View) -> Iterator[Exit]:
    """Yield a way into every corner of a view: what seems closed may be a gap, seen from within."""
    count = len(view.lengths)
    for k, free in enumerate(view.lengths):
        if free > SHALLOW and view.lengths[k - 1] < free >= view.lengths[(k + 1) % count]:
            yield _into(place, here, view, k)


def along(origin: Point, heading: float, way: float) -> Point:
    """Return the point that lies a way (m) from another along a heading (rad)."""
    return origin[0] + way * math.cos(heading), origin[1] + way * math.sin(heading)


def _into(place: int, here: Point, view: View, k: int) -> Exit:
    heading, way = view.headings[k], view.lengths[k]
    return Exit(place, along(here, heading, way), heading, way, None)
