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
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning.base import Floats, Observation
from fuzzyq_bullet.planning.scan import ray_headings

Flags: TypeAlias = NDArray[np.bool_]

LAGS = (0.05, 0.1, 0.15, 0.3, 0.6)
"""How old the readings are that a new one is compared with (s)."""
SURE_AFTER = 0.3
"""A surface that was there so long ago (s) stands."""
SAME = 0.03
"""Two surfaces no farther apart than this (m) are one, beside what the sensor may be wrong by."""
JOINED = 0.15
"""Neighbouring rays whose ends are no farther apart than this (m) meet one thing."""
NOTCH = 0.01
"""How deep a notch between two things is at least (m), beside what the sensor may be wrong by."""
BESIDE = 4
"""So many rays to either side are compared to tell where two things meet."""
WHOLE = 0.3
"""What is joined to something that moves, and no farther from it than this (m), moves with it."""
LARGEST = 0.8
"""A circle larger than this (m) does not describe what moves."""
WINDOW = 0.5
"""The velocity is that of the latest so many seconds."""
MATCH = 0.35
"""A circle no farther than this (m) from where a track is expected is the same thing."""
COAST = 0.5
"""A track that is not seen any more is expected to go on for so long (s)."""
FASTER = 0.05
"""What moves may become faster than it was seen to be by this (m/s)."""
GROWN = 0.04
"""A circle that has grown or shrunk by more than this (m) since the last reading is another."""
TOO_FAST = 1.2
"""What seems to be faster than this many times the closing speed was seen wrongly."""
UNEXPLAINED = 0.15
"""Points on the edge of two that pass each other may be off both: no more than this part."""
LEAST = 3
"""Places of its centre that a velocity is told from, at least."""
BEND = 0.015
"""Its centres lie no farther than this (m) off a straight way, beside what the sensor may be wrong
by; else it has changed its direction."""


class Track(NamedTuple):
    """Something that moves.

    Attributes:
        centre: Centre of the circle that it is taken for (m).
        radius: Radius of that circle (m).
        velocity: Its velocity (m/s); None while it cannot be told yet.
        until: When it meets something that stands, and turns (s from now); infinite if not soon.
    """

    centre: tuple[float, float]
    radius: float
    velocity: tuple[float, float] | None
    until: float = math.inf

    @property
    def speed(self) -> float | None:
        """Its speed (m/s); None while it cannot be told yet."""
        return None if self.velocity is None else math.hypot(*self.velocity)


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


class _Reading(NamedTuple):
    time: float
    origin: Floats
    lengths: Floats
    points: Floats
    met: Flags


@dataclass(slots=True)
class _Followed:
    radius: float
    seen: deque[tuple[float, float, float]] = field(default_factory=deque)
    velocity: tuple[float, float] | None = None

    def expected(self, time: float) -> tuple[float, float]:
        then, x, y = self.seen[-1]
        vx, vy = self.velocity or (0.0, 0.0)
        return x + vx * (time - then), y + vy * (time - then)

    def track(self, standing: Floats, time: float) -> Track:
        """Return what is told of it at a time (s), among points (m) that stand."""
        return Track(self.expected(time), self.radius, self.velocity, self.until(standing, time))

    def fastest(self, limit: float) -> float:
        """Return how fast (m/s) it may come, whichever way it turns: no faster than the limit."""
        if self.velocity is None:
            return limit
        return min(limit, math.hypot(*self.velocity) + FASTER)

    def until(self, standing: Floats, time: float) -> float:
        """Return when (s from now) it meets something that stands, points (m) of shape (H, 2)."""
        if self.velocity is None or not len(standing):
            return math.inf
        speed = max(math.hypot(*self.velocity), 1e-6)
        ahead = np.array(self.velocity) / speed
        rel = standing - self.expected(time)
        along, across = rel @ ahead, rel @ np.array([-ahead[1], ahead[0]])
        near = (np.abs(across) < self.radius) & (along > 0.0)
        room = along[near] - np.sqrt(self.radius**2 - across[near] ** 2)
        return max(0.0, float(room.min(initial=math.inf))) / speed

    def see(
        self,
        time: float,
        centre: tuple[float, float],
        radius: float,
        bend: float,
        fastest: float,
    ) -> None:
        """Add where its centre (m) is, and tell its velocity from the latest straight piece.

        Args:
            time: When (s).
            centre: Its centre (m).
            radius: Its radius (m).
            bend: How far off a straight way its centres may be (m).
            fastest: How fast it may be (m/s).
        """
        if abs(radius - self.radius) > GROWN:
            self.seen.clear()  # more of it is seen than before: its centre was not known
        self.radius = radius
        self.seen.append((time, *centre))
        while time - self.seen[0][0] > WINDOW:
            self.seen.popleft()
        self.velocity = None
        while len(self.seen) >= LEAST:
            t, x, y = np.array(self.seen).T
            t = t - t.mean()
            spread = float(t @ t)
            vx, vy = float(t @ x) / spread, float(t @ y) / spread
            off = np.hypot(x - x.mean() - vx * t, y - y.mean() - vy * t).max()
            if off <= bend or len(self.seen) == LEAST:
                if math.hypot(vx, vy) <= fastest:
                    self.velocity = vx, vy
                return
            self.seen.popleft()


