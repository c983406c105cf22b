"""Ways out on the map: where they began and ended, and what the robot goes round meanwhile."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.video.map.footprints import Floats, clipped

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.shapes import Shape

_TOUCHING = 0.02
"""Obstacles no farther apart than about this are one (m)."""
_LOYAL = 0.1
"""What the robot goes round changes for something nearer by more than this (m)."""
_APART = 0.05
"""Marks of one kind no farther apart are one (m)."""
_SIDES = 4


class Mark(NamedTuple):
    """A place to be marked from a decision on.

    Attributes:
        decision: Index of the decision.
        point: Where it was taken (m).
        begins: Whether a way out began there; else the routine part went on again.
    """

    decision: int
    point: tuple[float, float]
    begins: bool


class Avoidance:
    """The ways out of one run.

    A group is what the robot goes round: obstacles that touch one another, by the first of them, or
    a wall, by −1 to −4.

    Attributes:
        marks: In the order of their decisions.
    """

    def __init__(self, trajectory: Trajectory) -> None:
        scenario, decisions = trajectory.scenario, trajectory.decisions
        self._obstacles = scenario.standing
        self._arena = scenario.arena.bounds if scenario.arena.walls else None
        self._field = Field.of(self._obstacles)
        self._centres = np.array([o.position for o in self._obstacles]).reshape(-1, 2)
        self._extents = np.array([o.extent() for o in self._obstacles])
        self._group: dict[int, int] = {}
        self._members: dict[int, list[int]] = {}
        self.marks: list[Mark] = []
        self._avoided: dict[int, int] = {}

        held, before = None, "routine"
        for k, (tick, number) in enumerate(zip(decisions.tick, decisions.mode, strict=True)):
            mode = MODES[int(number)]
            x, y = trajectory.ticks.position[int(tick)].tolist()
            # A planner of another paper may follow a boundary without having broken out.
            if mode == "breakout" != before or (mode == "following" and before == "routine"):
                self._mark(Mark(k, (x, y), begins=True))
            if before != "routine" and mode == "routine":
                self._mark(Mark(k, (x, y), begins=False))
            held = None if mode == "routine" else self._nearest((x, y), held)
            if held is not None:
                self._avoided[k] = held
            before = mode

    def _mark(self, new: Mark) -> None:
        """Keep a mark, unless it would cover one of its kind."""
        alike = (old.point for old in self.marks if old.begins == new.begins)
        if all(math.dist(point, new.point) > _APART for point in alike):
            self.marks.append(new)

    def group_at(self, decision: int) -> int | None:
        """Return what the robot goes round after a decision; None while it goes round nothing."""
        return self._avoided.get(decision)

    def members(self, group: int) -> list[Shape]:
        """Return the obstacles of a group; none for a wall."""
        return [self._obstacles[k] for k in self._members.get(group, [])]

    def wall(self, group: int) -> Floats | None:
        """Return the ends of a wall (m), shape (2, 2); None for obstacles."""
        if group >= 0 or self._arena is None:
            return None
        left, bottom, right, top = self._arena
        corners = ((left, bottom), (left, top), (right, top), (right, bottom), (left, bottom))
        return np.array(corners[-group - 1 : -group + 1])

    def _nearest(self, point: tuple[float, float], held: int | None) -> int | None:
        """Return the group nearest to a point (m), or the one held while it is about as near."""
        distances = self._field.distances(point)
        walls = [math.inf] * _SIDES
        if self._arena is not None:
            (x, y), (left, bottom, right, top) = point, self._arena
            walls = [x - left, top - y, right - x, y - bottom]
        least = min(float(distances.min(initial=math.inf)), *walls)
        if not math.isfinite(least):
            return None
        if held is not None:
            members = self._members.get(held)
            away = walls[-held - 1] if members is None else float(distances[members].min())
            if away <= least + _LOYAL:
                return held
        if least in walls:
            return -walls.index(least) - 1
        return self._group_of(int(distances.argmin()))

    def _group_of(self, index: int) -> int:
        if index not in self._group:
            found, waiting = {index}, [index]
            while waiting:
                near = self._touching(waiting.pop())
                waiting += [k for k in near if k not in found]
                found.update(near)
            first = min(found)
            self._members[first] = sorted(found)
            self._group.update(dict.fromkeys(found, first))
        return self._group[index]

    def _touching(self, index: int) -> list[int]:
        gaps = np.hypot(*(self._centres - self._centres[index]).T) - self._extents
        near = np.flatnonzero(gaps <= self._extents[index] + _TOUCHING).tolist()
        here = self._grown(index)
        return [
            k
            for k in near
            if k != index and any(len(clipped(a, b)) for a in self._grown(k) for b in here)
        ]

    def _grown(self, index: int) -> list[Floats]:
        """Return an obstacle's convex pieces (m), a little larger."""
        pieces = self._obstacles[index].pieces()
        if len(pieces) == 1:
            return [_grown(pieces[0], self._centres[index], self._extents[index])]
        middles = [piece.mean(axis=0) for piece in pieces]
        return [
            _grown(piece, middle, float(np.hypot(*(piece - middle).T).max()))
            for piece, middle in zip(pieces, middles, strict=True)
        ]


def _grown(outline: Floats, centre: Floats, size: float) -> Floats:
    return np.asarray(centre + (outline - centre) * (1.0 + _TOUCHING / 2 / size))
