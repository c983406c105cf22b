"""A scan: how far the robot could move in every direction, and what would stop it."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning.base import MOST_HEADINGS, USUAL_RANGE, Floats, Observation

Point: TypeAlias = tuple[float, float]
_T = TypeVar("_T", bound=np.generic)

RAYS = 120
"""Thin rays of one scan: 3° apart, 6 cm at their far ends."""
HEADINGS = 120
"""Headings whose free distance is computed first: 3° apart."""
MANY_RAYS = 720
"""Thin rays where the robot sees farther than 5·S_p: 0.5° apart, like those of a usual lidar. With
fewer of them what lies between two of them looks like a gap from afar."""
FINER = (1.0 / 3.0, 1.0 / 9.0)
"""Where the free distance is longest or changes much, headings are added closer together, in two
turns: by these parts of the first spacing."""
JUMP = 0.3
"""Where the free distance changes by more than this from one heading to the next (m), something
ends, and what is behind it is hidden; where by less, one boundary goes on. So many times as much
for a larger robot."""

CLEAR_MARGIN = 0.1
"""A ray must reach so much farther (m) than a point to show that nothing is there any more."""
TOUCH = 0.02
"""Whatever is no farther than this from the disc stops it (m)."""
CLOSE = 0.005
"""A gap narrower than the disc by more than this is a corner (m)."""


@cache
def _around(count: int) -> tuple[Floats, NDArray[np.complex128]]:
    """Return so many headings (rad) all around, and the same as complex numbers of length 1.

    So a difference of two is one product.
    """
    headings: Floats = np.arange(count, dtype=np.float64) * (math.tau / count)
    turns: NDArray[np.complex128] = np.exp(1j * headings)
    return headings, turns


def ray_headings(observation: Observation) -> tuple[list[float], NDArray[np.complex128]]:
    """Return the world headings (rad) of a scan's thin rays, as a list and as complex numbers.

    A caller that looks along these headings shares the rays with a scan at the same instant.
    """
    headings, turns = _around(MANY_RAYS if observation.sees_far else RAYS)
    return headings.tolist(), turns


def _headings(farther: float) -> int:
    """Return how many headings are as close at their far ends as usual, the range so many times."""
    return min(math.ceil(HEADINGS * farther), MOST_HEADINGS)


@dataclass(frozen=True, slots=True)
class Scan:
    """What was seen from one place.

    Attributes:
        range: How far the robot sees (m).
        headings: World headings (rad) in [0, 2π), increasing.
        lengths: Free distance (m) of the robot's disc along each.
        gaps: Indices of the headings that lead into a gap. Along them more is free than beside
            them, and nothing stops the disc on both sides at once, as in a corner.
        boundary: Where the disc's centre would be stopped: lines (m), shape (W, 2, 2), both ends
            of each, x and y.
        hits: Where its rays met something (m), shape (H, 2). Rays get through gaps that the disc
            does not: they see the far side of a pocket before the robot is in it.
        radius: Radius of the disc (m).
        size: How many times as large as usual the robot is.
    """

    range: float
    headings: list[float]
    lengths: list[float]
    gaps: list[int]
    boundary: Floats
    hits: Floats
    radius: float
    size: float = 1.0

    def sees_through(self, here: Point, points: Floats, radius: float) -> NDArray[np.bool_]:
        """Return which points (m), shape (K, 2), the scan sees to be free, by ``CLEAR_MARGIN``.

        Args:
            here: Where the scan was made (m).
            points: The points.
            radius: 0 if a thin ray must pass a point; otherwise the robot's disc must.
        """
        rel = points - np.array(here)
        far, bearing = np.hypot(*rel.T), np.mod(np.arctan2(rel[:, 1], rel[:, 0]), math.tau)
        if radius > 0.0:
            at = np.searchsorted(self.headings, bearing)
            lengths = np.array(self.lengths)
            free = np.minimum(lengths[at - 1], lengths[at % len(lengths)])
        else:
            met = self.hits - np.array(here)
            reach, theirs = np.hypot(*met.T), np.arctan2(met[:, 1], met[:, 0])
            off = np.abs(np.remainder(bearing[:, None] - theirs + math.pi, math.tau) - math.pi)
            near = np.where(off <= 1.5 * math.tau / RAYS, reach, self.range)
            free = near.min(axis=1, initial=self.range)
        return np.asarray(far < free - CLEAR_MARGIN)

    def without(self, points: Floats) -> Scan:
        """Return the scan without its boundary and hits near points (m), shape (M, 2)."""
        if not len(points):
            return self

        def away(some: Floats, far: float) -> NDArray[np.bool_]:
            apart = np.linalg.norm(some[:, None] - points, axis=2)
            return np.asarray(apart.min(axis=1, initial=np.inf) > far)

        middles = self.boundary.reshape(-1, 2, 2).mean(axis=1)
        return replace(
            self,
            boundary=self.boundary[away(middles, self.radius + CLEAR_MARGIN)],
            hits=self.hits[away(self.hits, CLEAR_MARGIN)],
        )

    def free(self, heading: float) -> float:
        """Return the free distance (m) along a heading: the lesser of its two neighbours."""
        at = bisect_left(self.headings, heading % math.tau)
        return min(self.lengths[at - 1], self.lengths[at % len(self.lengths)])


def scan_360(observation: Observation) -> Scan:
    """Cast thin rays in all directions, and compute how far the robot's disc could move.

    A point that a ray has hit stops the disc once it is half a detection line's width away. Nothing
    that the robot stands beside already may stop it, so where something is nearer than that, its
    distance counts instead of the half width.
    """
    farther = observation.range / (USUAL_RANGE * observation.unit)
    far = observation.sees_far
    first_headings, first_turns = _around(_headings(farther) if far else HEADINGS)
    rays, turns = ray_headings(observation)
    distance = observation.look(rays)
    met = distance < observation.range + observation.radius
    hits, distance = turns[met] * distance[met], distance[met]
    wide_squared = min(observation.radius, distance.min(initial=np.inf) - 1e-3) ** 2

    def lengths_along(turns: NDArray[np.complex128]) -> Floats:
        seen = hits * turns
        depth = wide_squared - seen.imag**2
        travel = np.where(
            (seen.real > 0.0) & (depth > 0.0), seen.real - np.sqrt(np.maximum(depth, 0.0)), np.inf
        )
        least: Floats = travel.min(axis=1, initial=observation.range)
        return np.maximum(least, 0.0)

    jump = JUMP * observation.size
    headings, lengths = first_headings, lengths_along(first_turns.conj()[:, None])
    step = math.tau / len(headings)
    for part in FINER:
        edge = np.abs(lengths - _following(lengths)) > jump
        worth = np.flatnonzero(_peaks(lengths) | edge | _preceding(edge))
        finer = (headings[worth, None] + part * step * np.array([-2, -1, 1, 2])).ravel() % math.tau
        headings, first = np.unique(np.concatenate([headings, finer]).round(6), return_index=True)
        lengths = np.concatenate([lengths, lengths_along(np.exp(-1j * finer)[:, None])])[first]

    directions = np.column_stack([np.cos(headings), np.sin(headings)])
    ends = np.array(observation.position) + lengths[:, None] * directions
    following = _following(np.arange(lengths.size))
    stopped = lengths < observation.range
    joined = stopped & stopped[following] & (np.abs(lengths - lengths[following]) <= jump)
    boundary = np.stack([ends[joined], ends[following[joined]]], axis=1)
    return Scan(
        observation.range,
        headings.tolist(),
        lengths.tolist(),
        _gaps(hits, headings, lengths, observation.radius),
        boundary,
        np.array(observation.position) + np.column_stack([hits.real, hits.imag]),
        observation.radius,
        observation.size,
    )


def _gaps(hits: NDArray[Any], headings: NDArray[Any], lengths: Floats, radius: float) -> list[int]:
    """Return the indices of the peaks at whose ends the disc is not stopped on both sides.

    Args:
        hits: What the rays hit, seen from the robot (m), as complex numbers.
        headings: World headings (rad).
        lengths: Free distance (m) along each.
        radius: Radius of the disc (m).
    """
    gaps = []
    for k in np.flatnonzero(_peaks(lengths)).tolist():
        around = hits * np.exp(-1j * headings[k]) - lengths[k]
        touched = around[np.abs(around) < radius + TOUCH]
        left, right = touched[touched.imag > 0.0], touched[touched.imag <= 0.0]
        between = np.abs(left[:, None] - right).min(initial=np.inf)
        if between > 2.0 * radius - CLOSE:
            gaps.append(k)
    return gaps


def _peaks(lengths: Floats) -> NDArray[np.bool_]:
    return (lengths > _preceding(lengths)) & (lengths >= _following(lengths))


def _following(around: NDArray[_T]) -> NDArray[_T]:
    """Return for each heading the value of the next one."""
    return np.roll(around, -1)


def _preceding(around: NDArray[_T]) -> NDArray[_T]:
    """Return for each heading the value of the one before."""
    return np.roll(around, 1)
