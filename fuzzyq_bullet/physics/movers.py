"""Obstacles that move: their clocks, where they are, and the bodies that stand for them.

Each has two bodies without mass: the solid that the robot touches, and the faces that rays meet.
They are put from pose to pose, so nothing ever stops or pushes them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.scenario.courses import courses_of, fastest, told_top_speed
from fuzzyq_bullet.scenario.movers import moves
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Shape
from fuzzyq_bullet.shapes.motion import MAX_MOTION_SPEED, STILL, Course, placed, seen_from

Floats: TypeAlias = NDArray[np.float64]
Place: TypeAlias = tuple[float, float]

STOP_AHEAD = 0.5
"""An obstacle that stops for the robot does so while it would come near within this way (m)."""
STOP_GAP = 0.1
"""Near is closer to the robot's disc than this (m)."""
_LOOKS = 4
"""Poses along ``STOP_AHEAD`` at which an obstacle looks for the robot."""
_GLIMPSE = 0.05
"""Time (s) in which an obstacle's speed is measured, to tell how far ahead it looks."""
_NEAR = 0.35
"""An obstacle nearer to the robot than this (m) is moved in every step; others when they may be:
in the 0.05 s between two looks the two come at most 0.3 m closer."""
_FASTEST = 2 * MAX_MOTION_SPEED
"""No obstacle and robot come closer to each other faster than this (m/s)."""


class Mover:
    """One obstacle that moves.

    Args:
        index: Which of the scenario's obstacles it is.
        shape: The obstacle as the scenario has it.

    Attributes:
        solid: Body that the robot touches; None where there is no robot to touch it.
        faces: Body that rays meet.
    """

    def __init__(self, index: int, shape: Shape) -> None:
        self.index, self.shape = index, shape
        self.extent = shape.extent()
        self.stops = shape.motion.stops_for_robot
        self.solid: int | None = None
        self.faces = -1
        self._field = Field.of([shape])
        self.begin(STILL)

    def begin(self, course: Course) -> None:
        """Put it at the beginning of its way."""
        self._course, self._halted = course, 0.0
        self._latest = (-1.0, (0.0, 0.0, 0.0))  # clock and pose: all ask for the same several times

    def top_speed(self, time: float) -> float:
        """Return the greatest speed (m/s) of any part of it, until a time (s) of the run."""
        told = told_top_speed(self.shape)
        return fastest(self._course, self.extent, time) if told is None else told

    def halt(self, time: float) -> None:
        """Let its clock stand for a time (s)."""
        self._halted += time

    def pose(self, time: float) -> tuple[float, float, float]:
        """Return its centre (m) and how far it has turned (rad), at a time (s) of the run."""
        return self._at(time - self._halted)

    def gap(self, time: float, point: Place, pose: Sequence[float] | None = None) -> float:
        """Return the distance (m) from it to a point; negative inside it."""
        at = self.pose(time) if pose is None else pose
        return float(self._field.clearance(seen_from(point, self.shape.position, at))[0])

    def touching(self, point: Place, time: float) -> tuple[int, Place]:
        """Return its index, and the place on its surface (m) that is nearest to a point."""
        pose = self.pose(time)
        local = seen_from(point, self.shape.position, pose)[0]
        _, place = self._field.touching(local)
        return self.index, tuple(placed([place], self.shape.position, pose)[0].tolist())

    def is_blocked(self, time: float, point: Place, radius: float) -> bool:
        """Return whether the robot's disc is within its way ahead, and it comes closer to it."""
        clock = time - self._halted
        here, soon = self._at(clock), self._at(clock + _GLIMPSE)
        turned = math.remainder(soon[2] - here[2], math.tau)  # it may count from -π to π
        way = math.dist(here[:2], soon[:2]) + self.extent * abs(turned)
        if way <= 0.0:
            return False
        need, now = radius + STOP_GAP, -math.inf
        for k in range(1, _LOOKS + 1):
            ahead = self._at(clock + STOP_AHEAD / way * _GLIMPSE * k / _LOOKS)
            if math.dist(point, ahead[:2]) - self.extent > need:
                continue
            now = self.gap(time, point, here) if now == -math.inf else now
            gap = self.gap(time, point, ahead)
            if gap <= need and gap < now:
                return True
        return False

    def _at(self, clock: float) -> tuple[float, float, float]:
        clock = max(0.0, clock)
        if clock != self._latest[0]:
            moved, (x, y) = self._course.pose(clock), self.shape.position
            self._latest = (clock, (x + moved[0], y + moved[1], moved[2]))
        return self._latest[1]


