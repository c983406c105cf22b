"""The simulated world: ground, static obstacles, walls, one robot, and the truth about contacts."""

from __future__ import annotations

import math
from collections.abc import Sequence

from fuzzyq_bullet.physics.engine import TIME_STEP, Contact
from fuzzyq_bullet.physics.groups import Group
from fuzzyq_bullet.physics.robot import Robot
from fuzzyq_bullet.physics.sight import SENSOR_MARGIN, Sight
from fuzzyq_bullet.physics.static import obstacles_urdf, walls_urdf
from fuzzyq_bullet.scenario.models import Arena
from fuzzyq_bullet.shapes import Shape

CLEARANCE_RANGE = 2.0
"""Longest clearance told (m); beyond it the clearance is infinite."""


class World(Sight):
    """One world with one robot. Close it, or use it as a context manager.

    Args:
        obstacles: All obstacles, already validated.
        arena: The rectangle, with or without walls.
        engine: An engine to build in, emptied first; by default a new one that the world owns.
        model: The robot.
    """

    def _build(self, obstacles: Sequence[Shape], arena: Arena) -> None:
        # The order of loading is part of the trajectory: ground, obstacles, walls, faces, robot.
        ground = self._build_ground()
        self._obstacles = self.engine.load_text(*obstacles_urdf(obstacles)) if obstacles else None
        self.walls = self.engine.load_text(walls_urdf(arena)) if arena.walls else None
        super()._build(obstacles, arena)
        self.robot = Robot(self.engine, self.model)
        self._last_clearance = CLEARANCE_RANGE
        self._last_asked = (math.nan, math.nan)

        self._group(ground, -1, Group.GROUND, Group.WHEELS)
        self._group(self.robot.body, -1, Group.BODY, Group.OBSTACLES | Group.WALLS)
        for link in self.robot.links:
            self._group(self.robot.body, link, Group.WHEELS, Group.GROUND)
        if self._obstacles is not None:
            self._group(self._obstacles, -1, Group.OBSTACLES, Group.BODY)
        if self.walls is not None:
            self._group(self.walls, -1, Group.WALLS, Group.BODY)

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
        surely = max(0, min(steps, apart))
        for _ in range(surely):
            step(client)
        for taken in range(surely + 1, steps + 1):
            step(client)
            points = touching(body, -1, -1, -2, client)
            if points:
                strongest = max(points, key=lambda point: point[9])
                if strongest[9] > 0.0:
                    return taken, Contact(strongest[2], strongest[6], strongest[9])
        return steps, None

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
        width, depth = self.arena.size
        near_wall = min(x, width - x, y, depth - y) - self.model.radius <= search
        nearest = math.inf
        for body in (self._obstacles, self.walls if near_wall else None):
            if body is not None:
                for point in self._api.getClosestPoints(
                    self.robot.body, body, search, -1, -1, physicsClientId=self.engine.client
                ):
                    nearest = min(nearest, point[8])
        self._last_clearance, self._last_asked = nearest, (x, y)
        return nearest

    def _build_ground(self) -> int:
        client = self.engine.client
        plane = self._api.createCollisionShape(self._api.GEOM_PLANE, physicsClientId=client)
        ground: int = self._api.createMultiBody(0.0, plane, physicsClientId=client)
        self._api.changeDynamics(ground, -1, lateralFriction=1.0, physicsClientId=client)
        return ground


__all__ = ["SENSOR_MARGIN", "TIME_STEP", "Group", "World"]
