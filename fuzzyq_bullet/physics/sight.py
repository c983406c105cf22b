"""What the robot can see of a world: rays against the faces of obstacles and walls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import itemgetter
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.groups import Group
from fuzzyq_bullet.physics.lines import LineBundle
from fuzzyq_bullet.physics.sensing import meshes
from fuzzyq_bullet.robots import FUZZYQ, RobotModel
from fuzzyq_bullet.scenario.models import Arena
from fuzzyq_bullet.shapes import ROUNDNESS, Shape

SENSOR_MARGIN = 0.02
"""How much wider than the robot a detection line is, on either side (m)."""

_FACES = int(Group.FACES)
_FRACTION = itemgetter(2)
"""Of what PyBullet tells of a ray: where it ended as a part of its length."""
_BESIDE = SENSOR_MARGIN + 5.0 * ROUNDNESS
"""How near a thing may be in a line's margin (m), where no face is long; round ones reach a little
beyond the circle."""
_BEYOND = 2e-4
"""A ray also meets what lies a little beyond the ends of a face: by 1e-4 of its length."""
_Self = TypeVar("_Self", bound="Sight")


class Sight:
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
        field: The exact geometry of all obstacles and walls.
        beside: What is no nearer to the robot's body than this (m) stands in no line's margin: the
            faces that rays meet reach a little beyond what is really there.
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
        self.field = Field.of(obstacles, arena)
        self._owns_engine = engine is None
        self.engine = engine or Engine()
        self.engine.reset()
        self._api = self.engine.api
        self._lines = LineBundle(
            model.radius, SENSOR_MARGIN, model.sensor_range, model.sensor_height
        )
        self.beside = _BESIDE + _BEYOND * max(
            (group.longest_face for group in self.field.groups), default=0.0
        )
        self._build(obstacles, arena)

    def sense(
        self, origin: tuple[float, float], headings: Sequence[float], *, apart: float = 0.0
    ) -> list[float]:
        """Return how far the robot's disc could move from ``origin`` along each heading.

        Args:
            origin: Centre of the robot (m).
            headings: World headings (rad), at least one and at most 1000.
            apart: By how much the robot is surely apart from everything (m). It changes nothing
                that is told: rays that could meet nothing are not cast.

        Returns:
            Free travel (m), one for each, in [0, ``model.sensor_range``].
        """
        probes = apart < self.beside
        start, stop = self._lines.rays(origin, headings, probes=probes)
        hits = self._api.rayTestBatch(
            start, stop, collisionFilterMask=_FACES, physicsClientId=self.engine.client
        )
        return self._lines.travel(list(map(_FRACTION, hits)), probes=probes)

    def look(self, origin: tuple[float, float], headings: Sequence[float]) -> NDArray[np.float64]:
        """Return the distance (m) from ``origin`` to what stands there along each heading.

        Args:
            origin: Centre of the robot (m).
            headings: World headings (rad), at least one and at most 1000.

        Returns:
            Shape (K,), each in [0, ``model.sensor_range`` + radius + margin].
        """
        height = self.model.sensor_height
        reach = self.model.sensor_range + self.model.radius + SENSOR_MARGIN
        x, y = origin
        stop = [(x + reach * math.cos(one), y + reach * math.sin(one), height) for one in headings]
        hits = self._api.rayTestBatch(
            [(x, y, height)] * len(stop),
            stop,
            collisionFilterMask=_FACES,
            physicsClientId=self.engine.client,
        )
        return reach * np.array(list(map(_FRACTION, hits)))

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

    def _group(self, body: int, link: int, group: Group, mask: Group) -> None:
        """Say what a link of a body belongs to, and what it meets."""
        self._api.setCollisionFilterGroupMask(
            body, link, int(group), int(mask), physicsClientId=self.engine.client
        )

    def _build_faces(self, vertices: list[list[float]], triangles: list[int]) -> int:
        client = self.engine.client
        shape = self._api.createCollisionShape(
            self._api.GEOM_MESH,
            vertices=vertices,
            indices=triangles,
            flags=self._api.GEOM_FORCE_CONCAVE_TRIMESH,
            physicsClientId=client,
        )
        # PyBullet never lets go of the two lists. Emptied, they cost a fifth of the megabyte that
        # every world of a long training would otherwise leave behind.
        for vertex in vertices:
            vertex.clear()
        vertices.clear()
        triangles.clear()
        body: int = self._api.createMultiBody(
            0.0, shape, basePosition=(0.0, 0.0, self.model.sensor_height), physicsClientId=client
        )
        return body
