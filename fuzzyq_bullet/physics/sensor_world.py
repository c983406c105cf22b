"""A world to be seen: the upright faces of obstacles and walls, and the rays that meet them.

A ray against a triangle mesh costs a fifth of a ray against the same convex shapes. Only rays meet
these meshes; the robot's body meets the exact shapes of ``physics.obstacle_urdf``.

All rays run level, at one height. So a face needs no more than one triangle, that stands on this
height and is there as wide as the face: half as many as would fill it, and a faster search.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import IntFlag
from operator import itemgetter
from typing import TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.lent import lent
from fuzzyq_bullet.physics.movers import Movers
from fuzzyq_bullet.physics.obstacle_urdf import OBSTACLE_HEIGHT
from fuzzyq_bullet.robots import FUZZYQ, RobotModel
from fuzzyq_bullet.scenario.movers import moves
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Shape

Point: TypeAlias = tuple[float, float, float]
Outline = NDArray[np.float64]
Mesh = tuple[list[list[float]], list[int]]

MOST_RAYS = 16_384
"""Most rays that PyBullet casts at once."""
MESH_CORNERS = 30_000
"""Most corners of one mesh; PyBullet silently drops vertices beyond 131072."""

_FRACTION = itemgetter(2)
"""Of what PyBullet tells of a ray: where it ended as a part of its length."""
_Self = TypeVar("_Self", bound="SensorWorld")


class Group(IntFlag):
    """Collision groups: what a body belongs to, and in masks what it meets."""

    RAYS = 1  # PyBullet's own: every ray belongs to it and hits only what admits it
    WHEELS = 2
    BODY = 4
    OBSTACLES = 8
    WALLS = 16
    GROUND = 32
    FACES = 64


_FACES = int(Group.FACES)


class SensorWorld:
    """A world to look at and not to touch: all that the kinematic drive needs.

    Close it, or use it as a context manager.

    Args:
        obstacles: All obstacles, already validated.
        arena: The rectangle, with or without walls.
        engine: An engine to build in, emptied first; by default a new one that is owned.
        model: The robot that looks around.

    Attributes:
        obstacles: What it was built of.
        arena: Likewise.
        field: The exact geometry of all obstacles that stand still, and of the walls.
        standing: The index of each obstacle of the field among all obstacles.
        movers: All obstacles that move.
    """

    def __init__(
        self,
        obstacles: Sequence[Shape],
        arena: Arena,
        *,
        engine: Engine | None = None,
        model: RobotModel = FUZZYQ,
    ) -> None:
        self.obstacles, self.arena = tuple(obstacles), arena
        self.model = model
        self.standing = tuple(i for i, one in enumerate(obstacles) if not moves(one))
        still = [obstacles[i] for i in self.standing]
        self.field = Field.of(still, arena)
        self.movers = Movers(self.obstacles, arena)
        self._owns_engine = engine is None
        self.engine = engine or Engine()
        self.engine.reset()
        self._api = self.engine.api
        self._build(still, arena)
        self.movers.start(0)

    def cast(self, starts: Sequence[Point], ends: Sequence[Point]) -> list[float]:
        """Cast rays against the faces of everything; level, at the height of the robot's sensor.

        Args:
            starts: Where they start (m).
            ends: Where they end at the latest (m), as many.

        Returns:
            The part of each ray that is free, in [0, 1]; 1 where it meets nothing.
        """
        told: list[float] = []
        self.movers.show()
        for k in range(0, len(starts), MOST_RAYS):
            hits = self._api.rayTestBatch(
                starts[k : k + MOST_RAYS],
                ends[k : k + MOST_RAYS],
                collisionFilterMask=_FACES,
                physicsClientId=self.engine.client,
            )
            told += map(_FRACTION, hits)
        return told

    def close(self) -> None:
        """Free the engine if it was made here."""
        if self._owns_engine:
            self.engine.close()

    def __enter__(self: _Self) -> _Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _build(self, obstacles: Sequence[Shape], arena: Arena) -> None:
        """Put all that is to be there into the engine."""
        for mesh in meshes(obstacles, arena):
            self._group(self._build_faces(*mesh), -1, Group.FACES, Group.RAYS)
        self.movers.build(self.engine, self.model.sensor_height)
        for one in self.movers.members:
            one.faces = self._build_faces(*_mesh([one.shape.faces() - one.shape.position]))
            self._group(one.faces, -1, Group.FACES, Group.RAYS)

    def index_of(self, nearest: int) -> int:
        """Return which obstacle the field means by a number; a wall stays a wall."""
        return nearest if nearest < 0 else self.standing[nearest]

    def _group(self, body: int, link: int, group: Group, mask: Group) -> None:
        """Say what a link of a body belongs to, and what it meets."""
        self._api.setCollisionFilterGroupMask(
            body, link, int(group), int(mask), physicsClientId=self.engine.client
        )

    def _build_faces(self, vertices: list[list[float]], triangles: list[int]) -> int:
        client = self.engine.client
        with lent(vertices, triangles) as (corners, indices):
            shape = self._api.createCollisionShape(
                self._api.GEOM_MESH,
                vertices=corners,
                indices=indices,
                flags=self._api.GEOM_FORCE_CONCAVE_TRIMESH,
                physicsClientId=client,
            )
        body: int = self._api.createMultiBody(
            0.0,
            shape,
            basePosition=(0.0, 0.0, self.model.sensor_height),
            useMaximalCoordinates=True,
            physicsClientId=client,
        )
        return body


def meshes(obstacles: Sequence[Shape], arena: Arena) -> Iterator[Mesh]:
    """Yield vertices and triangle indices of meshes that together show every face."""
    outlines = [obstacle.faces() for obstacle in obstacles]
    if arena.walls:
        outlines.append(np.array(arena.bounds.corners))
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
