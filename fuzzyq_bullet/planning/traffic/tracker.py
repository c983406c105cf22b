"""Detection and tracking of moving obstacles (DATMO) from successive scans of thin rays.

A point of the present scan *moves* if an earlier scan saw free space there. It *stands* if an
earlier scan saw a surface there. A point that was hidden or out of range before is *uncertain*.
The points of a moving obstacle are fitted by a circle, and its latest centres give its velocity.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning.base import Flags, Floats, Observation
from fuzzyq_bullet.planning.traffic.circle_fit import Circle, fit_circle
from fuzzyq_bullet.planning.traffic.lidar_scan import (
    SURFACE_TOLERANCE,
    LidarScan,
    in_free_space,
    lidar_scan,
    on_surface,
    segment,
)
from fuzzyq_bullet.planning.traffic.track import (
    LINE_TOLERANCE,
    Track,
    TrackHistory,
    tracks_that_explain,
)

AGES = (0.05, 0.1, 0.15, 0.3, 0.6)
"""Ages (s) of the earlier scans that the present scan is compared with."""
STANDS_AFTER = 0.3
"""A surface that has been there for so long (s) stands."""
FEWEST_MOVING = 2
"""An obstacle moves if so many of its points move."""
JOINED_TO = 0.3
"""Points of a moving obstacle that are no farther than this (m) from a moving point move too."""
ASSOCIATION_GATE = 0.35
"""A circle belongs to a track if it is no farther than this (m) from its predicted centre."""
COAST_TIME = 0.5
"""A track that is not seen any more is kept for so long (s)."""
SPEED_LIMIT = 1.2
"""A fitted speed of more than so many times the closing speed is a mistake."""


@dataclass(frozen=True, slots=True)
class Traffic:
    """What moves and what stands, by one scan.

    Attributes:
        tracks: The moving obstacles.
        points: Points (m) of all that moves or is uncertain, shape (K, 2).
        velocities: Velocity (m/s) of the obstacle that each point belongs to, shape (K, 2); 0 if
            it is not known.
        max_speeds: How fast each point may be at most (m/s), shape (K,).
        straight_for: For how long each point goes straight on (s), shape (K,); 0 if that is not
            known.
        moving: Points (m) of what moves for certain, shape (M, 2).
        standing: Points (m) of what stands, shape (H, 2).
    """

    tracks: tuple[Track, ...]
    points: Floats
    velocities: Floats
    max_speeds: Floats
    straight_for: Floats
    moving: Floats
    standing: Floats


class _Detection(NamedTuple):
    """What moves in one scan of N rays, before anything is associated with tracks.

    Attributes:
        groups: The rays that meet each moving obstacle.
        moving: Which rays meet something that moves, shape (N,).
        uncertain: Which rays meet something of which that is not known yet, shape (N,).
        max_speeds: How fast each point that is uncertain may be (m/s), shape (N,).
    """

    groups: list[NDArray[np.intp]]
    moving: Flags
    uncertain: Flags
    max_speeds: Floats


class Tracker:
    """Detects and tracks moving obstacles during one episode."""

    def __init__(self) -> None:
        self._scans: deque[LidarScan] = deque()
        self._histories: list[TrackHistory] = []

    def update(self, observation: Observation) -> Traffic:
        """Scan all around, and return what moves."""
        scan, limit = lidar_scan(observation), observation.closing_speed
        tolerance = SURFACE_TOLERANCE + 2.0 * observation.uncertainty
        moves, age = self._compare(scan, tolerance)
        self._remember(scan)
        found = _detect(scan, moves, age, tolerance, limit)
        histories = self._associate(scan, found.groups, tolerance, SPEED_LIMIT * limit)
        return self._traffic(scan, found, histories, limit)

    def _compare(self, scan: LidarScan, tolerance: float) -> tuple[Flags, Floats]:
        """Return which points move, shape (N,), and for how long each was a surface (s), (N,)."""
        moves, age = np.zeros_like(scan.met), np.zeros(len(scan.met))
        points = scan.points[scan.met]
        stood = np.ones(len(points), dtype=np.bool_)  # in all scans since: what turns comes back
        for compared in AGES:
            earlier = self._scan_before(scan.time - compared)
            if earlier is None or not len(points):
                continue
            moves[scan.met] |= in_free_space(earlier, points, tolerance)
            stood &= on_surface(earlier, points, tolerance)
            age[scan.met] = np.where(stood, scan.time - earlier.time, age[scan.met])
        return moves, np.where(moves, 0.0, age)

    def _scan_before(self, time: float) -> LidarScan | None:
        """Return the latest scan that is at least as old; None if there is none."""
        older = [one for one in self._scans if one.time <= time + 1e-6]
        return older[-1] if older else None

    def _remember(self, scan: LidarScan) -> None:
        """Keep a scan, and forget those that are too old to be compared with."""
        self._scans.append(scan)
        while len(self._scans) > 1 and scan.time - self._scans[1].time > AGES[-1]:
            self._scans.popleft()

    def _associate(
        self,
        scan: LidarScan,
        groups: Sequence[NDArray[np.intp]],
        tolerance: float,
        limit: float,
    ) -> list[TrackHistory]:
        """Return the track of each group of rays, updated or new: nearest neighbours in a gate."""
        left, found = list(self._histories), []
        for group in groups:
            points = scan.points[group]
            circle = fit_circle(points, scan.origin, tolerance)
            passing = [] if circle.fits else tracks_that_explain(points, left, scan.time, tolerance)
            if passing:
                for one in passing:
                    one.coast(scan.time)
                    left.remove(one)
                found.append(max(passing, key=lambda one: one.max_speed(math.inf)))
                continue
            history = _nearest(left, circle, scan.time)
            if history is None:
                history = TrackHistory(circle.radius)
                self._histories.append(history)
            else:
                left = [one for one in left if one is not history]
            history.add(scan.time, circle, LINE_TOLERANCE + tolerance - SURFACE_TOLERANCE, limit)
            found.append(history)
        self._histories = [
            one for one in self._histories if scan.time - one.last_seen <= COAST_TIME
        ]
        return found

    def _traffic(
        self, scan: LidarScan, found: _Detection, histories: list[TrackHistory], limit: float
    ) -> Traffic:
        """Return what each point of a scan may do, by the track that it belongs to."""
        velocities, straight_for = np.zeros_like(scan.points), np.zeros(len(scan.met))
        max_speeds = found.max_speeds
        may_move = found.uncertain | found.moving
        standing = scan.points[scan.met & ~may_move]
        for group, history in zip(found.groups, histories, strict=True):
            max_speeds[group] = history.max_speed(limit)
            if history.velocity is not None:
                velocities[group] = history.velocity
                straight_for[group] = history.straight_for(standing, scan.time)
        return Traffic(
            tracks=tuple(one.state(standing, scan.time) for one in self._histories),
            points=scan.points[may_move],
            velocities=velocities[may_move],
            max_speeds=max_speeds[may_move],
            straight_for=straight_for[may_move],
            moving=scan.points[found.moving],
            standing=standing,
        )


def _detect(
    scan: LidarScan, moves: Flags, age: Floats, tolerance: float, limit: float
) -> _Detection:
    """Return which obstacles of a scan move, and which are uncertain.

    Args:
        scan: The scan.
        moves: Which points are where free space was, shape (N,).
        age: For how long each point was a surface (s), shape (N,).
        tolerance: How far a surface may seem to move though it stands (m).
        limit: How fast what moves may be at most (m/s).
    """
    groups: list[NDArray[np.intp]] = []
    moving, uncertain = np.zeros_like(moves), np.zeros_like(moves)
    max_speeds = np.zeros(len(moves))
    ids = segment(scan, tolerance)
    for number in np.unique(ids[ids >= 0]).tolist():
        rays = np.flatnonzero(ids == number)
        if moves[rays].sum() >= FEWEST_MOVING:
            core = scan.points[rays[moves[rays]]]
            apart = np.linalg.norm(scan.points[rays][:, None] - core[None], axis=2)
            group = rays[apart.min(axis=1) <= JOINED_TO]
            groups.append(group)
            moving[group] = True
        elif float(age[rays].max()) < STANDS_AFTER:
            uncertain[rays] = True
            max_speeds[rays] = limit  # it may have turned round a moment ago
    return _Detection(groups, moving, uncertain, max_speeds)


def _nearest(histories: list[TrackHistory], circle: Circle, time: float) -> TrackHistory | None:
    """Return the track that predicts a circle best; None if none does within the gate."""
    near = [(math.dist(one.predict(time), circle.centre), k) for k, one in enumerate(histories)]
    apart, k = min(near, default=(math.inf, -1))
    return histories[k] if apart <= ASSOCIATION_GATE else None
