"""Outlines of simple polygons: what is wrong with one, its convex pieces, its thinnest part."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyq_bullet.shapes.base import Floats

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fuzzyq_bullet.quantities import Point

LEAST_AREA = 1e-4
"""Least area of a polygon (m²): 1 cm × 1 cm."""
WIDTHS = (0.05, 0.04, 0.03, 0.02)
"""Distances of rays that are tried (m), widest first."""
FINEST = WIDTHS[-1]
_UNSEEN = 0.0105
"""How far a corner may be from the nearest disc of such a width inside the polygon (m)."""
_REMEMBERED = 20_000


def mistake_of(points: Sequence[Point]) -> tuple[int | None, str] | None:
    """Return why points are not the corners of a simple polygon; None if they are.

    Args:
        points: Any number (m).

    Returns:
        The number of the point at which it shows, if there is one, and what is wrong.
    """
    if len(points) < 3:
        return None, f"must have at least 3 values, got {len(points)}"
    seen: dict[Point, int] = {}
    for at, point in enumerate(points):
        before = seen.setdefault(point, at)
        if before != at:
            closes = before == 0 and at == len(points) - 1
            more = "; leave it out: a polygon closes by itself" if closes else ""
            return at, f"is the same place as points[{before}]{more}"
    import shapely  # only who has polygons waits for it to load

    polygon = shapely.Polygon(points)
    if not polygon.is_valid:
        return _crossing(np.array(points))
    if polygon.area < LEAST_AREA:
        return None, f"enclose {polygon.area:.2g} m²; at least {LEAST_AREA:g} m² are needed"
    return None


def _crossing(points: Floats) -> tuple[int | None, str]:
    """Say which two sides of an outline meet."""
    import shapely

    count = len(points)
    sides: Any = shapely.linestrings(np.stack([points, np.roll(points, -1, axis=0)], axis=1))
    first, second = shapely.STRtree(sides).query(sides, predicate="intersects")
    pairs = sorted((i, j) for i, j in zip(first.tolist(), second.tolist(), strict=True) if i < j)
    for i, j in pairs:
        beside = j - i in (1, count - 1)
        if beside and shapely.length(shapely.intersection(sides[i], sides[j])) == 0.0:
            continue
        ends = [f"points[{k}]–points[{(k + 1) % count}]" for k in (i, j)]
        return j, f"the side {ends[1]} meets the side {ends[0]}; no side may meet another"
    return None, "enclose no area, or sides of them meet"


@lru_cache(maxsize=_REMEMBERED)
def convex_pieces(points: tuple[Point, ...]) -> tuple[Floats, ...]:
    """Cut a simple polygon into convex ones.

    Triangles that keep its corners (constrained Delaunay), merged across every inner side that
    leaves no angle above 180° (Hertel and Mehlhorn).

    Args:
        points: Its corners, in either order (m).

    Returns:
        Polygons of its corners alone, shape (K, 2) each, anticlockwise; read-only. Neighbours share
        whole sides.
    """
    import shapely

    cut = shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.Polygon(points)))
    place = np.array(points)
    number = {point: k for k, point in enumerate(points)}
    pieces: list[list[int]] = []
    for corners in shapely.get_coordinates(cut).reshape(-1, 4, 2)[:, :3].tolist():
        a, b, c = (number[x, y] for x, y in corners)
        pieces.append([a, b, c] if _turn(place, a, b, c) > 0.0 else [a, c, b])
    pieces = _merged(place, pieces)
    found = tuple(place[piece] for piece in pieces)
    for one in found:
        one.flags.writeable = False
    return found


def _merged(place: Floats, pieces: list[list[int]]) -> list[list[int]]:
    """Merge polygons across sides that they share, where the result is convex."""
    owner = {side: k for k, piece in enumerate(pieces) for side in _sides(piece)}
    inner = [(a, b) for a, b in owner if a < b and (b, a) in owner]
    # Long inner sides first: what remains is less drawn out.
    inner.sort(key=lambda side: (-math.dist(place[side[0]], place[side[1]]), side))
    alive: dict[int, list[int]] = dict(enumerate(pieces))
    for a, b in inner:
        one, other = owner[a, b], owner[b, a]
        if one == other:
            continue
        # From b round to a in the one, and from a round to b in the other.
        first, second = _from(alive[one], b), _from(alive[other], a)
        ring = first + second[1:-1]
        at = len(first) - 1
        left = _turn(place, ring[at - 1], ring[at], ring[(at + 1) % len(ring)])
        if left < 0.0 or _turn(place, ring[-1], ring[0], ring[1]) < 0.0:
            continue
        del alive[other]
        alive[one] = ring
        owner.update(dict.fromkeys(_sides(ring), one))
    return list(alive.values())


def _sides(piece: list[int]) -> list[tuple[int, int]]:
    return list(zip(piece, piece[1:] + piece[:1], strict=True))


def _from(piece: list[int], first: int) -> list[int]:
    at = piece.index(first)
    return piece[at:] + piece[:at]


def _turn(place: Floats, a: int, b: int, c: int) -> float:
    """Twice the area of a triangle, positive if it is anticlockwise."""
    (ax, ay), (bx, by), (cx, cy) = place[a], place[b], place[c]
    return float((bx - ax) * (cy - by) - (by - ay) * (cx - bx))


@lru_cache(maxsize=_REMEMBERED)
def seen_by_rays(points: tuple[Point, ...]) -> float:
    """Return how far apart parallel rays may be (m) that see a simple polygon, from any side.

    They meet every disc in it that is as wide as they are apart. What no such disc covers is a tip
    or a thin part; it may reach ``_UNSEEN`` farther, as a right angle does at 0.05 m.

    Args:
        points: Its corners, in either order (m).

    Returns:
        The first of ``WIDTHS`` that is enough; 0 if none is.
    """
    import shapely

    solid, corners = shapely.Polygon(points), shapely.points(points)
    for width in WIDTHS:
        half = 0.97 * width / 2  # something exactly as wide is not lost to rounding
        covered = solid.buffer(-half).buffer(half)
        if not covered.is_empty and np.max(shapely.distance(corners, covered)) <= _UNSEEN:
            return width
    return 0.0
