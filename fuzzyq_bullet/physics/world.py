"""The simulated world: ground, static obstacles, walls, one robot, and the truth about contacts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import IntFlag

import numpy as np

from fuzzyq_bullet.physics.engine import TIME_STEP, Contact, Engine
from fuzzyq_bullet.physics.lines import Floats, LineBundle
from fuzzyq_bullet.physics.robot import BODY_HEIGHT, Robot
from fuzzyq_bullet.physics.sensing import meshes
from fuzzyq_bullet.physics.static import obstacles_urdf, walls_urdf
from fuzzyq_bullet.scenario.models import ROBOT_RADIUS, Arena, Box, Cylinder

SENSOR_RANGE = 1.0
"""Longest distance a detection line tells (m): 5·S_p."""
SENSOR_MARGIN = 0.02
"""How much wider than the robot a detection line is, on either side (m)."""
CLEARANCE_RANGE = 2.0
"""Longest clearance told (m); beyond it the clearance is infinite."""


class Group(IntFlag):
    """Collision groups: who may touch whom, and what a ray may hit."""

    RAYS = 1  # PyBullet's own: every ray belongs to it and hits only what admits it
    WHEELS = 2
    BODY = 4
    OBSTACLES = 8
    WALLS = 16
    GROUND = 32
    FACES = 64


_FACES = int(Group.FACES)


class World:
    """One world with one robot. Close it, or use it as a context manager.

    Args:
        obstacles: All obstacles, already validated.
        arena: The rectangle, with or without walls.
        engine: An engine to build in, emptied first; by default a new one that the world owns.
    """

    def __init__(
        self,
        obstacles: Sequence[Cylinder | Box],
        arena: Arena,
        *,
        engine: Engine | None = None,
    ) -> None:
        self._owns_engine = engine is None
        self._arena = arena
        self.engine = engine or Engine()
        self.engine.reset()
        self._api = self.engine.api
        # The order of loading is part of the trajectory: ground, obstacles, walls, faces,
        # robot.
        self._ground = self._build_ground()
        self._obstacles = self.engine.load_text(obstacles_urdf(obstacles)) if obstacles else None
        self.walls = self.engine.load_text(walls_urdf(arena)) if arena.walls else None
        self._faces = [self._build_faces(*mesh) for mesh in meshes(obstacles, arena)]
        self.robot = Robot(self.engine)
        self._group()
        self._lines = LineBundle(ROBOT_RADIUS, SENSOR_MARGIN, SENSOR_RANGE, BODY_HEIGHT)
        self._last_clearance = CLEARANCE_RANGE
        self._last_asked = (math.nan, math.nan)

    def advance(self, steps: int, *, apart: int = 0) -> tuple[int, Contact | None]:
        """Advance the physics, looking for contact after every step.

        A contact counts when it carries a force; of several the strongest is returned.

        Args:
            steps: Physics steps to take.
            apart: For how many of them the robot surely touches nothing, because nothing is near
                enough; there is no contact to look for in these.

        Returns:
            Steps taken, fewer than asked when the robot's body touched something, and the contact.
        """
        # Arguments by position: this is the innermost loop, and keywords cost a microsecond.
        step, touching = self._api.stepSimulation, self._api.getContactPoints
        body, client = self.robot.body, self.engine.client
        for taken in range(1, steps + 1):
            step(client)
            if taken <= apart:
                continue
            points = touching(body, -1, -1, -2, client)
            if points:
                strongest = max(points, key=lambda point: point[9])
                if strongest[9] > 0.0:
                    return taken, Contact(strongest[2], strongest[6], strongest[9])
        return steps, None

    def sense(self, origin: tuple[float, float], headings: Sequence[float]) -> Floats:
        """Return how far the robot's disc could move from ``origin`` along each heading.

        Args:
            origin: Centre of the robot (m).
            headings: World headings (rad), at least one and at most 1000.

        Returns:
            Free travel (m), shape (K,), in [0, ``SENSOR_RANGE``].
        """
        start, stop = self._lines.rays(origin, headings)
        hits = self._api.rayTestBatch(
            start, stop, collisionFilterMask=_FACES, physicsClientId=self.engine.client
        )
        return self._lines.travel([hit[2] for hit in hits])

    def look(self, origin: tuple[float, float], headings: Sequence[float]) -> Floats:
        """Return the distance (m) from ``origin`` to what stands there along each heading.

        Args:
            origin: Centre of the robot (m).
            headings: World headings (rad), at least one and at most 1000.

        Returns:
            Shape (K,), each in [0, ``SENSOR_RANGE + ROBOT_RADIUS + SENSOR_MARGIN``].
        """
        reach = SENSOR_RANGE + ROBOT_RADIUS + SENSOR_MARGIN
        x, y = origin
        stop = [
            (x + reach * math.cos(one), y + reach * math.sin(one), BODY_HEIGHT) for one in headings
        ]
        hits = self._api.rayTestBatch(
            [(x, y, BODY_HEIGHT)] * len(stop),
            stop,
            collisionFilterMask=_FACES,
            physicsClientId=self.engine.client,
        )
        return reach * np.array([hit[2] for hit in hits])

    def clearance(self, x: float, y: float) -> float:
        """Return the distance (m) from the robot's body to the nearest obstacle or wall.

        Infinite when nothing is within ``CLEARANCE_RANGE``.

        Args:
            x: Where the robot's centre is now (m).
            y: Where the robot's centre is now (m).
        """
        # The clearance changes by no more than the robot moved: a short search finds it surely.
        moved = math.hypot(x - self._last_asked[0], y - self._last_asked[1])
        search = self._last_clearance + moved + 0.01
        if not search <= CLEARANCE_RANGE:  # also when nothing was asked before
            search = CLEARANCE_RANGE
        width, depth = self._arena.size
        near_wall = min(x, width - x, y, depth - y) - ROBOT_RADIUS <= search
        nearest = math.inf
        for body in (self._obstacles, self.walls if near_wall else None):
            if body is not None:
                for point in self._api.getClosestPoints(
                    self.robot.body, body, search, -1, -1, physicsClientId=self.engine.client
                ):
                    nearest = min(nearest, point[8])
        self._last_clearance, self._last_asked = nearest, (x, y)
        return nearest

    def close(self) -> None:
        """Free the engine if this world made it."""
        if self._owns_engine:
            self.engine.close()

    def __enter__(self) -> World:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _build_ground(self) -> int:
        client = self.engine.client
        plane = self._api.createCollisionShape(self._api.GEOM_PLANE, physicsClientId=client)
        ground: int = self._api.createMultiBody(0.0, plane, physicsClientId=client)
        self._api.changeDynamics(ground, -1, lateralFriction=1.0, physicsClientId=client)
        return ground

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
        body: int = self._api.createMultiBody(0.0, shape, physicsClientId=client)
        return body

    def _group(self) -> None:
        memberships = [
            (self._ground, -1, Group.GROUND, Group.WHEELS),
            (self.robot.body, -1, Group.BODY, Group.OBSTACLES | Group.WALLS),
            *((self.robot.body, link, Group.WHEELS, Group.GROUND) for link in self.robot.links),
            *((faces, -1, Group.FACES, Group.RAYS) for faces in self._faces),
        ]
        if self._obstacles is not None:
            memberships.append((self._obstacles, -1, Group.OBSTACLES, Group.BODY))
        if self.walls is not None:
            memberships.append((self.walls, -1, Group.WALLS, Group.BODY))
        for body, link, group, mask in memberships:
            self._api.setCollisionFilterGroupMask(
                body, link, int(group), int(mask), physicsClientId=self.engine.client
            )


__all__ = ["SENSOR_MARGIN", "SENSOR_RANGE", "TIME_STEP", "Group", "World"]
