"""Solids at the height of the robot: what of a box, a ball or a mesh it could run into."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.robots.base import TALLEST
from fuzzyq_bullet.scenario.importers.foreign import THIN, Obstacle, rectangle
from fuzzyq_bullet.scenario.importers.gazebo.poses import Matrix

Floats: TypeAlias = NDArray[np.float64]

FLAT = 0.01
"""What is no higher than this (m) lies on the ground, and the robot drives over it."""
_LEVEL = 1e-9
_SAME = 1e-6
"""Outlines that differ by no more than this (m) are one."""
_SIDES = 32
"""Corners of the polygon around a round outline that is no circle."""
_MOST_CORNERS = 100


class NotHere(Exception):  # noqa: N818
    """The robot cannot touch it; the text says why.

    Attributes:
        bottom: How high above the ground it begins (m), if it is above the robot.
    """

    def __init__(self, why: str, bottom: float = math.inf) -> None:
        super().__init__(why)
        self.bottom = bottom


class Solid(NamedTuple):
    """What of a solid the robot could touch.

    Attributes:
        obstacle: Its outline.
        grown: Whether that was grown because it was thin.
        spreads: Whether a taller robot could touch more of it.
    """

    obstacle: Obstacle
    grown: bool = False
    spreads: bool = False


@dataclass(frozen=True)
class Band:
    """The heights that the robot takes up (m).

    Attributes:
        low: Lower end.
        high: Upper end.
    """

    low: float
    high: float

    def refuse(self, bottom: float, top: float) -> None:
        """Make sure that something reaches into it.

        Raises:
            NotHere: If it does not.
        """
        if top <= self.low:
            raise NotHere("lies on the ground or below")
        if bottom >= self.high:
            raise NotHere(f"is above the robot, {self.high:g} m high", bottom)


def box(size: Floats, pose: Matrix, band: Band) -> Solid:
    """Return a box as an obstacle.

    Raises:
        NotHere: If the robot cannot touch it.
    """
    signs = np.array(np.meshgrid(*[(-0.5, 0.5)] * 3)).reshape(3, -1).T
    corners = _moved(signs * size, pose)
    if not _is_upright(pose):
        return hull(corners, pose=None, band=band)
    band.refuse(corners[:, 2].min(), corners[:, 2].max())
    yaw = math.atan2(pose[1, 0], pose[0, 0])
    return Solid(*rectangle(_middle(pose), (float(size[0]), float(size[1])), yaw))


def cylinder(radius: float, length: float, pose: Matrix, band: Band) -> Solid:
    """Return a cylinder as an obstacle.

    Raises:
        NotHere: If the robot cannot touch it.
    """
    if not _is_upright(pose):
        angles = np.arange(_SIDES) * math.tau / _SIDES
        outer = radius / math.cos(math.pi / _SIDES)
        ring = np.column_stack([outer * np.cos(angles), outer * np.sin(angles)])
        ends = [np.column_stack([ring, np.full(_SIDES, z)]) for z in (-length / 2, length / 2)]
        return hull(np.concatenate(ends), pose, band)
    z = float(pose[2, 3])
    band.refuse(z - length / 2, z + length / 2)
    return _circle(_middle(pose), radius)


def ellipsoid(radii: Floats, pose: Matrix, band: Band, stretch: float = 0.0) -> Solid:
    """Return an ellipsoid as an obstacle; a ball as its exact circle.

    Args:
        radii: Shape (3,): half its axes (m).
        pose: Where it is.
        band: The robot's heights.
        stretch: How far its halves are apart along z (m): a capsule's length.

    Raises:
        NotHere: If the robot cannot touch it.
    """
    if stretch == 0.0 and np.ptp(radii) == 0.0:
        radius, z = float(radii[0]), float(pose[2, 3])
        band.refuse(z - radius, z + radius)
        off = z - min(max(z, band.low), band.high)
        found = _circle(_middle(pose), math.sqrt(radius * radius - off * off))
        return found._replace(spreads=z > band.high)
    up = np.linspace(-math.pi / 2, math.pi / 2, _SIDES + 1)
    around = np.arange(_SIDES) * math.tau / _SIDES
    a, b = map(np.ravel, np.meshgrid(up, around))
    outer = 1 / math.cos(math.pi / _SIDES) ** 2
    points = np.column_stack([np.cos(a) * np.cos(b), np.cos(a) * np.sin(b), np.sin(a)]) * outer
    points = points * radii
    points[:, 2] += np.where(np.sin(a) < 0, -stretch / 2, stretch / 2)
    return hull(points, pose, band)


def prism(points: Floats, height: float, pose: Matrix, band: Band) -> Solid:
    """Return an upright prism over a polygon, its foot at the pose, as an obstacle.

    Raises:
        NotHere: If the robot cannot touch it, or it is tilted.
    """
    if not _is_upright(pose) or pose[2, 2] < 0.0:
        raise NotHere("is a polyline that does not stand upright")
    band.refuse(float(pose[2, 3]), float(pose[2, 3]) + height)
    flat = np.column_stack([points, np.zeros(len(points))])
    return Solid({"shape": "polygon", "points": _pairs(_moved(flat, pose)[:, :2])})


def hull(points: Floats, pose: Matrix | None, band: Band) -> Solid:
    """Return the convex outline of a convex solid at the robot's heights.

    Args:
        points: Shape (N, 3): whatever it is the convex hull of.
        pose: Where it is; None if the points are there already.
        band: The robot's heights.

    Raises:
        NotHere: If the robot cannot touch it.
    """
    from scipy.spatial import ConvexHull

    there = points if pose is None else _moved(points, pose)
    return outline(there, ConvexHull(there).simplices, band)


def outline(points: Floats, triangles: NDArray[Any], band: Band) -> Solid:
    """Return the convex outline of a surface that hangs together, at the robot's heights.

    Args:
        points: Shape (N, 3).
        triangles: Shape (M, 3): corners of its triangles.
        band: The robot's heights.

    Raises:
        NotHere: If the robot cannot touch it.
    """
    import shapely

    heights = points[np.unique(triangles), 2]
    band.refuse(float(heights.min()), float(heights.max()))
    around = _around(points, triangles, band)
    spreads = False
    if heights.max() > band.high:
        whole = _around(points, triangles, Band(band.low, max(band.high, TALLEST)))
        spreads = not whole.within(around.buffer(_SAME))
    if not isinstance(around, shapely.Polygon):
        flat = around.buffer(THIN / 2, cap_style="square", join_style="mitre")
        return Solid(_polygon(flat), grown=True, spreads=spreads)
    rectangle_around: Any = around.minimum_rotated_rectangle
    corners = np.array(rectangle_around.exterior.coords)
    sides = np.linalg.norm(np.diff(corners[:3], axis=0), axis=1)
    if sides.min() < THIN:
        grown = around.buffer(THIN / 2, join_style="mitre")
        return Solid(_polygon(grown), grown=True, spreads=spreads)
    # Without the corners that rounding alone has made; a round mesh loses up to 1 mm.
    fine = len(around.exterior.coords) <= _MOST_CORNERS
    return Solid(_polygon(around.simplify(1e-6 if fine else 0.001)), spreads=spreads)


def _around(points: Floats, triangles: NDArray[Any], band: Band) -> Any:
    """Return the convex outline of a surface within a band; a line or a point if it is so thin."""
    import shapely

    own = points[np.unique(triangles)]
    found = [own[(own[:, 2] >= band.low) & (own[:, 2] <= band.high), :2]]
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    a, b = points[edges[:, 0]], points[edges[:, 1]]
    for level in (band.low, band.high):
        crossing = (a[:, 2] - level) * (b[:, 2] - level) < 0.0
        p, q = a[crossing], b[crossing]
        part = (level - p[:, 2]) / (q[:, 2] - p[:, 2])
        found.append((p + part[:, None] * (q - p))[:, :2])
    return shapely.MultiPoint(np.concatenate(found)).convex_hull


def _polygon(shape: Any) -> Obstacle:
    return {"shape": "polygon", "points": _pairs(np.array(shape.exterior.coords)[:-1])}


def _pairs(points: Floats) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in points]


def _circle(position: tuple[float, float], radius: float) -> Solid:
    one = {"shape": "cylinder", "position": position, "radius": max(radius, THIN)}
    return Solid(one, grown=radius < THIN)


def _moved(points: Floats, pose: Matrix) -> Floats:
    moved: Floats = points @ pose[:3, :3].T + pose[:3, 3]
    return moved


def _middle(pose: Matrix) -> tuple[float, float]:
    return float(pose[0, 3]), float(pose[1, 3])


def _is_upright(pose: Matrix) -> bool:
    return bool(abs(abs(pose[2, 2]) - 1.0) < _LEVEL)
