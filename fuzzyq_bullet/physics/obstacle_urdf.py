"""Obstacles and walls as URDF text: all that stand in one body, each that moves in its own.

One link with many ``<collision>`` elements is the fastest static world PyBullet has: a step costs
nearly the same at 1000 obstacles as at none.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.quantities import Point
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Shape

OBSTACLE_HEIGHT = 0.4
"""Height of every obstacle (m): well above the robot."""
WALL_HEIGHT = 0.25
WALL_THICKNESS = 0.1
_PRISMS = "prisms.obj"


def obstacles_urdf(obstacles: Sequence[Shape]) -> tuple[str, dict[str, str]]:
    """Return a URDF with one link that holds collision shapes for every obstacle.

    Returns:
        The text, and the mesh files beside it that it names, text by name.
    """
    return _obstacles_urdf([(one, one.position) for one in obstacles])


def mover_urdf(obstacle: Shape) -> tuple[str, dict[str, str]]:
    """Return the same for one obstacle, about its centre."""
    return _obstacles_urdf([(obstacle, (0.0, 0.0))])


def _obstacles_urdf(places: Sequence[tuple[Shape, Point]]) -> tuple[str, dict[str, str]]:
    shapes: list[str] = []
    prisms: list[NDArray[np.float64]] = []
    for obstacle, centre in places:
        for solid in obstacle.collisions(OBSTACLE_HEIGHT):
            if solid.prism is None:
                place = (*centre, OBSTACLE_HEIGHT, solid.yaw)
                shapes.append(_shape(*place, solid.geometry))
            else:
                prisms.append(np.add(solid.prism, (*centre, 0.0)))
    if prisms:
        mesh = f'<mesh filename="{_PRISMS}"/>'
        shapes.append(_shape(0.0, 0.0, OBSTACLE_HEIGHT, 0.0, mesh))
    return _static("obstacles", shapes), {_PRISMS: _obj(prisms)} if prisms else {}


def _obj(prisms: Sequence[NDArray[np.float64]]) -> str:
    """Return an OBJ file of convex prisms: PyBullet makes a convex hull of each of its objects."""
    lines: list[str] = []
    base = 1
    for number, vertices in enumerate(prisms):
        lines.append(f"o {number}")
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
        half = len(vertices) // 2
        lines += [f"f {base + k} {base + (k + 1) % half} {base + k + half}" for k in range(half)]
        base += len(vertices)
    return "\n".join([*lines, ""])


def walls_urdf(arena: Arena) -> str:
    """Return a URDF of the four walls, which stand just outside the arena's rectangle."""
    solids = [
        (x, y, f'<box size="{a!r} {b!r} {WALL_HEIGHT!r}"/>')
        for x, y, a, b in arena.bars(WALL_THICKNESS)
    ]
    return _static("walls", [_shape(x, y, WALL_HEIGHT, 0.0, box) for x, y, box in solids])


def _shape(x: float, y: float, height: float, yaw: float, geometry: str) -> str:
    origin = f'<origin xyz="{x!r} {y!r} {height / 2!r}" rpy="0 0 {yaw!r}"/>'
    return f"<collision>{origin}<geometry>{geometry}</geometry></collision>"


def _static(name: str, shapes: Iterable[str]) -> str:
    # A line of more than about 10 kB is an XML error to PyBullet: a line for every element.
    return "\n".join(
        [
            f'<robot name="{name}"><link name="{name}">',
            '<inertial><mass value="0"/>',
            '<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial>',
            *shapes,
            "</link></robot>",
        ]
    )
