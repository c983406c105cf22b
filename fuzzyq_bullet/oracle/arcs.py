"""The parts of circles that are free: what remains when all that covers them is taken away."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.oracle.world import GRAZE

_SEAM = 1e-12
"""Covered parts that are no farther apart than this (rad) are one, cut in two by rounding: a gap
that something could pass begins with more than 1e-5, for what covers it is smaller by ``GRAZE``."""

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fuzzyq_bullet.geometry import Floats
    from fuzzyq_bullet.oracle.world import GrownWorld


@dataclass(frozen=True, eq=False)
class Arcs:
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
    def of(cls, world: GrownWorld) -> Arcs:
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


def free_arcs(world: GrownWorld, centre: Floats, radius: float) -> list[tuple[float, float]]:
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
        _by_boxes(world, centre, radius),
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


def _by_discs(world: GrownWorld, centre: Floats, radius: float) -> Floats:
    dx, dy = (world.centres - centre).T
    apart, other = np.hypot(dx, dy), world.radii - GRAZE
    meets = (apart < radius + other) & (apart + other > radius)
    dx, dy, apart, other = dx[meets], dy[meets], apart[meets], other[meets]
    nearness = radius * radius + apart * apart - other * other
    cosine = nearness / np.maximum(2 * radius * apart, 1e-300)
    return _intervals(np.arctan2(dy, dx), np.arccos(np.clip(cosine, -1.0, 1.0)))


def _by_walls(world: GrownWorld, centre: Floats, radius: float) -> Floats:
    if world.field.arena is None:
        return np.zeros((0, 2))
    (x, y), (width, depth) = centre, world.field.arena
    inset = world.radius - GRAZE
    gap = np.array([width - inset - x, depth - inset - y, x - inset, y - inset])
    meets = gap < radius
    half = np.arccos(np.clip(gap[meets] / radius, -1.0, 1.0))
    return _intervals(np.arange(4.0)[meets] * (math.pi / 2), half)


def _by_boxes(world: GrownWorld, centre: Floats, radius: float) -> Floats:
    """Cover by the boxes grown along one of their axes; the rest of them are corners' discs."""
    x, y, hx, hy, cos, sin = world.boxes
    if not len(x):
        return np.zeros((0, 2))
    dx, dy = centre[0] - x, centre[1] - y
    px, py = dx * cos + dy * sin, dy * cos - dx * sin
    yaw = np.arctan2(sin, cos)
    grown = world.radius - GRAZE
    found = [
        _by_rectangles(px, py, wide, high, yaw, radius)
        for wide, high in ((hx + grown, hy), (hx, hy + grown))
    ]
    return np.concatenate(found)


def _by_rectangles(
    px: Floats, py: Floats, wide: Floats, high: Floats, yaw: Floats, radius: float
) -> Floats:
    """Cover by rectangles of half sizes ``wide`` and ``high``, p being the circle's centre."""
    away = np.hypot(np.maximum(np.abs(px) - wide, 0.0), np.maximum(np.abs(py) - high, 0.0))
    near = away < radius
    px, py, wide, high, yaw = px[near], py[near], wide[near], high[near], yaw[near]
    cuts = [np.zeros(len(px)), np.full(len(px), math.tau)]
    for level, turn in (
        (wide - px, 0.0),
        (-wide - px, 0.0),
        (high - py, math.pi / 2),
        (-high - py, math.pi / 2),
    ):
        half = np.arccos(np.clip(level / radius, -1.0, 1.0))
        cuts += [np.remainder(turn - half, math.tau), np.remainder(turn + half, math.tau)]
    at = np.sort(np.column_stack(cuts), axis=1)
    begin, extent = at[:, :-1], np.diff(at, axis=1)
    middle = begin + extent / 2
    inside = (np.abs(px[:, None] + radius * np.cos(middle)) < wide[:, None]) & (
        np.abs(py[:, None] + radius * np.sin(middle)) < high[:, None]
    )
    inside &= extent > 0.0
    turned = np.remainder(begin + yaw[:, None], math.tau)
    return np.column_stack([turned[inside], extent[inside]])
