"""Exact plane geometry of discs among upright cylinders, boxes and walls; plain numbers only."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from collections.abc import Sequence

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.intp]

WALL = -1
"""What ``Field.nearest`` answers in place of an obstacle's index when a wall is nearest."""

_GRAZE = 1e-9
"""A path that would cut less deep than this (m) into something round only grazes it."""
_PARALLEL = 1e-12
"""A direction closing in on a flat face slower than this (m per m) runs along it: cos(π/2) ≠ 0."""
_TOGETHER = 48
"""Points whose clearance is told at once; beside each other they share what is near them."""
_CHUNK = 1_000_000
"""Most distances held in memory at once by ``Field.clearance``."""


def wrap_angle(angle: float) -> float:
    """Return the same direction within (−π, π] (rad)."""
    wrapped = math.remainder(angle, math.tau)
    return math.pi if wrapped <= -math.pi else wrapped


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """Obstacles and walls, ready to be asked for distances.

    Attributes:
        cylinders: Shape (N, 3): x, y, radius (m).
        boxes: Shape (M, 5): x, y, size along its own x and y (m), yaw (rad).
        arena: Width and depth (m) of the walls' inner faces x = 0, x = width, y = 0, y = depth;
            None where there are no walls.
        cylinder_index: Shape (N,): the number by which ``nearest`` and ``distances`` know each
            cylinder; by default cylinders come first, boxes after them.
        box_index: Shape (M,): the same for the boxes.
    """

    cylinders: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    boxes: Floats = field(default_factory=lambda: np.zeros((0, 5)))
    arena: tuple[float, float] | None = None
    cylinder_index: Ints | None = None
    box_index: Ints | None = None
    _cylinders: Floats = field(init=False, repr=False)  # rows: x, y, radius
    _boxes: Floats = field(init=False, repr=False)  # rows: x, y, half sizes, cos and sin of yaw
    _shapes: Floats = field(init=False, repr=False)  # rows: as of a box, and radius of corners
    _order: Ints = field(init=False, repr=False)

    def __post_init__(self) -> None:
        cylinders = np.array(self.cylinders, dtype=np.float64).reshape(-1, 3)
        boxes = np.array(self.boxes, dtype=np.float64).reshape(-1, 5)
        n, m = len(cylinders), len(boxes)
        first = np.arange(n) if self.cylinder_index is None else np.array(self.cylinder_index)
        second = np.arange(n, n + m) if self.box_index is None else np.array(self.box_index)
        order = np.concatenate([first, second]).astype(np.intp)
        if order.shape != (n + m,) or not np.array_equal(np.sort(order), np.arange(n + m)):
            raise ValueError("cylinder_index and box_index must number all obstacles once, from 0")
        x, y, sx, sy, yaw = boxes.T
        shapes = np.zeros((7, n + m))
        shapes[:2, :n], shapes[4, :n], shapes[6, :n] = cylinders.T[:2], 1.0, cylinders.T[2]
        shapes[:6, n:] = x, y, sx / 2, sy / 2, np.cos(yaw), np.sin(yaw)
        ready = {
            "cylinders": cylinders,
            "boxes": boxes,
            "cylinder_index": order[:n],
            "box_index": order[n:],
            "_cylinders": np.ascontiguousarray(cylinders.T),
            "_boxes": shapes[:6, n:].copy(),
            "_shapes": shapes,
            "_order": order,
        }
        for name, array in ready.items():
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    @classmethod
    def of(cls, obstacles: Sequence[Any], arena: Any = None) -> Field:
        """Build the field of a scenario's obstacles, keeping their order as index.

        Args:
            obstacles: Things with ``shape`` ("cylinder" or "box"), ``position`` and either
                ``radius`` or ``size`` and ``yaw``.
            arena: A thing with ``size`` and ``walls``; None for no walls.

        Raises:
            ValueError: If a shape is neither of the two.
        """
        cylinders: list[tuple[float, ...]] = []
        boxes: list[tuple[float, ...]] = []
        cylinder_index: list[int] = []
        box_index: list[int] = []
        for i, item in enumerate(obstacles):
            if item.shape == "cylinder":
                cylinders.append((*item.position, item.radius))
                cylinder_index.append(i)
            elif item.shape == "box":
                boxes.append((*item.position, *item.size, item.yaw))
                box_index.append(i)
            else:
                raise ValueError(f"no geometry for the shape {item.shape!r}")
        return cls(
            np.array(cylinders, dtype=np.float64).reshape(-1, 3),
            np.array(boxes, dtype=np.float64).reshape(-1, 5),
            tuple(arena.size) if arena is not None and arena.walls else None,
            np.array(cylinder_index, dtype=np.intp),
            np.array(box_index, dtype=np.intp),
        )

    def distances(self, point: ArrayLike) -> Floats:
        """Return the signed distance (m) from ``point``, shape (2,), to each obstacle.

        Shape (N + M,) in the obstacles' own order, walls left out; negative inside an obstacle.
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
        if len(self._order):
            rows = max(1, min(_TOGETHER, _CHUNK // len(self._order)))
            for k in range(0, len(p), rows):
                here, least = p[k : k + rows], result[k : k + rows]
                np.minimum(least, self._to_obstacles(here, self._near(here)).min(1), out=least)
        return result

    def clearance_on_ways(self, starts: ArrayLike, ends: ArrayLike) -> tuple[Floats, Floats]:
        """Return the least distance on each straight way, and the place on it where that is.

        Args:
            starts: Shape (K, 2), in metres.
            ends: Shape (K, 2), in metres. No way may lead into a box and
                out again.

        Returns:
            Signed distances (m), shape (K,), as of ``clearance``, and places (m), shape (K, 2).
        """
        a = np.asarray(starts, dtype=np.float64).reshape(-1, 2)
        b = np.asarray(ends, dtype=np.float64).reshape(-1, 2)
        at_start, least = self.clearance(a), self.clearance(b)
        places = np.where((at_start <= least)[:, None], a, b)
        np.minimum(least, at_start, out=least)
        # A flat face is nearest to an end of a way: between them only what is round can be nearer.
        centres, radii = self._round_parts()
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

    def _round_parts(self) -> tuple[Floats, Floats]:
        """Return cylinders and the corners of boxes: centres (m), shape (P, 2), and radii (m)."""
        x, y, half_x, half_y, cos, sin = self._boxes
        signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        own_x, own_y = half_x * signs[:, :1], half_y * signs[:, 1:]
        corners = np.stack([x + cos * own_x - sin * own_y, y + sin * own_x + cos * own_y], axis=2)
        corners = corners.reshape(-1, 2)
        radii = np.concatenate([self._cylinders[2], np.zeros(len(corners))])
        return np.vstack([self._cylinders[:2].T, corners]), radii

    def around(
        self, x: float, y: float, reach: float
    ) -> tuple[list[tuple[float, list[float]]], float]:
        """Return what is near a point, and how far the nearest of the rest is (m).

        Args:
            x: The point (m).
            y: The point (m).
            reach: What is no farther than this is near (m).

        Returns:
            For each obstacle near it, the nearest first: how far it is (m), then what it is, a
            rectangle with round corners: x, y, half sizes, cosine and sine of its yaw, and the
            radius of its corners. A box has none; of a cylinder there is nothing else.
        """
        to = self._to_obstacles(np.array([[x, y]]))[0]
        order = to.argsort()
        count = int(to[order].searchsorted(reach, side="right"))
        near = order[:count]
        shapes = list(zip(to[near].tolist(), self._shapes[:, near].T.tolist(), strict=True))
        return shapes, float(to[order[count]]) if count < len(to) else math.inf

    def free_distance(
        self, origin: ArrayLike, headings: ArrayLike, radius: float, limit: float
    ) -> Floats:
        """Return how far a disc can move straight on before it touches anything. Exact.

        A cylinder stops the disc's centre at a circle of both radii, a box at its outline grown
        by ``radius`` with round corners, a wall at ``radius`` from its face. What the disc touches
        or overlaps already stops it, at 0, only when the motion would bring the two closer; it may
        always slide along or move out.

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
        if len(self.cylinders):
            reach = self._reach_of_cylinders(x, y, ux[:, None], uy[:, None], radius)
            np.minimum(free, reach.min(axis=1), out=free)
        if len(self.boxes):
            reach = self._reach_of_boxes(x, y, ux[:, None], uy[:, None], radius)
            np.minimum(free, reach.min(axis=1), out=free)
        if self.arena is not None:
            for at, u, size in ((x, ux, self.arena[0]), (y, uy, self.arena[1])):
                gap = np.where(u > 0.0, size - radius - at, at - radius)
                speed = np.abs(u)
                wall = gap / np.maximum(speed, _PARALLEL)
                np.minimum(free, np.where(speed > _PARALLEL, wall, np.inf), out=free)
        np.maximum(free, 0.0, out=free)
        return free

    def _near(self, p: Floats) -> NDArray[np.bool_] | None:
        """Return which obstacles, shape (N + M,), may be nearest to any of the points p."""
        if len(p) == 1 or not np.isfinite(p).all():
            return None
        middle = (p.min(axis=0) + p.max(axis=0)) / 2.0
        around = float(np.abs(p - middle).sum(axis=1).max())
        # No point is farther from the middle than this, so no distance differs by more from there.
        to = self._to_obstacles(middle[None])[0]
        near: NDArray[np.bool_] = to <= to.min() + 2.0 * around + _GRAZE
        return near

    def _to_obstacles(self, p: Floats, which: NDArray[np.bool_] | None = None) -> Floats:
        """Signed distances (m), shape (K, N + M), cylinders first; to all, or to ``which`` only."""
        px, py = p[:, :1], p[:, 1:]
        cylinders, boxes = self._cylinders, self._boxes
        if which is not None:
            count = cylinders.shape[1]
            cylinders, boxes = cylinders[:, which[:count]], boxes[:, which[count:]]
        cx, cy, r = cylinders
        to_cylinders: Floats = np.sqrt((px - cx) ** 2 + (py - cy) ** 2) - r
        if not boxes.size:
            return to_cylinders
        bx, by, hx, hy, cos, sin = boxes
        dx, dy = px - bx, py - by
        qx = np.abs(dx * cos + dy * sin) - hx
        qy = np.abs(dy * cos - dx * sin) - hy
        outside = np.sqrt(np.maximum(qx, 0.0) ** 2 + np.maximum(qy, 0.0) ** 2)
        to_boxes = outside + np.minimum(np.maximum(qx, qy), 0.0)
        distances: Floats = np.hstack([to_cylinders, to_boxes])
        return distances

    def _to_walls(self, p: Floats) -> Floats:
        """Signed distance (m), shape (K,), to the nearest wall; infinite where there is none."""
        if self.arena is None:
            return np.full(len(p), np.inf)
        width, depth = self.arena
        x, y = p[:, 0], p[:, 1]
        return np.minimum(np.minimum(x, width - x), np.minimum(y, depth - y))

    def _reach_of_cylinders(
        self, x: float, y: float, ux: Floats, uy: Floats, radius: float
    ) -> Floats:
        """Distance to contact (m), shape (H, N), with each cylinder; infinite where missed."""
        cx, cy, r = self._cylinders
        return _reach_of_circles(cx - x, cy - y, ux, uy, r + radius)

    def _reach_of_boxes(self, x: float, y: float, ux: Floats, uy: Floats, radius: float) -> Floats:
        """Distance to contact (m), shape (H, M), with each box; infinite where missed.

        In the box's own frame, the ray enters the rectangle grown by ``radius``. Entering at a
        side, that is the contact. Entering at one of the four corner squares, it can only touch
        that corner's circle: the squares' inner edges lie within their circles.
        """
        bx, by, hx, hy, cos, sin = self._boxes
        dx, dy = x - bx, y - by
        px, py = dx * cos + dy * sin, dy * cos - dx * sin
        vx, vy = ux * cos + uy * sin, uy * cos - ux * sin
        vx = np.where(np.abs(vx) < _PARALLEL, 0.0, vx)
        vy = np.where(np.abs(vy) < _PARALLEL, 0.0, vy)

        near_x, far_x = _slab(px, vx, hx + radius)
        near_y, far_y = _slab(py, vy, hy + radius)
        enter, leave = np.maximum(near_x, near_y), np.minimum(far_x, far_y)
        begin = np.maximum(enter, 0.0)
        ex, ey = px + begin * vx, py + begin * vy
        kx, ky = np.maximum(np.minimum(ex, hx), -hx), np.maximum(np.minimum(ey, hy), -hy)
        corner = (np.abs(ex) > hx) & (np.abs(ey) > hy)
        round_off = _reach_of_circles(kx - px, ky - py, vx, vy, np.full_like(hx, radius))
        reach = np.where(corner, round_off, begin)
        reach = np.where((enter < leave) & (leave > 0.0), reach, np.inf)

        # Distance to a convex body is convex along a line: what begins to grow goes on growing.
        qx, qy = np.abs(px) - hx, np.abs(py) - hy
        beyond_x, beyond_y = np.maximum(qx, 0.0), np.maximum(qy, 0.0)
        outside = np.sqrt(beyond_x**2 + beyond_y**2)
        inside = outside == 0.0
        touching = np.where(inside, np.maximum(qx, qy), outside) <= radius
        grows_x = np.where(px == 0.0, np.abs(vx), np.copysign(1.0, px) * vx)
        grows_y = np.where(py == 0.0, np.abs(vy), np.copysign(1.0, py) * vy)
        within = np.where(qx == qy, np.maximum(grows_x, grows_y), 0.0)
        within = np.where(qx > qy, grows_x, np.where(qx < qy, grows_y, within))
        around = (beyond_x * grows_x + beyond_y * grows_y) / np.where(inside, 1.0, outside)
        growth = np.where(inside, within, around)
        stopped = np.where(growth < -_PARALLEL, 0.0, np.inf)
        return np.where(touching, stopped, reach)


def _reach_of_circles(mx: Floats, my: Floats, ux: Floats, uy: Floats, r: Floats) -> Floats:
    """Distance (m) along unit vectors u until within ``r`` of the points m; infinite if never."""
    along = ux * mx + uy * my
    aside = ux * my - uy * mx
    half_chord_squared = r * r - aside * aside
    hit = (along > _PARALLEL) & (half_chord_squared > (2.0 * _GRAZE) * r)
    half_chord = np.sqrt(np.maximum(half_chord_squared, 0.0))
    return np.where(hit, along - half_chord, np.inf)


def _slab(p: Floats, v: Floats, half: Floats) -> tuple[Floats, Floats]:
    """Distances at which a ray from ``p`` along ``v`` enters and leaves the strip |p| ≤ half."""
    safe = np.where(v == 0.0, 1e-30, v)
    a, b = (-half - p) / safe, (half - p) / safe
    return np.minimum(a, b), np.maximum(a, b)
