"""What moves, and how: told from successive readings of thin rays all around.

A point that a ray meets now, in a place that an earlier reading has seen through, belongs to
something that moves. A point where there was a surface before stands. What was hidden before, or
out of range, cannot be told yet. Whatever is seen of something that moves is taken for a circle;
where its centre was in the latest readings tells how fast it goes.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning.base import Floats, Observation
from fuzzyq_bullet.planning.reading import (
    SAME,
    Flags,
    Reading,
    read,
    things,
    was_free,
    was_surface,
)
from fuzzyq_bullet.planning.tracks import BEND, Followed, Track, circle_of, explaining

LAGS = (0.05, 0.1, 0.15, 0.3, 0.6)
"""How old the readings are that a new one is compared with (s)."""
SURE_AFTER = 0.3
"""A surface that was there so long ago (s) stands."""
WHOLE = 0.3
"""What is joined to something that moves, and no farther from it than this (m), moves with it."""
MATCH = 0.35
"""A circle no farther than this (m) from where a track is expected is the same thing."""
COAST = 0.5
"""A track that is not seen any more is expected to go on for so long (s)."""
TOO_FAST = 1.2
"""What seems to be faster than this many times the closing speed was seen wrongly."""


@dataclass(frozen=True, slots=True)
class Traffic:
    """What one reading tells of what moves and what stands.

    Attributes:
        tracks: What moves.
        points: Points (m) of all that moves, or that cannot be told yet; shape (K, 2).
        velocities: The velocity (m/s) of what each belongs to, shape (K, 2); 0 where it cannot be
            told.
        speeds: How fast each may be at most (m/s), shape (K,).
        until: For how long each goes straight on (s), shape (K,); 0 where that cannot be told.
        moving: Points (m) of what moves for certain, shape (M, 2).
        standing: Points (m) of all else, shape (H, 2).
    """

    tracks: tuple[Track, ...]
    points: Floats
    velocities: Floats
    speeds: Floats
    until: Floats
    moving: Floats
    standing: Floats


class Tracker:
    """Tells what moves, for one episode."""

    def __init__(self) -> None:
        self._readings: deque[Reading] = deque()
        self._followed: list[Followed] = []

    def update(self, observation: Observation) -> Traffic:
        """Take one more reading, and return what it tells."""
        now = read(observation)
        tolerance = SAME + 2.0 * observation.uncertainty
        moves, age = self._told(now, tolerance)
        self._readings.append(now)
        while now.time - self._readings[1 if len(self._readings) > 1 else 0].time > LAGS[-1]:
            self._readings.popleft()

        fastest, speeds = observation.closing_speed, np.zeros(len(now.met))
        ids = things(now, tolerance)
        groups: list[NDArray[np.intp]] = []
        doubtful = np.zeros_like(moves)
        for thing in np.unique(ids[ids >= 0]).tolist():
            members = np.flatnonzero(ids == thing)
            if moves[members].sum() >= 2:
                core = now.points[members[moves[members]]]
                apart = np.linalg.norm(now.points[members][:, None] - core[None], axis=2)
                group = members[(apart.min(axis=1) <= WHOLE)]
                groups.append(group)
            elif (oldest := float(age[members].max())) < SURE_AFTER:
                doubtful[members] = True
                # It would be elsewhere by now if it were faster.
                speeds[members] = min(fastest, tolerance / oldest) if oldest else fastest
        followed = self._follow(now, groups, tolerance, TOO_FAST * fastest)
        velocities = np.zeros_like(now.points)
        until, moving = np.zeros(len(now.met)), np.zeros_like(doubtful)
        for group in groups:
            moving[group] = True
        stands = now.points[now.met & ~moving & ~doubtful]
        for group, one in zip(groups, followed, strict=True):
            speeds[group] = one.fastest(fastest)
            if one.velocity is not None:
                velocities[group] = one.velocity
                until[group] = one.until(stands, now.time)
        may = doubtful | moving
        return Traffic(
            tuple(one.track(stands, now.time) for one in self._followed),
            now.points[may],
            velocities[may],
            speeds[may],
            until[may],
            now.points[moving],
            stands,
        )

    def _told(self, now: Reading, tolerance: float) -> tuple[Flags, Floats]:
        """Return which rays meet something where nothing was, and for how long (s) it was there."""
        moves, age = np.zeros_like(now.met), np.zeros(len(now.met))
        points = now.points[now.met]
        for lag in LAGS:
            before = self._before(now.time - lag)
            if before is None or not len(points):
                continue
            moves[now.met] |= was_free(before, points, tolerance)
            was = was_surface(before, points, tolerance)
            age[now.met] = np.where(was, now.time - before.time, age[now.met])
        return moves, np.where(moves, 0.0, age)

    def _before(self, time: float) -> Reading | None:
        """Return the latest reading that is at least as old; None if there is none."""
        older = [one for one in self._readings if one.time <= time + 1e-6]
        return older[-1] if older else None

    def _follow(
        self,
        now: Reading,
        groups: Sequence[NDArray[np.intp]],
        tolerance: float,
        fastest: float,
    ) -> list[Followed]:
        """Take note of what moves, and return it for each of the groups of rays that meet it."""
        left, found = list(self._followed), []
        for group in groups:
            points = now.points[group]
            centre, radius, fits = circle_of(points, now.origin, tolerance)
            behind = [] if fits else explaining(points, left, now.time, tolerance)
            if behind:  # two that pass each other, and are seen as one: both go on
                for one in behind:
                    one.seen.append((now.time, *one.expected(now.time)))
                    left.remove(one)
                found.append(max(behind, key=lambda one: one.fastest(math.inf)))
                continue
            near = [(math.dist(one.expected(now.time), centre), k) for k, one in enumerate(left)]
            apart, k = min(near, default=(math.inf, -1))
            if apart <= MATCH:
                followed = left.pop(k)
            else:
                followed = Followed(radius)
                self._followed.append(followed)
            followed.see(now.time, centre, radius, BEND + tolerance - SAME, fastest)
            found.append(followed)
        self._followed = [one for one in self._followed if now.time - one.seen[-1][0] <= COAST]
        return found
