"""Everything that never moves, as URDF text: all obstacles in one body, all walls in another.

One link with many ``<collision>`` elements is the fastest static world PyBullet has: a step costs
nearly the same at 1000 obstacles as at none.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Shape

OBSTACLE_HEIGHT = 0.4
"""Height of every obstacle (m): well above the robot."""
WALL_HEIGHT = 0.25
WALL_THICKNESS = 0.1


def obstacles_urdf(obstacles: Sequence[Shape]) -> tuple[str, dict[str, str]]:
    """Return a URDF with one link that holds collision shapes for every obstacle.

    Returns:
        The text, and the mesh files beside it that it names, text by name.
    """
    shapes: list[str] = []
    meshes: dict[str, str] = {}
    for obstacle in obstacles:
        for solid in obstacle.collisions(OBSTACLE_HEIGHT):
            geometry = solid.geometry
            if solid.mesh:
                name = f"{len(meshes)}.obj"
                meshes[name] = solid.mesh
                geometry = f'<mesh filename="{name}"/>'
            shapes.append(_shape(*obstacle.position, OBSTACLE_HEIGHT, solid.yaw, geometry))
    return _static("obstacles", shapes), meshes


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
