"""Exact plane geometry of discs among obstacles of any shapes and walls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyq_bullet.shapes.base import PARALLEL, Shape, ShapeGroup
from fuzzyq_bullet.shapes.box import Boxes
from fuzzyq_bullet.shapes.cylinder import Cylinders

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.intp]

WALL = -1
"""What ``Field.nearest`` answers in place of an obstacle's index when a wall is nearest."""

_CHUNK = 1_000_000
"""Most distances held in memory at once by ``Field.clearance_along``."""


def wrap_angle(angle: float) -> float:
    """Return the same direction within (−π, π] (rad)."""
    wrapped = math.remainder(angle, math.tau)
    return math.pi if wrapped <= -math.pi else wrapped


class Field:
    """Obstacles and walls, ready to be asked for distances; it does not change.

    Args:
        cylinders: Shape (N, 3): x, y, radius (m).
        boxes: Shape (M, 5): x, y, size along its own x and y (m), yaw (rad).
        arena: Width and depth (m) between the walls' inner faces; None where there are no walls.
        origin: Lower left corner between the walls (m).
        groups: Obstacles of any shape, a group for each, behind the cylinders and boxes.
        order: Shape (N,): the number by which ``nearest`` and ``distances`` know each
            obstacle, in the order of the groups; by default that order.

    Attributes:
        groups: All obstacles, a group for each shape, none of them empty.
        walls: Inner faces of the walls (m): left, bottom, right, top; None where there are none.
    """

    __slots__ = ("_order", "groups", "walls")

    groups: tuple[ShapeGroup, ...]
    walls: tuple[float, float, float, float] | None
    _order: Ints

    def __init__(
        self,
        cylinders: ArrayLike = (),
        boxes: ArrayLike = (),
        arena: tuple[float, float] | None = None,
        *,
        origin: tuple[float, float] = (0.0, 0.0),
        groups: Sequence[ShapeGroup] = (),
        order: ArrayLike | None = None,
    ) -> None:
        every = (Cylinders(np.asarray(cylinders)), Boxes(np.asarray(boxes)), *groups)
        kept = tuple(group for group in every if len(group))
        count = sum(map(len, kept))
        number = np.arange(count) if order is None else np.array(order, dtype=np.intp)
        if number.shape != (count,) or not np.array_equal(np.sort(number), np.arange(count)):
            raise ValueError("order must number all obstacles once, from 0")
        number.flags.writeable = False
        x, y = origin
        ready = {
            "groups": kept,
            "walls": None if arena is None else (x, y, x + arena[0], y + arena[1]),
            "_order": number,
        }
        for name, value in ready.items():
            object.__setattr__(self, name, value)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a field does not change: {name}")

    @classmethod
    def of(cls, obstacles: Sequence[Shape], arena: Any = None) -> Field:
        """Build the field of a scenario's obstacles, keeping their order as index.

        Args:
            obstacles: Obstacles of any shapes.
            arena: A thing with ``size``, ``origin`` and ``walls``; None for no walls.
        """
        # Cylinders and boxes first, then others as they come: of equal distances the first counts.
        members: dict[type[ShapeGroup], list[int]] = {Cylinders: [], Boxes: []}
        for i, item in enumerate(obstacles):
            members.setdefault(item.group, []).append(i)
        return cls(
            arena=arena.size if arena is not None and arena.walls else None,
            origin=(0.0, 0.0) if arena is None else arena.origin,
            groups=[kind.of([obstacles[i] for i in at]) for kind, at in members.items() if at],
            order=[i for at in members.values() for i in at],
        )

    @property
    def discs(self) -> Floats:
        """What is round: x, y, radius (m), shape (P, 3); corners have radius 0."""
        return np.concatenate([np.zeros((0, 3)), *(group.discs for group in self.groups)])

    def distances(self, point: ArrayLike) -> Floats:
        """Return the signed distance (m) from ``point``, shape (2,), to each obstacle.

        Shape (N,) in the obstacles' own order, walls left out; negative inside an obstacle.
        """
        here = np.asarray(point, dtype=np.float64).reshape(1, 2)
        result = np.empty(len(self._order))
        result[self._order] = self._to_obstacles(here)[0]
        return result

    def nearest(self, point: ArrayLike) -> tuple[int, float]:
        """Return the index of what is nearest to ``point``, shape (2,), and its distance (m).

        The index is ``WALL`` for a wall, and for an empty field, where the distance is infinite.
        """
        here = np.asarray(point, dtype=np.float64).reshape(1, 2)
        index, least = WALL, float(self._to_walls(here)[0])
        if len(self._order):
            to_obstacles = self._to_obstacles(here)[0]
            first = int(to_obstacles.argmin())
            if to_obstacles[first] <= least:
                index, least = int(self._order[first]), float(to_obstacles[first])
        return index, least

    def touching(self, point: ArrayLike) -> tuple[int, tuple[float, float]]:
        """Return what is nearest to ``point``, shape (2,), as ``nearest`` does, and where (m).

        The place is that on the nearest surface; an obstacle's centre for a point at its centre.
        """
        x, y = np.asarray(point, dtype=np.float64).reshape(2).tolist()
        index, distance = self.nearest((x, y))
        step = 1e-6  # the distance falls fastest straight towards what is nearest
        east, west, north, south = self.clearance(
            [(x + step, y), (x - step, y), (x, y + step), (x, y - step)]
        ).tolist()
        dx, dy = west - east, south - north
        size = math.hypot(dx, dy) or 1.0
        return index, (x + distance * dx / size, y + distance * dy / size)

    def clearance(self, points: ArrayLike) -> Floats:
        """Return the signed distance (m), shape (K,), from each point to the nearest surface.

        Args:
            points: Shape (K, 2), in metres.

        Returns:
            Negative inside an obstacle or behind a wall (there, minus the depth), infinite in an
            empty field.
        """
        p = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        result = self._to_walls(p)
        for group in self.groups:
            np.minimum(result, group.clearance(p), out=result)
        return result

    def clearance_along(self, starts: ArrayLike, ends: ArrayLike) -> tuple[Floats, Floats]:
        """Return the least clearance along each straight segment, and the point where it is.

        Args:
            starts: Shape (K, 2), in metres.
            ends: Shape (K, 2), in metres. No segment may lead into an obstacle with flat faces and
                out again.

        Returns:
            Signed distances (m), shape (K,), as of ``clearance``, and points (m), shape (K, 2).
        """
        a = np.asarray(starts, dtype=np.float64).reshape(-1, 2)
        b = np.asarray(ends, dtype=np.float64).reshape(-1, 2)
        at_start, least = self.clearance(a), self.clearance(b)
        places = np.where((at_start <= least)[:, None], a, b)
        np.minimum(least, at_start, out=least)
        # A flat face is nearest to an end of a segment. In between only something round can be, or
        # a corner, which is a disc of radius 0.
        discs = self.discs
        centres, radii = discs[:, :2], discs[:, 2]
        rows = max(1, _CHUNK // max(1, len(radii)))
        for k in range(0, len(a) if len(radii) else 0, rows):
            start, way = a[k : k + rows, None], (b - a)[k : k + rows, None]
            length_squared = np.maximum((way**2).sum(2), 1e-300)
            along = ((centres - start) * way).sum(2) / length_squared
            foot = start + np.minimum(np.maximum(along, 0.0), 1.0)[:, :, None] * way
            apart = np.sqrt(((centres - foot) ** 2).sum(2)) - radii
            which = apart.argmin(1)[:, None]
            nearest = np.take_along_axis(apart, which, 1)[:, 0]
            nearer = nearest < least[k : k + rows]
            least[k : k + rows][nearer] = nearest[nearer]
            feet = np.take_along_axis(foot, which[:, :, None], 1)[:, 0]
            places[k : k + rows][nearer] = feet[nearer]
        return least, places

    def free_distance(
        self, origin: ArrayLike, headings: ArrayLike, radius: float, limit: float
    ) -> Floats:
        """Return how far a disc can move straight on before it touches anything. Exact.

        An obstacle stops the disc's centre at its outline grown by ``radius`` with round corners,
        a wall at ``radius`` from its face. What the disc touches or overlaps already stops it, at
        0, only when the motion would bring the two closer; it may always slide along or move out.

        Args:
            origin: Centre of the disc (m), shape (2,).
            headings: World headings (rad), shape (H,); one number counts as H = 1.
            radius: Radius of the disc (m), at least 0.
            limit: Longest distance of interest (m).

        Returns:
            Shape (H,), each in [0, ``limit``] (m).
        """
        angle = np.asarray(headings, dtype=np.float64).reshape(-1)
        x, y = np.asarray(origin, dtype=np.float64).tolist()
        ux, uy = np.cos(angle), np.sin(angle)
        free = np.full(len(angle), float(limit))
        for group in self.groups:
            reach = group.free_distances(x, y, ux[:, None], uy[:, None], radius)
            np.minimum(free, reach.min(axis=1), out=free)
        if self.walls is not None:
            left, bottom, right, top = self.walls
            for at, u, low, high in ((x, ux, left, right), (y, uy, bottom, top)):
                gap = np.where(u > 0.0, high - radius - at, at - low - radius)
                speed = np.abs(u)
                wall = gap / np.maximum(speed, PARALLEL)
                np.minimum(free, np.where(speed > PARALLEL, wall, np.inf), out=free)
        np.maximum(free, 0.0, out=free)
        return free

    def _to_obstacles(self, p: Floats) -> Floats:
        """Signed distances (m), shape (K, N), in the groups' order."""
        told = [group.distances(p[:, :1], p[:, 1:]) for group in self.groups]
        return told[0] if len(told) == 1 else np.hstack([np.zeros((len(p), 0)), *told])

    def _to_walls(self, p: Floats) -> Floats:
        """Signed distance (m), shape (K,), to the nearest wall; infinite where there is none."""
        if self.walls is None:
            return np.full(len(p), np.inf)
        left, bottom, right, top = self.walls
        x, y = p[:, 0], p[:, 1]
        return np.minimum(np.minimum(x - left, right - x), np.minimum(y - bottom, top - y))
