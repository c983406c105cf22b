"""A reading of thin rays all around, and what an earlier one tells of the places of a later one."""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning.base import Floats, Observation
from fuzzyq_bullet.planning.scan import ray_headings

Flags: TypeAlias = NDArray[np.bool_]

SAME = 0.03
"""Two surfaces no farther apart than this (m) are one, beside what the sensor may be wrong by."""
JOINED = 0.15
"""Neighbouring rays whose ends are no farther apart than this (m) meet one thing."""
NOTCH = 0.01
"""How deep a notch between two things is at least (m), beside what the sensor may be wrong by."""
BESIDE = 4
"""So many rays to either side are compared to tell where two things meet."""


class Reading(NamedTuple):
    """What one look around has told.

    Attributes:
        time: When (s).
        origin: From where (m), shape (2,).
        lengths: Length of each ray (m), shape (N,).
        points: Where each ends (m), shape (N, 2).
        met: Whether it met something, shape (N,).
    """

    time: float
    origin: Floats
    lengths: Floats
    points: Floats
    met: Flags


def read(observation: Observation) -> Reading:
    """Look around."""
    headings, turns = ray_headings(observation)
    lengths = observation.look(headings)
    origin = np.array(observation.position)
    points = origin + lengths[:, None] * np.column_stack([turns.real, turns.imag])
    met = lengths < observation.range + observation.radius
    return Reading(observation.time, origin, lengths, points, met)


def was_free(before: Reading, points: Floats, tolerance: float) -> Flags:
    """Return which points (m) an earlier reading has seen through: by both rays beside them."""
    dx, dy = (points - before.origin).T
    count = len(before.lengths)
    at = np.mod(np.arctan2(dy, dx), math.tau) / (math.tau / count)
    first = np.floor(at).astype(int) % count
    least = np.minimum(before.lengths[first], before.lengths[(first + 1) % count])
    return np.asarray(np.hypot(dx, dy) < least - tolerance)


def was_surface(before: Reading, points: Floats, tolerance: float) -> Flags:
    """Return which points (m) lie on what an earlier reading has met, near their bearing."""
    count = len(before.lengths)
    dx, dy = (points - before.origin).T
    at = np.floor(np.mod(np.arctan2(dy, dx), math.tau) / (math.tau / count)).astype(int)
    rays = (at[:, None] + np.arange(-BESIDE, BESIDE + 1)) % count
    along = np.where(
        _joined(before)[:, None], np.roll(before.points, -1, axis=0) - before.points, 0.0
    )[rays]
    rel = points[:, None] - before.points[rays]
    length = np.maximum((along**2).sum(axis=2), 1e-12)
    part = np.clip((rel * along).sum(axis=2) / length, 0.0, 1.0)
    off = ((rel - part[..., None] * along) ** 2).sum(axis=2)
    return np.asarray(np.where(before.met[rays], off, np.inf).min(axis=1) <= tolerance**2)


def _joined(reading: Reading) -> Flags:
    """Return which rays meet the same thing as the next ray."""
    step = np.roll(reading.points, -1, axis=0) - reading.points
    near = np.hypot(*step.T) <= JOINED
    return np.asarray(near & reading.met & np.roll(reading.met, -1))


def things(reading: Reading, tolerance: float) -> NDArray[np.intp]:
    """Return the number of the convex thing that each ray meets, −1 where it meets nothing.

    Seen from outside, something convex is nearest in one place and farther the farther aside. So
    where a ray is longer than those on both sides, two things meet.
    """
    lengths = reading.lengths
    beside = [
        np.min([np.roll(lengths, side * k) for k in range(1, BESIDE + 1)], axis=0)
        for side in (1, -1)
    ]
    around = [np.roll(lengths, k) for k in range(-BESIDE, BESIDE + 1) if k]
    corner = (lengths >= np.max(around, axis=0)) & (
        lengths - np.maximum(*beside) > NOTCH + tolerance - SAME
    )
    joined = _joined(reading) & ~corner
    begins = reading.met & ~np.roll(joined, 1)
    ids = np.cumsum(begins) - 1
    if reading.met[0] and not begins[0]:  # it goes on from the last ray to the first
        last = int(begins.sum()) - 1
        ids = np.where(ids < 0, max(last, 0), ids)
    return np.where(reading.met, ids, -1)
