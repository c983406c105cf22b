"""What the rays see: the upright faces of all obstacles and walls, as triangle meshes.

A ray against a triangle mesh costs a fifth of a ray against the same convex shapes. Only rays meet
these meshes; the robot's body meets the exact shapes of ``physics.obstacle_urdf``.

All rays run level, at one height. So a face needs no more than one triangle, that stands on this
height and is there as wide as the face: half as many as would fill it, and a faster search.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.physics.obstacle_urdf import OBSTACLE_HEIGHT
from fuzzyq_bullet.scenario.models import Arena
from fuzzyq_bullet.shapes import Shape

MESH_CORNERS = 30_000
"""Most corners of one mesh; PyBullet silently drops vertices beyond 131072."""

Outline = NDArray[np.float64]
Mesh = tuple[list[list[float]], list[int]]


def meshes(obstacles: Sequence[Shape], arena: Arena) -> Iterator[Mesh]:
    """Yield vertices and triangle indices of meshes that together show every face."""
    outlines = [obstacle.faces() for obstacle in obstacles]
    if arena.walls:
        width, depth = arena.size
        outlines.append(np.array([(0, 0), (width, 0), (width, depth), (0, depth)], dtype=float))
    batch: list[Outline] = []
    corners = 0
    for outline in outlines:
        if batch and corners + len(outline) > MESH_CORNERS:
            yield _mesh(batch)
            batch, corners = [], 0
        batch.append(outline)
        corners += len(outline)
    if batch:
        yield _mesh(batch)


def _mesh(outlines: Sequence[Outline]) -> Mesh:
    """Return the upright faces over several closed outlines as one mesh, as they are at z = 0."""
    ground = np.concatenate(outlines)
    count = len(ground)
    following = np.arange(1, count + 1)
    ends = np.cumsum([len(outline) for outline in outlines])
    following[ends - 1] = ends - [len(outline) for outline in outlines]  # close each outline
    here = np.arange(count)
    # Vertex i lies at z = 0, vertex i + count above it.
    triangles = np.column_stack([here, following, here + count])
    vertices = np.vstack(
        [
            np.column_stack([ground, np.zeros(count)]),
            np.column_stack([ground, np.full(count, OBSTACLE_HEIGHT)]),
        ]
    )
    return vertices.tolist(), triangles.ravel().tolist()
