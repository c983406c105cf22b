"""Solids at the height of the robot: what of a box, a ball or a mesh it could run into."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.scenario.importers.foreign import THIN, Obstacle, rectangle
from fuzzyq_bullet.scenario.importers.gazebo.poses import Matrix

Floats: TypeAlias = NDArray[np.float64]

FLAT = 0.01
"""What is no higher than this (m) lies on the ground, and the robot drives over it."""
_LEVEL = 1e-9
_SIDES = 32
"""Corners of the polygon around a round outline that is no circle."""
_MOST_CORNERS = 100


class NotHere(Exception):  # noqa: N818
    """The robot cannot touch it; the text says why."""


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
            raise NotHere(f"is above the robot, {self.high:g} m high")


def box(size: Floats, pose: Matrix, band: Band) -> tuple[Obstacle, bool]:
    """Return a box as an obstacle, and whether it was grown because it was thin.

    Raises:
        NotHere: If the robot cannot touch it.
    """
    signs = np.array(np.meshgrid(*[(-0.5, 0.5)] * 3)).reshape(3, -1).T
    corners = _moved(signs * size, pose)
    if not _is_upright(pose):
        return hull(corners, pose=None, band=band)
    band.refuse(corners[:, 2].min(), corners[:, 2].max())
    yaw = math.atan2(pose[1, 0], pose[0, 0])
    return rectangle(_middle(pose), (float(size[0]), float(size[1])), yaw)


def cylinder(radius: float, length: float, pose: Matrix, band: Band) -> tuple[Obstacle, bool]:
    """Return a cylinder as an obstacle, and whether it was grown.

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


def ellipsoid(
    radii: Floats, pose: Matrix, band: Band, stretch: float = 0.0
) -> tuple[Obstacle, bool]:
    """Return an ellipsoid as an obstacle, and whether it was grown; a ball as its exact circle.

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
        return _circle(_middle(pose), math.sqrt(radius * radius - off * off))
    up = np.linspace(-math.pi / 2, math.pi / 2, _SIDES + 1)
    around = np.arange(_SIDES) * math.tau / _SIDES
    a, b = map(np.ravel, np.meshgrid(up, around))
    outer = 1 / math.cos(math.pi / _SIDES) ** 2
    points = np.column_stack([np.cos(a) * np.cos(b), np.cos(a) * np.sin(b), np.sin(a)]) * outer
    points = points * radii
    points[:, 2] += np.where(np.sin(a) < 0, -stretch / 2, stretch / 2)
    return hull(points, pose, band)


def prism(points: Floats, height: float, pose: Matrix, band: Band) -> Obstacle:
    """Return an upright prism over a polygon, its foot at the pose, as an obstacle.

    Raises:
        NotHere: If the robot cannot touch it, or it is tilted.
    """
    if not _is_upright(pose) or pose[2, 2] < 0.0:
        raise NotHere("is a polyline that does not stand upright")
    band.refuse(float(pose[2, 3]), float(pose[2, 3]) + height)
    flat = np.column_stack([points, np.zeros(len(points))])
    return {"shape": "polygon", "points": _pairs(_moved(flat, pose)[:, :2])}


def hull(points: Floats, pose: Matrix | None, band: Band) -> tuple[Obstacle, bool]:
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
    band.refuse(there[:, 2].min(), there[:, 2].max())
    found = outline(there, ConvexHull(there).simplices, band)
    assert found is not None  # it reaches into the band, and is convex
    return found


def outline(points: Floats, triangles: NDArray[Any], band: Band) -> tuple[Obstacle, bool] | None:
    """Return the convex outline of a surface at the robot's heights, and whether it was grown.

    Args:
        points: Shape (N, 3).
        triangles: Shape (M, 3): corners of its triangles.
        band: The robot's heights.

    Returns:
        None if nothing of it is there.
    """
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
    flat = np.concatenate(found)
    if not len(flat):
        return None
    around: Any = shapely.MultiPoint(flat).convex_hull
    if not isinstance(around, shapely.Polygon):
        return _polygon(around.buffer(THIN / 2, cap_style="square", join_style="mitre")), True
    rectangle_around: Any = around.minimum_rotated_rectangle
    corners = np.array(rectangle_around.exterior.coords)
    sides = np.linalg.norm(np.diff(corners[:3], axis=0), axis=1)
    if sides.min() < THIN:
        return _polygon(around.buffer(THIN / 2, join_style="mitre")), True
    # Without the corners that rounding alone has made; a round mesh loses up to 1 mm.
    fine = len(around.exterior.coords) <= _MOST_CORNERS
    return _polygon(around.simplify(1e-6 if fine else 0.001)), False


def _polygon(shape: Any) -> Obstacle:
    return {"shape": "polygon", "points": _pairs(np.array(shape.exterior.coords)[:-1])}


def _pairs(points: Floats) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in points]


def _circle(position: tuple[float, float], radius: float) -> tuple[Obstacle, bool]:
    one = {"shape": "cylinder", "position": position, "radius": max(radius, THIN)}
    return one, radius < THIN


def _moved(points: Floats, pose: Matrix) -> Floats:
    moved: Floats = points @ pose[:3, :3].T + pose[:3, 3]
    return moved


def _middle(pose: Matrix) -> tuple[float, float]:
    return float(pose[0, 3]), float(pose[1, 3])


def _is_upright(pose: Matrix) -> bool:
    return bool(abs(abs(pose[2, 2]) - 1.0) < _LEVEL)
