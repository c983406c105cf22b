"""A scan of thin rays all around, and what an earlier scan says about points of a later one."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning.base import Flags, Floats, Observation
from fuzzyq_bullet.planning.scan import ray_headings

SURFACE_TOLERANCE = 0.03
"""Two points no farther apart than this (m) are on the same surface, apart from sensor noise."""
JOIN_DISTANCE = 0.15
"""Neighbouring rays whose ends are no farther apart than this (m) meet the same obstacle."""
NOTCH_DEPTH = 0.01
"""Least depth (m) of a notch that separates two obstacles, apart from sensor noise."""
NEIGHBOURS = 4
"""Number of rays on either side that are compared with a ray."""


class LidarScan(NamedTuple):
    """One scan of N thin rays.

    Attributes:
        time: When it was made (s).
        origin: From where (m), shape (2,).
        lengths: Length of each ray (m), shape (N,).
        points: Where each ray ends (m), shape (N, 2).
        met: Whether each ray met an obstacle, shape (N,).
    """

    time: float
    origin: Floats
    lengths: Floats
    points: Floats
    met: Flags


def lidar_scan(observation: Observation) -> LidarScan:
    """Scan all around."""
    headings, turns = ray_headings(observation)
    lengths = observation.look(headings)
    origin = np.array(observation.position)
    points = origin + lengths[:, None] * np.column_stack([turns.real, turns.imag])
    met = lengths < observation.range + observation.radius
    return LidarScan(observation.time, origin, lengths, points, met)


def in_free_space(earlier: LidarScan, points: Floats, tolerance: float) -> Flags:
    """Return which points (m), shape (K, 2), lie where an earlier scan saw free space.

    A point does if it is nearer, by more than the tolerance (m), than the ends of both rays
    beside it, and of all rays that may be beside it if the sensor is wrong.
    """
    ray, distance = _ray_before(earlier, points)
    count = len(earlier.lengths)
    off = (tolerance - SURFACE_TOLERANCE) / np.maximum(distance, 1e-6)  # an angle (rad)
    more = np.minimum(np.ceil(off / (math.tau / count) - 1e-9), count // 4)  # to 90° either way
    offsets = np.arange(-int(more.max(initial=0.0)), int(more.max(initial=0.0)) + 2)
    beside = (offsets >= -more[:, None]) & (offsets <= more[:, None] + 1)
    lengths = earlier.lengths[(ray[:, None] + offsets) % count]
    nearest = np.where(beside, lengths, math.inf).min(axis=1)
    return np.asarray(distance < nearest - tolerance)


def on_surface(earlier: LidarScan, points: Floats, tolerance: float) -> Flags:
    """Return which points (m), shape (K, 2), lie on a surface that an earlier scan saw.

    A surface is the polyline through the ends of joined rays. A point is on it if its distance to
    one of the segments near its bearing is no more than the tolerance (m).
    """
    ray, _ = _ray_before(earlier, points)
    rays = (ray[:, None] + np.arange(-NEIGHBOURS, NEIGHBOURS + 1)) % len(earlier.lengths)
    segments = np.where(_joined(earlier)[:, None], _to_next(earlier), 0.0)[rays]
    from_start = points[:, None] - earlier.points[rays]
    length_squared = np.maximum((segments**2).sum(axis=2), 1e-12)
    part = np.clip((from_start * segments).sum(axis=2) / length_squared, 0.0, 1.0)
    off_squared = ((from_start - part[..., None] * segments) ** 2).sum(axis=2)
    nearest = np.where(earlier.met[rays], off_squared, np.inf).min(axis=1)
    return np.asarray(nearest <= tolerance**2)


def segment(scan: LidarScan, tolerance: float) -> NDArray[np.intp]:
    """Return the number of the obstacle that each ray meets, shape (N,); −1 if it meets none.

    The ends of neighbouring rays belong to the same obstacle if they are near each other and there
    is no notch between them: from outside, the distance to a convex obstacle has one minimum, so
    where a ray is longer than the rays on both sides, two obstacles meet.

    Args:
        scan: The scan.
        tolerance: ``SURFACE_TOLERANCE`` and what the sensor may be wrong by (m).
    """
    joined = _joined(scan) & ~_notches(scan.lengths, NOTCH_DEPTH + tolerance - SURFACE_TOLERANCE)
    begins = scan.met & ~np.roll(joined, 1)
    ids = np.cumsum(begins) - 1
    if scan.met[0] and not begins[0]:  # the last obstacle goes on at the first ray
        last = int(begins.sum()) - 1
        ids = np.where(ids < 0, max(last, 0), ids)
    return np.where(scan.met, ids, -1)


def _ray_before(scan: LidarScan, points: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Return the last ray clockwise of each point, and the distance to the point (m)."""
    dx, dy = (points - scan.origin).T
    count = len(scan.lengths)
    at = np.mod(np.arctan2(dy, dx), math.tau) / (math.tau / count)
    return np.floor(at).astype(np.intp) % count, np.hypot(dx, dy)


def _to_next(scan: LidarScan) -> Floats:
    """Return the vectors (m) from the end of each ray to the end of the next, shape (N, 2)."""
    return np.roll(scan.points, -1, axis=0) - scan.points


def _joined(scan: LidarScan) -> Flags:
    """Return which rays end near the end of the next ray, and both meet something."""
    near = np.hypot(*_to_next(scan).T) <= JOIN_DISTANCE
    return np.asarray(near & scan.met & np.roll(scan.met, -1))


def _notches(lengths: Floats, depth: float) -> Flags:
    """Return which rays are longer than their neighbours, by a depth (m) on either side."""
    sides = [
        np.min([np.roll(lengths, side * k) for k in range(1, NEIGHBOURS + 1)], axis=0)
        for side in (1, -1)
    ]
    around = [np.roll(lengths, k) for k in range(-NEIGHBOURS, NEIGHBOURS + 1) if k]
    longest = lengths >= np.max(around, axis=0)
    return np.asarray(longest & (lengths - np.maximum(*sides) > depth))
