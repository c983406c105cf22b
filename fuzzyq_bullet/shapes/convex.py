"""Upright prisms over any convex polygon: what a new shape with flat faces is made of."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.shapes.base import (
    GRAZE,
    PARALLEL,
    Collision,
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

_HULL_MARGIN = 0.001
"""How far a convex mesh of PyBullet reaches beyond its corners (m)."""
_FARTHEST_SHIFT = 2.0
"""How many margins a corner moves inwards at most: as at 60°."""


class ConvexPolygons(ShapeGroup):
    """Prisms over convex polygons, all padded to as many corners E as the one with most.

    Args:
        polygons: Corners of each (m), shape (K, 2), K ≥ 3, anticlockwise.
    """

    def __init__(self, polygons: Sequence[Floats]) -> None:
        most = max((len(one) for one in polygons), default=3)
        self._count = len(polygons)
        start = np.zeros((len(polygons), most, 2))
        for row, one in zip(start, polygons, strict=True):
            row[:] = one[-1]
            row[: len(one)] = one
        side = np.roll(start, -1, axis=1) - start
        self._length = np.hypot(side[..., 0], side[..., 1])
        real = self._length > 0.0
        along = side / np.maximum(self._length, 1e-300)[..., None]
        self._x, self._y = start[..., 0], start[..., 1]
        self._tx, self._ty = along[..., 0], along[..., 1]
        self._nx, self._ny = along[..., 1], -along[..., 0]  # outwards
        self._real = real
        corners = start[real]
        self.discs = np.column_stack([corners, np.zeros(len(corners))])

    @classmethod
    def of(cls, shapes: Sequence[ConvexShape]) -> Self:
        """Build it of convex shapes, which may have any number of corners each."""
        return cls([one.outline() for one in shapes])

    def __len__(self) -> int:
        return self._count

    def distances(self, x: Floats, y: Floats, which: Mask | None = None) -> Floats:
        """Return the distance to each polygon."""
        above, fx, fy = self._apart(x, y)
        inside = above.max(axis=2)
        distance: Floats = np.where(inside <= 0.0, inside, np.hypot(fx, fy).min(axis=2))
        return distance if which is None else distance[:, which]

    def free_distances(self, x: float, y: float, ux: Floats, uy: Floats, radius: float) -> Floats:
        """Return where the disc's centre enters the polygon grown by its radius, corners round."""
        dx, dy = self._x - x, self._y - y
        ux, uy = ux[..., None], uy[..., None]
        closing = -(ux * self._nx + uy * self._ny)
        gap = -(dx * self._nx + dy * self._ny) - radius
        towards = self._real & (closing > PARALLEL) & (gap >= 0.0)
        way = np.where(towards, gap / np.where(towards, closing, 1.0), np.inf)
        reached = np.where(towards, way, 0.0)
        aside = (reached * ux - dx) * self._tx + (reached * uy - dy) * self._ty
        way = np.where((aside >= 0.0) & (aside <= self._length), way, np.inf)
        corner = reach_of_circles(dx, dy, ux, uy, np.full_like(dx, radius))
        reach = np.minimum(way, np.where(self._real, corner, np.inf)).min(axis=2)
        # Distance to a convex body is convex along a line: what begins to grow goes on growing.
        above, fx, fy = self._apart(np.array([[x]]), np.array([[y]]))
        inside, apart = above.max(axis=2, keepdims=True), np.hypot(fx, fy)
        within = inside <= 0.0
        outside = apart.min(axis=2, keepdims=True)
        # In the middle between sides, where several are nearest, every way leads out.
        nearest = np.where(within, above >= inside - GRAZE, apart <= outside)
        span = np.where(outside > 0.0, outside, 1.0)
        grows = np.where(within, -closing, (fx * ux + fy * uy) / span)
        growth = np.where(nearest, grows, -np.inf).max(axis=2)
        stopped = np.where(growth < -PARALLEL, 0.0, np.inf)
        distance = np.where(within, inside, outside)[..., 0]
        return np.where(distance <= radius, stopped, reach)

    def are_crossed(self, begin: Floats, end: Floats) -> Mask:
        """Tell which lines cross the inside of a bare polygon."""
        x, y = (begin[:, k, None, None] for k in (0, 1))
        vx, vy = (end[:, k, None, None] - begin[:, k, None, None] for k in (0, 1))
        depth = (self._x - x) * self._nx + (self._y - y) * self._ny
        leaving = vx * self._nx + vy * self._ny
        still = np.abs(leaving) < 1e-30
        at = depth / np.where(still, 1.0, leaving)
        enter = np.where(self._real & ~still & (leaving < 0.0), at, 0.0).max(axis=2)
        leave = np.where(self._real & ~still & (leaving > 0.0), at, 1.0).min(axis=2)
        beside = np.any(self._real & still & (depth <= 0.0), axis=2)
        crossed: Mask = np.any((np.maximum(enter, 0.0) < np.minimum(leave, 1.0)) & ~beside, axis=1)
        return crossed

    def covers(self, centre: Floats, radius: float, grown: float) -> Floats:
        """Return the parts within the polygons, and within the strips along their sides."""
        found = []
        far = self.distances(*centre.reshape(2, 1, 1))[0]
        for k in np.flatnonzero(far < radius + grown).tolist():
            real = self._real[k]
            n = np.column_stack([self._nx[k], self._ny[k]])[real]
            t = np.column_stack([self._tx[k], self._ty[k]])[real]
            start = np.column_stack([self._x[k], self._y[k]])[real] - centre
            depth = (start * n).sum(1)  # n·p ≤ depth is the inner side
            found.append(part_within(n, depth, radius))
            first = (start * t).sum(1)
            for side, level in enumerate(depth):
                lines = np.array([n[side], -n[side], t[side], -t[side]])
                last = first[side] + self._length[k][real][side]
                levels = [level + grown, GRAZE - level, last, -first[side]]
                found.append(part_within(lines, np.array(levels), radius))
        return np.concatenate(found) if found else np.zeros((0, 2))

    def _apart(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
        """How far points, shape (K, 1), are beyond each side's line, and the ways from the sides.

        Each of shape (K, N, E).
        """
        dx, dy = x[..., None] - self._x, y[..., None] - self._y
        above = np.where(self._real, dx * self._nx + dy * self._ny, -np.inf)
        along = np.clip(dx * self._tx + dy * self._ty, 0.0, self._length)
        return above, dx - along * self._tx, dy - along * self._ty


class ConvexShape(Shape):
    """A shape with flat faces: subclasses say where its corners are, and nothing else."""

    group = ConvexPolygons

    @abstractmethod
    def polygon(self) -> Sequence[tuple[float, float]]:
        """Return at least three corners (m) of a convex polygon, anticlockwise from above."""

    def corners(self) -> tuple[Floats, float]:
        """Return the corners, which are not round."""
        return self.outline(), 0.0

    def outline(self, corners: int = 24) -> Floats:
        """Return the corners."""
        return np.array(self.polygon(), dtype=np.float64).reshape(-1, 2)

    def faces(self) -> Floats:
        """Return the corners."""
        return self.outline()

    def collisions(self, height: float) -> list[Collision]:
        """Return a convex mesh, smaller by what PyBullet adds to it."""
        return [prism_over(self.outline() - self.position, height)]


def prism_over(ring: Floats, height: float) -> Collision:
    """Return the solid over a convex polygon, smaller by what PyBullet adds to it.

    Its faces are where they should be to within 1 mm, at sharp corners too.

    Args:
        ring: Shape (K, 2), anticlockwise, about the obstacle's position (m).
        height: Of the solid (m).
    """
    # Every side moves inwards by the margin: a corner to where its two moved sides meet.
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    n1, n2 = (np.column_stack([v[:, 1], -v[:, 0]]) for v in (before, after))
    n1, n2 = (n / np.hypot(n[:, 0], n[:, 1])[:, None] for n in (n1, n2))
    shift = (n1 + n2) / np.maximum(1.0 + (n1 * n2).sum(1), 1e-9)[:, None]
    # A sharp corner stays: the margin would not reach back to it.
    far = np.maximum(np.hypot(*shift.T), 1e-9)[:, None]
    inner = ring - _HULL_MARGIN * shift * np.minimum(1.0, _FARTHEST_SHIFT / far)
    if np.all(((np.roll(inner, -1, axis=0) - inner) * after).sum(1) > 0.0):
        ring = inner  # else it is thinner than the margins, and would be turned inside out
    half = height / 2 - _HULL_MARGIN
    levels = np.repeat([-half, half], len(ring))
    return Collision("", prism=np.column_stack([np.tile(ring, (2, 1)), levels]))
