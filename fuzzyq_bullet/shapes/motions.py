"""Motions that come with the package: patrol, circle and wander."""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from fuzzyq_bullet.quantities import DECIMALS, TOUCH, Flag, Number, Point
from fuzzyq_bullet.shapes.motion import (
    MAX_MOTION_SPEED,
    Course,
    Floats,
    Motion,
    Moving,
    Pose,
    Standing,
    Surroundings,
    register_motion,
    turned_about_origin,
)

if TYPE_CHECKING:
    from typing_extensions import Self

Speed = Annotated[Number, Field(gt=0.0, le=MAX_MOTION_SPEED)]
MAX_POINTS = 1000
"""Most points of a patrol."""
_SAME = 1e-9
_SCATTER = math.radians(30.0)
"""A wanderer leaves a wall at most this far from the mirrored direction (rad)."""
_LEAST_LEG = 0.05
"""A direction that is free for less than this (m) is not taken if there is a better one."""
_LEAST_TIME = 0.05
"""A leg takes at least so long (s), the shorter ones at less speed: no loop without end."""
_TRIES = 16
_LONGEST_LEG = 3000.0
_STEP = 1e-3


class _Leg(NamedTuple):
    """A straight piece of a way: when it begins, where, and how fast it goes."""

    time: float
    x: float
    y: float
    vx: float
    vy: float


class _Legs:
    """A way made of straight pieces; it stands still before the first and on the last if told."""

    def __init__(self, legs: list[_Leg], period: float | None = None, after: float = 0.0) -> None:
        self._legs = legs
        self._times = [leg.time for leg in legs]
        self._period, self._after = period, after

    def pose(self, time: float, /) -> Pose:
        """Return where it is, compared with its place in the file."""
        if self._period is not None and time > self._after:
            time = self._after + math.fmod(time - self._after, self._period)
        leg = self._legs[max(0, bisect_right(self._times, time) - 1)]
        since = time - leg.time
        return Pose(leg.x + leg.vx * since, leg.y + leg.vy * since, 0.0)


@register_motion
class Patrol(Motion):
    """It goes from its position to the first point, and on from point to point, without turning."""

    kind: Literal["patrol"]
    points: tuple[Point, ...] = Field(
        min_length=2, max_length=MAX_POINTS, description="Where its centre goes (m)."
    )
    speed: Speed = Field(description="Speed (m/s).")
    loop: Flag = Field(
        default=False,
        description="Whether it goes on from the last point to the first; else back and forth.",
    )
    pause: Annotated[Number, Field(ge=0.0, le=3600.0)] = Field(
        default=0.0, description="How long it stands at each point (s)."
    )

    def course(self, obstacle: Moving, surroundings: Surroundings) -> Course:
        """Return the way along the points."""
        x0, y0 = here = obstacle.position
        legs: list[_Leg] = []
        time = 0.0

        def go(to: Point) -> None:
            nonlocal time, here
            (x, y), far = here, math.dist(here, to)
            if far > _SAME:
                vx, vy = (self.speed * (b - a) / far for a, b in zip(here, to, strict=True))
                legs.append(_Leg(time, x - x0, y - y0, vx, vy))
                time += far / self.speed
            legs.append(_Leg(time, to[0] - x0, to[1] - y0, 0.0, 0.0))
            time += self.pause
            here = to

        go(self.points[0])
        begin = time
        back = self.points[:1] if self.loop else self.points[-2::-1]
        for point in (*self.points[1:], *back):
            go(point)
        return _Legs(legs, time - begin if time - begin > _SAME else None, begin)

    def top_speed(self, obstacle: Moving) -> float:
        """Return its speed between the points."""
        return self.speed

    def moved(self, x: float, y: float, turn: float) -> Self:
        """Return it with its points turned about the origin and moved."""
        points = tuple(turned_about_origin(one, x, y, turn, DECIMALS) for one in self.points)
        return self.model_copy(update={"points": points})


@register_motion
class Circle(Motion):
    """It goes round a centre, and turns with it, as what is fixed to a hinge."""

    kind: Literal["circle"]
    centre: Point = Field(description="Centre of the circle (m); its radius is the distance to it.")
    speed: Speed = Field(description="Speed along the circle (m/s).")
    clockwise: Flag = Field(default=False, description="Which way round.")

    def course(self, obstacle: Moving, surroundings: Surroundings) -> Course:
        """Return the way round the centre."""
        return _Round(self, obstacle.position)

    def top_speed(self, obstacle: Moving) -> float:
        """Return the speed of the part that is farthest from the centre of the circle."""
        radius = max(math.dist(self.centre, obstacle.position), _SAME)
        return self.speed * (1.0 + obstacle.extent() / radius)

    def moved(self, x: float, y: float, turn: float) -> Self:
        """Return it with its centre turned about the origin and moved."""
        centre = turned_about_origin(self.centre, x, y, turn, DECIMALS)
        return self.model_copy(update={"centre": centre})

    def conflicts(self, obstacle: Moving, standing: Standing) -> list[tuple[str, str]]:
        """Return whether there is no circle, as its centre is that of the obstacle."""
        if math.dist(self.centre, obstacle.position) > TOUCH:
            return []
        return [("centre", "is the obstacle's own position; a circle needs one beside it")]


