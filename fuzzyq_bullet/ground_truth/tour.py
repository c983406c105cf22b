"""The shortest way through several discs in turn: via points, then the goal disc.

Between two points the shortest path is exact. Where it meets each disc is found by pulling the way
taut: first every leg ends where it reaches its disc first; then each of these points moves to where
the straight lines beside it are shortest together, and the legs are found again, as long as that
helps. The result is a way that can be driven, and no way near it is shorter. It is not proven to be
the shortest of all: among obstacles another choice of sides may be shorter. With no via point it is
the exact shortest path.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from scipy.optimize import minimize_scalar

from fuzzyq_bullet.ground_truth.tangent_graph import Route
from fuzzyq_bullet.quantities import Point

Disc: TypeAlias = tuple[Point, float]
"""Centre and radius (m)."""
Leg: TypeAlias = Callable[[Point, Point, float], Route | None]
"""The shortest path from a point to a disc, given by its centre and radius (m)."""

_ROUNDS = 8
_GAIN = 1e-4
"""A round that makes the way shorter by less than this (m) is the last."""
_INSIDE = 1.0 - 1e-9
"""Points on a rim are taken so far inside it that rounding does not put them outside."""


def tour(leg: Leg, start: Point, discs: Sequence[Disc]) -> Route | None:
    """Return the shortest way from a start through all discs but the last, to the last.

    Args:
        leg: Finds the shortest path from a point to a disc.
        start: Where it begins (m).
        discs: What it passes, in this order; it ends at the first point of the last.

    Returns:
        The way; None if one of the discs cannot be reached.
    """
    legs: list[Route] = []
    at = start
    for centre, radius in discs:
        found = leg(at, centre, radius)
        if found is None:
            return None
        legs.append(found)
        at = _last(found)
    best = _joined(legs)
    for _ in range(_ROUNDS if len(discs) > 1 else 0):
        pulled = _pulled(leg, legs, start, discs)
        if pulled is None or _joined(pulled).length > best.length - _GAIN:
            break
        legs, best = pulled, _joined(pulled)
    return best


def _pulled(
    leg: Leg, legs: Sequence[Route], start: Point, discs: Sequence[Disc]
) -> list[Route] | None:
    """Move the points between the legs, and find the legs again."""
    points = [start]
    for one, two, (centre, radius) in zip(legs, legs[1:], discs, strict=False):
        before = one.points[-2] if len(one.points) > 1 else one.points[-1]
        after = two.points[1] if len(two.points) > 1 else two.points[0]
        points.append(_between(before, after, np.array(centre), radius))
    found = []
    for k, (centre, radius) in enumerate(discs):
        last = k == len(discs) - 1
        way = leg(points[k], *((centre, radius) if last else (points[k + 1], 0.0)))
        if way is None:
            return None
        found.append(way)
    return found


def _between(before: np.ndarray, after: np.ndarray, centre: np.ndarray, radius: float) -> Point:
    """Return the point of a disc over which the way from one point to another is shortest."""
    way = after - before
    along = float((centre - before) @ way) / max(float(way @ way), 1e-300)
    foot = before + min(max(along, 0.0), 1.0) * way
    if np.hypot(*(foot - centre)) <= radius:
        return float(foot[0]), float(foot[1])

    def on_rim(angle: float) -> np.ndarray:
        rim: np.ndarray = centre + radius * _INSIDE * np.array([math.cos(angle), math.sin(angle)])
        return rim

    def length(angle: float) -> float:
        at = on_rim(angle)
        return float(np.hypot(*(at - before)) + np.hypot(*(after - at)))

    towards = math.atan2(*(foot - centre)[::-1])
    best = minimize_scalar(
        length, bounds=(towards - math.pi / 2, towards + math.pi / 2), method="bounded"
    )
    x, y = on_rim(float(best.x)).tolist()
    return x, y


def _joined(legs: Sequence[Route]) -> Route:
    if len(legs) == 1:
        return legs[0]
    points = np.concatenate([legs[0].points, *(one.points[1:] for one in legs[1:])])
    points.flags.writeable = False
    return Route(sum(one.length for one in legs), points)


def _last(route: Route) -> Point:
    x, y = route.points[-1].tolist()
    return x, y
