"""The upright box."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from fuzzyq_bullet.quantities import DECIMALS, MIN_RADIUS, Angle, Number
from fuzzyq_bullet.shapes.base import (
    PARALLEL,
    Collision,
    Floats,
    Mask,
    Shape,
    ShapeGroup,
    reach_of_circles,
    register_shape,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typing_extensions import Self

_SIGNS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
"""The corners of a box, anticlockwise, in its own half sizes."""


class Boxes(ShapeGroup):
    """Boxes.

    Args:
        rows: Shape (N, 5): x, y, size along its own x and y (m), yaw (rad).
    """

    def __init__(self, rows: Floats) -> None:
        x, y, sx, sy, yaw = np.array(rows, dtype=np.float64).reshape(-1, 5).T
        self._columns = np.array([x, y, sx / 2, sy / 2, np.cos(yaw), np.sin(yaw)])
        _, _, hx, hy, cos, sin = self._columns
        own_x, own_y = hx * _SIGNS[:, :1], hy * _SIGNS[:, 1:]
        at = [x + cos * own_x - sin * own_y, y + sin * own_x + cos * own_y, np.zeros_like(own_x)]
        self.discs = np.stack(at, axis=2).reshape(-1, 3)
        self.discs.flags.writeable = False

    @classmethod
    def of(cls, shapes: Sequence[Box]) -> Self:
        """Build it of boxes."""
        return cls(np.array([(*one.position, *one.size, one.yaw) for one in shapes]))

    def __len__(self) -> int:
        return len(self._columns[0])

    def distances(self, x: Floats, y: Floats, which: Mask | None = None) -> Floats:
        """Return the distance to each rectangle."""
        bx, by, hx, hy, cos, sin = self._columns if which is None else self._columns[:, which]
        dx, dy = x - bx, y - by
        qx = np.abs(dx * cos + dy * sin) - hx
        qy = np.abs(dy * cos - dx * sin) - hy
        outside = np.sqrt(np.maximum(qx, 0.0) ** 2 + np.maximum(qy, 0.0) ** 2)
        distances: Floats = outside + np.minimum(np.maximum(qx, qy), 0.0)
        return distances

    def free_distances(self, x: float, y: float, ux: Floats, uy: Floats, radius: float) -> Floats:
        """Return where the disc's centre enters the rectangle grown by its radius, corners round.

        In the box's own frame, the ray enters the rectangle grown by ``radius``. Entering at a
        side, that is the contact. Entering at one of the four corner squares, it can only touch
        that corner's circle: the squares' inner edges lie within their circles.
        """
        bx, by, hx, hy, cos, sin = self._columns
        dx, dy = x - bx, y - by
        px, py = dx * cos + dy * sin, dy * cos - dx * sin
        vx, vy = ux * cos + uy * sin, uy * cos - ux * sin
        vx = np.where(np.abs(vx) < PARALLEL, 0.0, vx)
        vy = np.where(np.abs(vy) < PARALLEL, 0.0, vy)

        near_x, far_x = _slab(px, vx, hx + radius)
        near_y, far_y = _slab(py, vy, hy + radius)
        enter, leave = np.maximum(near_x, near_y), np.minimum(far_x, far_y)
        begin = np.maximum(enter, 0.0)
        ex, ey = px + begin * vx, py + begin * vy
        kx, ky = np.maximum(np.minimum(ex, hx), -hx), np.maximum(np.minimum(ey, hy), -hy)
        corner = (np.abs(ex) > hx) & (np.abs(ey) > hy)
        round_off = reach_of_circles(kx - px, ky - py, vx, vy, np.full_like(hx, radius))
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
        stopped = np.where(growth < -PARALLEL, 0.0, np.inf)
        return np.where(touching, stopped, reach)

    def are_crossed(self, begin: Floats, end: Floats) -> Mask:
        """Tell which lines cross the inside of a bare rectangle."""
        x, y, hx, hy, cos, sin = self._columns
        dx, dy = begin[:, :1] - x, begin[:, 1:] - y
        vx, vy = end[:, :1] - begin[:, :1], end[:, 1:] - begin[:, 1:]
        enter, leave = np.zeros_like(dx), np.ones_like(dx)
        for at, speed, half in (
            (dx * cos + dy * sin, vx * cos + vy * sin, hx),
            (dy * cos - dx * sin, vy * cos - vx * sin, hy),
        ):
            near, far = _slab(at, np.where(np.abs(speed) < 1e-30, 0.0, speed), half)
            np.maximum(enter, near, out=enter)
            np.minimum(leave, far, out=leave)
        crossed: Mask = np.any(enter < leave, axis=1)
        return crossed

    def covers(self, centre: Floats, radius: float, grown: float) -> Floats:
        """Return the parts within the boxes grown along one of their axes."""
        x, y, hx, hy, cos, sin = self._columns
        dx, dy = centre[0] - x, centre[1] - y
        px, py = dx * cos + dy * sin, dy * cos - dx * sin
        yaw = np.arctan2(sin, cos)
        sizes = ((hx + grown, hy), (hx, hy + grown))
        return np.concatenate([_within(px, py, wide, high, yaw, radius) for wide, high in sizes])


@register_shape
class Box(Shape):
    """An upright box."""

    group = Boxes

    shape: Literal["box"]
    size: tuple[
        Annotated[Number, Field(ge=2 * MIN_RADIUS, le=1000.0)],
        Annotated[Number, Field(ge=2 * MIN_RADIUS, le=1000.0)],
    ] = Field(description="Length along its own x and y (m).")
    yaw: Angle = Field(default=0.0, description="Turn of its own x axis (rad), anticlockwise.")

    def corners(self) -> tuple[Floats, float]:
        """Return the four corners, which are not round."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        half = _SIGNS * np.array(self.size) / 2
        return half @ np.array([[cos, sin], [-sin, cos]]) + self.position, 0.0

    def outline(self, corners: int = 24) -> Floats:
        """Return the four corners."""
        return self.corners()[0]

    def faces(self) -> Floats:
        """Return the four corners."""
        return self.corners()[0]

    def collisions(self, height: float) -> list[Collision]:
        """Return an exact box."""
        length, width = self.size
        return [Collision(f'<box size="{length!r} {width!r} {height!r}"/>', self.yaw)]

    def thickness(self) -> float:
        """Return its shorter side (m)."""
        return min(self.size)

    def extent(self) -> float:
        """Return half the diagonal (m)."""
        return math.hypot(*self.size) / 2

    def moved(self, x: float, y: float, turn: float) -> Self:
        """Return it turned about the origin (rad) and then moved (m), rounded to 0.1 mm."""
        yaw = round(math.remainder(self.yaw + turn, math.tau), 2 + DECIMALS)
        size = tuple(round(side, DECIMALS) for side in self.size)
        return super().moved(x, y, turn).model_copy(update={"yaw": yaw, "size": size})