class _Round:
    def __init__(self, circle: Circle, position: Point) -> None:
        self._x, self._y = position[0] - circle.centre[0], position[1] - circle.centre[1]
        rate = circle.speed / max(math.hypot(self._x, self._y), _SAME)
        self._rate = -rate if circle.clockwise else rate

    def pose(self, time: float, /) -> Pose:
        turn = self._rate * time
        cos, sin = math.cos(turn), math.sin(turn)
        x, y = self._x, self._y
        return Pose(x * cos - y * sin - x, x * sin + y * cos - y, math.remainder(turn, math.tau))


@register_motion
class Wander(Motion):
    """It goes straight on, and bounces off walls, the arena's edges and what stands still."""

    kind: Literal["wander"]
    speed: Speed = Field(description="Speed (m/s).")

    def course(self, obstacle: Moving, surroundings: Surroundings) -> Course:
        """Return a way that the random numbers of the surroundings draw."""
        return _Wandering(self.speed, obstacle, surroundings)

    def top_speed(self, obstacle: Moving) -> float:
        """Return its speed wherever it goes."""
        return self.speed

    def conflicts(self, obstacle: Moving, standing: Standing) -> list[tuple[str, str]]:
        """Return whether the circle around it touches something from which it would bounce."""
        need, [gap] = obstacle.extent(), standing.clearance(obstacle.position).tolist()
        if gap > need + TOUCH:
            return []
        where = f"{gap:.3g} m from something that stands" if gap >= 0.0 else "in something"
        return [
            ("kind", f"wander: its centre is {where}; it needs more than {need:.3g} m to move in")
        ]


class _Wandering:
    """Straight pieces, drawn as far as they are asked for; the same however it is asked."""

    def __init__(self, speed: float, obstacle: Moving, surroundings: Surroundings) -> None:
        self._speed, self._radius = speed, obstacle.extent()
        self._position = obstacle.position
        self._standing, self._rng = surroundings
        self._legs: list[_Leg] = []
        self._times: list[float] = []
        self._end = 0.0
        heading, free = self._choose(
            obstacle.position, self._rng.uniform(-math.pi, math.pi, _TRIES)
        )
        self._append(obstacle.position, heading, free)

    def pose(self, time: float, /) -> Pose:
        while time > self._end:
            self._bounce()
        leg = self._legs[max(0, bisect_right(self._times, time) - 1)]
        since = max(0.0, time - leg.time)
        x, y = self._position
        return Pose(leg.x + leg.vx * since - x, leg.y + leg.vy * since - y, 0.0)

    def _append(self, start: Point, heading: float, free: float) -> None:
        lasts = free / self._speed
        speed = self._speed if lasts >= _LEAST_TIME else free / _LEAST_TIME
        self._legs.append(
            _Leg(self._end, *start, speed * math.cos(heading), speed * math.sin(heading))
        )
        self._times.append(self._end)
        self._end += max(lasts, _LEAST_TIME)

    def _bounce(self) -> None:
        leg = self._legs[-1]
        since = self._end - leg.time
        x, y = leg.x + leg.vx * since, leg.y + leg.vy * since
        # The way away from what is nearest is where the clearance grows.
        east, west, north, south = self._standing.clearance(
            [(x + _STEP, y), (x - _STEP, y), (x, y + _STEP), (x, y - _STEP)]
        ).tolist()
        normal = math.atan2(north - south, east - west)
        came = math.atan2(leg.vy, leg.vx)
        mirrored = 2.0 * normal + math.pi - came
        near = mirrored + self._rng.uniform(-_SCATTER, _SCATTER, _TRIES // 2)
        away = normal + self._rng.uniform(-math.pi / 2, math.pi / 2, _TRIES // 2)
        heading, free = self._choose((x, y), np.concatenate([near, away]))
        self._append((x, y), heading, free)

    def _choose(self, start: Point, headings: Floats) -> tuple[float, float]:
        """Return the first direction that is free for a while, and for how far (m)."""
        free = self._standing.free_distance(start, headings, self._radius, _LONGEST_LEG)
        free = np.maximum(free - TOUCH, 0.0)
        fine = np.flatnonzero(free >= _LEAST_LEG)
        best = int(fine[0]) if len(fine) else int(free.argmax())
        return float(headings[best]), float(free[best])