class Movers:
    """All obstacles of a world that move.

    Args:
        obstacles: All obstacles of the world.
        arena: The arena.

    Attributes:
        members: Those that move.
        time: Time of the run (s).
    """

    def __init__(self, obstacles: Sequence[Shape], arena: Arena) -> None:
        self._world = (obstacles, arena)
        self.members = [Mover(i, one) for i, one in enumerate(obstacles) if moves(one)]
        self.time = 0.0
        self._engine: Engine | None = None
        self._height = 0.0
        self._shown: float | None = None
        self._asleep_until: dict[int, float] = {}

    def build(self, engine: Engine, height: float) -> None:
        """Note the engine that holds their bodies, and the height of the rays (m)."""
        self._engine, self._height = engine, height

    def start(self, seed: int) -> None:
        """Begin a run: every clock at 0, every obstacle at the beginning of its way."""
        if not self.members:
            return
        courses = courses_of(*self._world, seed)
        for one in self.members:
            one.begin(courses[one.index])
        self.time, self._shown = 0.0, None
        self._asleep_until = dict.fromkeys((one.index for one in self.members), 0.0)
        for one in self.members:
            self._put_solid(one)
        self.show()

    def fastest(self, time: float) -> float:
        """Return how fast (m/s) any of them is at most, until a time (s); 0 if none moves."""
        return max((one.top_speed(time) for one in self.members), default=0.0)

    def poses(self) -> Floats:
        """Return where they are, shape (M, 3): x, y (m) of the centre, and the turn (rad)."""
        return np.array([one.pose(self.time) for one in self.members]).reshape(-1, 3)

    def show(self) -> None:
        """Put the faces that rays meet where the obstacles are."""
        if self._shown == self.time:
            return
        self._shown = self.time
        for one in self.members:
            self._put(one.faces, one.pose(self.time), self._height)

    def watch(self, robot: Place, radius: float) -> list[tuple[Mover, bool]]:
        """Return those near the robot, each with whether it stops for it now.

        All others are left where they are for as long as they cannot be near.

        Args:
            robot: Centre of the robot (m).
            radius: Radius of its disc (m).
        """
        near = []
        for one in self.members:
            if self.time < self._asleep_until[one.index]:
                continue
            x, y, _ = one.pose(self.time)
            gap = math.dist(robot, (x, y)) - one.extent - radius
            looked_at = STOP_AHEAD + STOP_GAP if one.stops else _NEAR
            stops = gap <= looked_at and one.stops and one.is_blocked(self.time, robot, radius)
            self._put_solid(one)  # also of one that stops now: it stands where it is, not was
            if stops or gap <= _NEAR:
                near.append((one, stops))
                continue
            if gap > looked_at:
                self._asleep_until[one.index] = self.time + (gap - looked_at) / _FASTEST
        return near

    def step(self, near: Sequence[tuple[Mover, bool]], dt: float) -> None:
        """Let a short time pass, and move the solids of those near the robot."""
        self.time += dt
        for one, stopped in near:
            if stopped:
                one.halt(dt)
            else:
                self._put_solid(one)

    def is_due(self) -> bool:
        """Return whether one of them may have come near the robot."""
        return any(self.time >= until for until in self._asleep_until.values())

    def touching(self, point: Place, radius: float) -> Mover | None:
        """Return the one that a disc at a point (m) touches most, if any."""
        least, found = radius, None
        for one in self.members:
            x, y, _ = pose = one.pose(self.time)
            if math.dist(point, (x, y)) - one.extent > least:
                continue
            gap = one.gap(self.time, point, pose)
            if gap <= least:
                least, found = gap, one
        return found

    def _put_solid(self, one: Mover) -> None:
        if one.solid is not None:
            self._put(one.solid, one.pose(self.time), 0.0)

    def _put(self, body: int, pose: Sequence[float], height: float) -> None:
        assert self._engine is not None
        x, y, yaw = pose
        api: Any = self._engine.api
        api.resetBasePositionAndOrientation(
            body,
            (x, y, height),
            (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)),
            self._engine.client,
        )