class Tracker:
    """Tells what moves, for one episode."""

    def __init__(self) -> None:
        self._readings: deque[_Reading] = deque()
        self._followed: list[_Followed] = []

    def update(self, observation: Observation) -> Traffic:
        """Take one more reading, and return what it tells."""
        now = _read(observation)
        tolerance = SAME + 2.0 * observation.uncertainty
        moves, age = self._told(now, tolerance)
        self._readings.append(now)
        while now.time - self._readings[1 if len(self._readings) > 1 else 0].time > LAGS[-1]:
            self._readings.popleft()

        fastest, speeds = observation.closing_speed, np.zeros(len(now.met))
        ids = _things(now, tolerance)
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

    def _told(self, now: _Reading, tolerance: float) -> tuple[Flags, Floats]:
        """Return which rays meet something where nothing was, and for how long (s) it was there."""
        moves, age = np.zeros_like(now.met), np.zeros(len(now.met))
        points = now.points[now.met]
        for lag in LAGS:
            before = self._before(now.time - lag)
            if before is None or not len(points):
                continue
            moves[now.met] |= _was_free(before, points, tolerance)
            was = _was_surface(before, points, tolerance)
            age[now.met] = np.where(was, now.time - before.time, age[now.met])
        return moves, np.where(moves, 0.0, age)

    def _before(self, time: float) -> _Reading | None:
        """Return the latest reading that is at least as old; None if there is none."""
        older = [one for one in self._readings if one.time <= time + 1e-6]
        return older[-1] if older else None

    def _follow(
        self,
        now: _Reading,
        groups: Sequence[NDArray[np.intp]],
        tolerance: float,
        fastest: float,
    ) -> list[_Followed]:
        """Take note of what moves, and return it for each of the groups of rays that meet it."""
        left, found = list(self._followed), []
        for group in groups:
            points = now.points[group]
            centre, radius, fits = circle_of(points, now.origin, tolerance)
            behind = [] if fits else _explaining(points, left, now.time, tolerance)
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
                followed = _Followed(radius)
                self._followed.append(followed)
            followed.see(now.time, centre, radius, BEND + tolerance - SAME, fastest)
            found.append(followed)
        self._followed = [one for one in self._followed if now.time - one.seen[-1][0] <= COAST]
        return found


def _explaining(
    points: Floats, known: Sequence[_Followed], time: float, tolerance: float
) -> list[_Followed]:
    """Return the known ones on whose circles, where they are expected, the points (m) lie.

    None if that leaves points over.
    """
    found, left = [], np.ones(len(points), dtype=bool)
    for one in known:
        if one.velocity is None:
            continue
        off = np.abs(np.hypot(*(points - one.expected(time)).T) - one.radius)
        on = off <= tolerance + BEND
        if on.sum() >= 2:
            found.append(one)
            left &= ~on
    return found if left.mean() <= UNEXPLAINED else []


def circle_of(
    points: Floats, origin: Floats, tolerance: float
) -> tuple[tuple[float, float], float, bool]:
    """Return centre (m) and radius (m) of the circle that fits points, shape (K, 2), best.

    Where none fits, as on something straight, it is the circle around them, and the third is False
    (Kåsa's fit, which needs no first guess, is exact for points without noise).

    Args:
        points: What is seen of something (m).
        origin: From where (m): the centre lies behind the points.
        tolerance: How far the points may be off the circle (m).
    """
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2.0
    around = float(np.linalg.norm(points - middle, axis=1).max())
    if len(points) >= 4:
        local = points - middle
        table = np.column_stack([2.0 * local, np.ones(len(local))])
        (a, b, c), *_ = np.linalg.lstsq(table, (local**2).sum(axis=1), rcond=None)
        radius = math.sqrt(max(0.0, c + a * a + b * b))
        centre = middle + np.array([a, b])
        off = np.abs(np.linalg.norm(points - centre, axis=1) - radius).max()
        behind = np.linalg.norm(centre - origin) > np.linalg.norm(points - origin, axis=1).min()
        if off <= tolerance and radius <= LARGEST and behind:
            return (float(centre[0]), float(centre[1])), radius, True
    return (float(middle[0]), float(middle[1])), around, False


def _read(observation: Observation) -> _Reading:
    headings, turns = ray_headings(observation)
    lengths = observation.look(headings)
    origin = np.array(observation.position)
    points = origin + lengths[:, None] * np.column_stack([turns.real, turns.imag])
    met = lengths < observation.range + observation.radius
    return _Reading(observation.time, origin, lengths, points, met)


def _was_free(before: _Reading, points: Floats, tolerance: float) -> Flags:
    """Return which points (m) an earlier reading has seen through: by both rays beside them."""
    dx, dy = (points - before.origin).T
    count = len(before.lengths)
    at = np.mod(np.arctan2(dy, dx), math.tau) / (math.tau / count)
    first = np.floor(at).astype(int) % count
    least = np.minimum(before.lengths[first], before.lengths[(first + 1) % count])
    return np.asarray(np.hypot(dx, dy) < least - tolerance)


def _was_surface(before: _Reading, points: Floats, tolerance: float) -> Flags:
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


def _joined(reading: _Reading) -> Flags:
    """Return which rays meet the same thing as the next ray."""
    step = np.roll(reading.points, -1, axis=0) - reading.points
    near = np.hypot(*step.T) <= JOINED
    return np.asarray(near & reading.met & np.roll(reading.met, -1))


def _things(reading: _Reading, tolerance: float) -> NDArray[np.intp]:
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