def _slab(p: Floats, v: Floats, half: Floats) -> tuple[Floats, Floats]:
    """Distances at which a ray from ``p`` along ``v`` enters and leaves the strip |p| ≤ half."""
    safe = np.where(v == 0.0, 1e-30, v)
    a, b = (-half - p) / safe, (half - p) / safe
    return np.minimum(a, b), np.maximum(a, b)


def _within(
    px: Floats, py: Floats, wide: Floats, high: Floats, yaw: Floats, radius: float
) -> Floats:
    """Parts of a circle within rectangles of half sizes ``wide`` and ``high``; p is its centre."""
    away = np.hypot(np.maximum(np.abs(px) - wide, 0.0), np.maximum(np.abs(py) - high, 0.0))
    near = away < radius
    px, py, wide, high, yaw = px[near], py[near], wide[near], high[near], yaw[near]
    cuts = [np.zeros(len(px)), np.full(len(px), math.tau)]
    for level, turn in (
        (wide - px, 0.0),
        (-wide - px, 0.0),
        (high - py, math.pi / 2),
        (-high - py, math.pi / 2),
    ):
        half = np.arccos(np.clip(level / radius, -1.0, 1.0))
        cuts += [np.remainder(turn - half, math.tau), np.remainder(turn + half, math.tau)]
    at = np.sort(np.column_stack(cuts), axis=1)
    begin, extent = at[:, :-1], np.diff(at, axis=1)
    middle = begin + extent / 2
    inside = (np.abs(px[:, None] + radius * np.cos(middle)) < wide[:, None]) & (
        np.abs(py[:, None] + radius * np.sin(middle)) < high[:, None]
    )
    inside &= extent > 0.0
    turned = np.remainder(begin + yaw[:, None], math.tau)
    return np.column_stack([turned[inside], extent[inside]])
