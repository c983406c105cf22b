"""Obstacles as the centre of a disc sees them: larger discs, rounded boxes, walls moved inwards.

And the parts of circles that are free among them: what remains when all that covers them is taken
away.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from fuzzyq_bullet.geometry import Field, Floats
from fuzzyq_bullet.shapes import GRAZE

TOUCHES = 2 * GRAZE
"""``GRAZE`` for what was itself found to within ``GRAZE``."""
_CHUNK = 1_000_000
"""Most pairs of a line and an obstacle held in memory at once."""
_NEAR = 16
"""Discs about each end that a line is held against first: they stop most lines."""
_SEAM = 1e-12
"""Covered parts that are no farther apart than this (rad) are one, cut in two by rounding: a gap
that something could pass begins with more than 1e-5, for what covers it is smaller by ``GRAZE``."""


class ConfigurationSpace:
    """Obstacles grown by the radius of the disc whose centre moves among them.

    Args:
        field: The obstacles and walls as they are.
        radius: Radius of the moving disc (m).

    Attributes:
        field: As given.
        radius: As given.
        centres: Shape (N, 2) (m): of all grown discs, those of round obstacles and of corners.
        radii: Shape (N,): radii of the grown discs (m).
        near: Shape (N, K): for each disc, the discs with the nearest centres, nearest first.
    """

    def __init__(self, field: Field, radius: float) -> None:
        self.field, self.radius = field, radius
        discs = np.unique(field.discs + np.array([0.0, 0.0, radius]), axis=0)
        self.centres, self.radii = discs[:, :2].copy(), discs[:, 2].copy()
        self.near = _nearest(self.centres)

    def is_free(self, points: Floats) -> NDArray[np.bool_]:
        """Tell for each point, shape (K, 2), whether the disc fits there; shape (K,)."""
        free: NDArray[np.bool_] = self.field.clearance(points) >= self.radius - TOUCHES
        return free

    def are_open(
        self,
        begin: Floats,
        end: Floats,
        first: NDArray[np.intp] | None = None,
        last: NDArray[np.intp] | None = None,
    ) -> NDArray[np.bool_]:
        """Tell for each straight line whether the disc can move along it; shape (S,).

        Both ends must be free. Then a line that enters a grown obstacle enters the disc of one of
        its corners or crosses the bare obstacle, and one between the walls stays there.

        Args:
            begin: Shape (S, 2) (m).
            end: Shape (S, 2) (m).
            first: Shape (S,): a disc near each beginning, if known; only makes it faster.
            last: Shape (S,): the same for the ends.
        """
        alive = np.arange(len(begin))
        for around in (first, last):
            if around is None:
                continue
            for k in range(self.near.shape[1]):
                disc = self.near[around[alive], k]
                gap = _to_lines(begin[alive], end[alive], self.centres[disc])
                alive = alive[gap >= self.radii[disc] - TOUCHES]
        rows = max(1, _CHUNK // max(1, 2 * len(self.radii)))
        open_ = np.zeros(len(begin), dtype=bool)
        for k in range(0, len(alive), rows):
            part = alive[k : k + rows]
            a, b = begin[part, None], end[part, None]
            clear = np.all(_to_lines(a, b, self.centres) >= self.radii - TOUCHES, axis=1)
            part = part[clear]
            open_[part] = True
            for group in self.field.groups:
                open_[part] &= ~group.are_crossed(begin[part], end[part])
        return open_


def _to_lines(begin: Floats, end: Floats, points: Floats) -> Floats:
    """Distance (m) from points to the straight lines between two others, elementwise."""
    vx, vy = end[..., 0] - begin[..., 0], end[..., 1] - begin[..., 1]
    wx, wy = points[..., 0] - begin[..., 0], points[..., 1] - begin[..., 1]
    squared = np.maximum(vx * vx + vy * vy, 1e-300)
    along = np.minimum(np.maximum((wx * vx + wy * vy) / squared, 0.0), 1.0)
    distance: Floats = np.hypot(wx - along * vx, wy - along * vy)
    return distance


def _nearest(centres: Floats) -> NDArray[np.intp]:
    count = min(_NEAR, len(centres))
    if count == 0:
        return np.zeros((0, 0), dtype=np.intp)
    _, index = KDTree(centres).query(centres, k=np.arange(1, count + 1))
    return np.asarray(index, dtype=np.intp)


@dataclass(frozen=True, eq=False)
class FreeArcs:
    """Free arcs of all grown discs' edges, in the order of the discs and then of the angle.

    Attributes:
        disc: Shape (A,): the disc on whose edge each lies.
        begin: Shape (A,): angle (rad) in [0, 2π) at which it begins; it goes on anticlockwise.
        extent: Shape (A,): how far it goes (rad), at most 2π, which is a whole circle.
        last: Shape (N,): for each disc, its last arc; −1 if it has none.
    """

    disc: NDArray[np.intp]
    begin: Floats
    extent: Floats
    last: NDArray[np.intp]

    @classmethod
    def of(cls, world: ConfigurationSpace) -> FreeArcs:
        """Find the free arcs of all discs of a world."""
        disc: list[int] = []
        spans: list[tuple[float, float]] = []
        last = np.full(len(world.radii), -1, dtype=np.intp)
        for i, (centre, radius) in enumerate(zip(world.centres, world.radii, strict=True)):
            free = free_arcs(world, centre, float(radius))
            disc.extend([i] * len(free))
            spans.extend(free)
            if free:
                last[i] = len(spans) - 1
        begin, extent = np.array(spans, dtype=np.float64).reshape(-1, 2).T
        return cls(np.array(disc, dtype=np.intp), begin, extent, last)

    def locate(self, disc: NDArray[np.intp], angle: Floats) -> tuple[NDArray[np.intp], Floats]:
        """Find the free arc on which points of discs' edges lie.

        Args:
            disc: Shape (K,): whose edge.
            angle: Shape (K,): where on it (rad).

        Returns:
            Shape (K,): the arc, −1 where the edge is covered; and shape (K,): how far (rad) from
            the arc's beginning.
        """
        if not len(self.disc):
            return np.full(len(disc), -1, dtype=np.intp), np.zeros(len(disc))
        angle = np.remainder(angle, math.tau)
        # One sorted array for all discs: angles are below 8.
        found = np.searchsorted(self.disc * 8.0 + self.begin, disc * 8.0 + angle, "right") - 1
        # Ahead of a disc's first arc, only its last one can reach, across the angle 0.
        before_first = (found < 0) | (self.disc[found] != disc)
        found = np.where(before_first, self.last[disc], found)
        offset = np.remainder(angle - self.begin[found], math.tau)
        inside = (found >= 0) & (offset <= self.extent[found])
        return np.where(inside, found, -1), offset


def free_arcs(
    world: ConfigurationSpace, centre: Floats, radius: float
) -> list[tuple[float, float]]:
    """Return beginning and extent (rad) of the parts of a circle where the disc's centre may be.

    Args:
        world: Everything that may cover parts of the circle. A disc of it that is the circle
            itself only touches it.
        centre: Shape (2,) (m).
        radius: Of the circle (m).

    Returns:
        In the order of their beginnings in [0, 2π); a whole circle is one arc of 2π.
    """
    covers = [
        _by_discs(world, centre, radius),
        *(group.covers(centre, radius, world.radius - GRAZE) for group in world.field.groups),
        _by_walls(world, centre, radius),
    ]
    begin, extent = np.concatenate(covers).T
    if not len(begin):
        return [(0.0, math.tau)]
    if extent.max() >= math.tau:
        return []
    order = np.argsort(begin)
    begin, end = begin[order], (begin + extent)[order]
    # What ends beyond 2π covers the beginning as well.
    covered_to = np.maximum(np.maximum.accumulate(end), end.max() - math.tau)
    following = np.append(begin[1:], begin[0] + math.tau)
    gaps = np.flatnonzero(following > covered_to + _SEAM)
    arcs = [(float(covered_to[k] % math.tau), float(following[k] - covered_to[k])) for k in gaps]
    return sorted(arcs)


def _intervals(middle: Floats, half: Floats) -> Floats:
    """Shape (K, 2): beginning in [0, 2π) and extent (rad) of covered parts."""
    return np.column_stack([np.remainder(middle - half, math.tau), 2 * half])


def _by_discs(world: ConfigurationSpace, centre: Floats, radius: float) -> Floats:
    dx, dy = (world.centres - centre).T
    apart, other = np.hypot(dx, dy), world.radii - GRAZE
    meets = (apart < radius + other) & (apart + other > radius)
    dx, dy, apart, other = dx[meets], dy[meets], apart[meets], other[meets]
    nearness = radius * radius + apart * apart - other * other
    cosine = nearness / np.maximum(2 * radius * apart, 1e-300)
    return _intervals(np.arctan2(dy, dx), np.arccos(np.clip(cosine, -1.0, 1.0)))


def _by_walls(world: ConfigurationSpace, centre: Floats, radius: float) -> Floats:
    if world.field.walls is None:
        return np.zeros((0, 2))
    (x, y), (left, bottom, right, top) = centre, world.field.walls
    inset = world.radius - GRAZE
    gap = np.array([right - inset - x, top - inset - y, x - left - inset, y - bottom - inset])
    meets = gap < radius
    half = np.arccos(np.clip(gap[meets] / radius, -1.0, 1.0))
    return _intervals(np.arange(4.0)[meets] * (math.pi / 2), half)
