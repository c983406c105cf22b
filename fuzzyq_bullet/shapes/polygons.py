"""All polygons of a field at once, by their sides: no inner side of a cut can leak."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyq_bullet.shapes.base import (
    GRAZE,
    PARALLEL,
    Floats,
    Mask,
    Shape,
    ShapeGroup,
    part_within,
    reach_of_circles,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typing_extensions import Self


class Polygons(ShapeGroup):
    """Prisms over simple polygons.

    The sides of all of them, E, lie in one array after the other. What can be asked of many points
    or lines at once goes through an index of the plane (STR tree).

    Args:
        outlines: Corners of each (m), shape (K, 2), K ≥ 3, anticlockwise.
    """

    def __init__(self, outlines: Sequence[Floats]) -> None:
        self._outlines = outlines
        self._count = np.array([len(one) for one in outlines], dtype=np.intp)
        self._first = np.cumsum(self._count) - self._count
        self._owner = np.repeat(np.arange(len(outlines)), self._count)
        start = np.concatenate([np.zeros((0, 2)), *outlines])
        total = len(start)
        after = np.arange(1, total + 1)
        after[self._first + self._count - 1] = self._first
        self._before = np.empty(total, dtype=np.intp)
        self._before[after] = np.arange(total)
        side = start[after] - start
        self._length = np.hypot(side[:, 0], side[:, 1])
        self._x, self._y = start.T.copy()
        self._tx, self._ty = (side / self._length[:, None]).T.copy()
        self._nx, self._ny = self._ty, -self._tx  # outwards
        # For the crossing number: a level side is never crossed.
        self._end_y = self._y[after]
        self._slope = side[:, 0] / np.where(side[:, 1] == 0.0, 1.0, side[:, 1])
        low, high = (
            np.array([f(one, axis=0) for one in outlines]).reshape(-1, 2) for f in (np.min, np.max)
        )
        self._centre = (low + high) / 2
        self._extent = np.hypot(*(high - low).T) / 2
        turn = self._tx[self._before] * self._ty - self._ty[self._before] * self._tx
        self._convex = turn > 0.0
        # Nothing touches a corner that points inwards before it touches a side.
        corners = start[self._convex]
        self.discs = np.column_stack([corners, np.zeros(len(corners))])
        self.discs.flags.writeable = False

    @classmethod
    def of(cls, shapes: Sequence[Shape]) -> Self:
        """Build it of polygons."""
        return cls([one.outline() for one in shapes])

    def __len__(self) -> int:
        return len(self._count)

    def distances(self, x: Floats, y: Floats, which: Mask | None = None) -> Floats:
        """Return the distance to each polygon."""
        if which is None:
            sides, first = np.arange(len(self._x)), self._first
        else:
            sides, count = np.flatnonzero(which[self._owner]), self._count[which]
            first = np.cumsum(count) - count
        if not len(sides):
            return np.zeros((len(x), 0))
        fx, fy, _ = self._apart(x, y, sides)
        apart: Floats = np.sqrt(np.minimum.reduceat(fx * fx + fy * fy, first, axis=1))
        inside = np.logical_xor.reduceat(self._crossings(x, y, sides), first, axis=1)
        return np.where(inside, -apart, apart)

    def clearance(self, points: Floats) -> Floats:
        """Return the signed distance (m) from each point to the nearest polygon, shape (K,)."""
        import shapely

        if not np.isfinite(points).all():
            return super().clearance(points)
        told: Any = shapely.points(points)
        _, result = self._ring_tree.query_nearest(told, return_distance=True, all_matches=False)
        result = np.array(result, dtype=np.float64)
        point, polygon = self._area_tree.query(told, predicate="intersects")
        depth = shapely.distance(told[point], self._ring_tree.geometries[polygon])
        np.minimum.at(result, point, -depth)
        return result

    def free_distances(self, x: float, y: float, ux: Floats, uy: Floats, radius: float) -> Floats:
        """Return where the disc's centre enters the polygon grown by its radius, corners round.

        Every side stops the disc by itself, as does every corner that points outwards. A side that
        is touched already counts as it is: the disc may slide along it or move away, and comes no
        nearer to it or its corners. Inside a polygon the disc may only move out.
        """
        result = np.full((len(ux), len(self)), np.inf)
        cx, cy = (self._centre - (x, y)).T
        reach = self._extent + radius + GRAZE
        meets = (np.abs(ux * cy - uy * cx) <= reach) & (ux * cx + uy * cy >= -reach)
        near = np.flatnonzero(meets.any(axis=0))
        if not len(near):
            return result
        mine = np.zeros(len(self), dtype=bool)
        mine[near] = True
        sides = np.flatnonzero(mine[self._owner])
        first = np.cumsum(self._count[near]) - self._count[near]
        here = np.array([[x]]), np.array([[y]])
        fx, fy, along = self._apart(*here, sides)
        apart = np.hypot(fx, fy)
        dx, dy = self._x[sides] - x, self._y[sides] - y
        nx, ny, tx, ty = (a[sides] for a in (self._nx, self._ny, self._tx, self._ty))
        length = self._length[sides]
        closing, above = -(ux * nx + uy * ny), -(dx * nx + dy * ny)

        at_corner = (along <= 0.0) | (along >= length)
        touched = (apart <= radius) & ((above >= 0.0) | at_corner)
        gap = above - radius
        towards = (closing > PARALLEL) & (gap >= 0.0) & ~touched
        way = np.where(towards, gap / np.where(towards, closing, 1.0), np.inf)
        reached = np.where(towards, way, 0.0)
        aside = (reached * ux - dx) * tx + (reached * uy - dy) * ty
        way = np.where((aside >= 0.0) & (aside <= length), way, np.inf)

        kept = np.where(touched, apart, radius)[0]
        before = np.searchsorted(sides, self._before[sides])
        corner = reach_of_circles(dx, dy, ux, uy, np.minimum(kept, kept[before])[None])
        way = np.minimum(way, np.where(self._convex[sides], corner, np.inf))

        grows = np.where(apart > 0.0, (fx * ux + fy * uy) / np.where(apart > 0.0, apart, 1.0), 0.0)
        grows = np.where(apart > 0.0, grows, -closing)
        way = np.where(touched & (grows < -PARALLEL), 0.0, way)
        outside = np.minimum.reduceat(way, first, axis=1)

        least = np.minimum.reduceat(apart, first, axis=1)
        inside = np.logical_xor.reduceat(self._crossings(*here, sides), first, axis=1)
        inside &= least > 0.0
        nearest = apart <= np.repeat(least, self._count[near], axis=1) + GRAZE
        leaving = np.maximum.reduceat(np.where(nearest, -grows, -np.inf), first, axis=1)
        out = np.where(leaving < -PARALLEL, 0.0, np.inf)
        result[:, near] = np.where(inside, out, outside)
        return result

    def are_crossed(self, begin: Floats, end: Floats) -> Mask:
        """Tell which lines cross the inside of a bare polygon."""
        import shapely

        crossed = np.zeros(len(begin), dtype=bool)
        lines: Any = shapely.linestrings(np.stack([begin, end], axis=1))
        line, polygon = self._area_tree.query(lines, predicate="intersects")
        shared = shapely.relate_pattern(
            lines[line], self._area_tree.geometries[polygon], "T********"
        )
        crossed[line[shared]] = True
        return crossed

    def covers(self, centre: Floats, radius: float, grown: float) -> Floats:
        """Return the parts within the polygons, and within the strips along their sides."""
        import shapely

        about = shapely.Point(centre)
        near = self._area_tree.query(about, predicate="dwithin", distance=radius + grown)
        found = [np.zeros((0, 2))]
        for k in sorted(near.tolist()):
            sides = slice(int(self._first[k]), int(self._first[k] + self._count[k]))
            n = np.column_stack([self._nx[sides], self._ny[sides]])
            t = np.column_stack([self._tx[sides], self._ty[sides]])
            start = np.column_stack([self._x[sides], self._y[sides]]) - centre
            length = self._length[sides]
            found.append(self._inside(centre, radius, np.arange(sides.start, sides.stop)))
            depth, first = (start * n).sum(1), (start * t).sum(1)
            apart = np.hypot(depth, np.maximum(np.maximum(first, -first - length), 0.0))
            for side in np.flatnonzero(apart <= radius + grown).tolist():
                lines = np.array([n[side], -n[side], t[side], -t[side]])
                level, last = depth[side], first[side] + length[side]
                levels = [level + grown, GRAZE - level, last, -first[side]]
                found.append(part_within(lines, np.array(levels), radius))
        return np.concatenate(found)

    def _inside(self, centre: Floats, radius: float, sides: Any) -> Floats:
        """Return the parts of a circle within one bare polygon, by its sides."""
        sx, sy = self._x[sides] - centre[0], self._y[sides] - centre[1]
        tx, ty = self._tx[sides], self._ty[sides]
        along = sx * tx + sy * ty
        square = along * along - sx * sx - sy * sy + radius * radius
        half = np.sqrt(np.maximum(square, 0.0))
        cuts = [0.0]
        for at in (-along - half, -along + half):
            meets = (square >= 0.0) & (at >= 0.0) & (at <= self._length[sides])
            angle = np.arctan2(sy + at * ty, sx + at * tx)[meets]
            cuts += np.remainder(angle, math.tau).tolist()
        bounds = np.append(np.sort(cuts), math.tau)
        begin, extent = bounds[:-1], np.diff(bounds)
        middle = begin + extent / 2
        x, y = centre[0] + radius * np.cos(middle), centre[1] + radius * np.sin(middle)
        crossings = self._crossings(x[:, None], y[:, None], sides)
        inside = np.logical_xor.reduce(crossings, axis=1) & (extent > 0.0)
        return np.column_stack([begin[inside], extent[inside]])

    def _apart(self, x: Floats, y: Floats, sides: Any) -> tuple[Floats, Floats, Floats]:
        """Return the ways from the sides to points, and where along the sides they begin (m).

        Each of shape (K, E).
        """
        dx, dy = x - self._x[sides], y - self._y[sides]
        tx, ty = self._tx[sides], self._ty[sides]
        along = np.minimum(np.maximum(dx * tx + dy * ty, 0.0), self._length[sides])
        return dx - along * tx, dy - along * ty, along

    def _crossings(self, x: Floats, y: Floats, sides: Any) -> Mask:
        """Tell which sides a line from each point along x crosses, shape (K, E)."""
        start_y = self._y[sides]
        crossed: Mask = (start_y > y) != (self._end_y[sides] > y)
        crossed &= x < self._x[sides] + (y - start_y) * self._slope[sides]
        return crossed

    @cached_property
    def _area_tree(self) -> Any:
        import shapely

        return shapely.STRtree([shapely.Polygon(one) for one in self._outlines])

    @cached_property
    def _ring_tree(self) -> Any:
        import shapely

        return shapely.STRtree([shapely.LinearRing(one) for one in self._outlines])
