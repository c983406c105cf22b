"""The simulated world: ground, obstacles, walls, one robot, and the truth about contacts."""

from __future__ import annotations

from collections.abc import Sequence

from fuzzyq_bullet.physics.engine import TIME_STEP, Contact
from fuzzyq_bullet.physics.movers import Mover
from fuzzyq_bullet.physics.obstacle_urdf import mover_urdf, obstacles_urdf, walls_urdf
from fuzzyq_bullet.physics.robot import Robot
from fuzzyq_bullet.physics.sensor_world import Group, SensorWorld
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Shape


class World(SensorWorld):
    """One world with one robot. Close it, or use it as a context manager.

    Args:
        obstacles: All obstacles, already validated.
        arena: The rectangle, with or without walls.
        engine: An engine to build in, emptied first; by default a new one that the world owns.
        model: The robot.
    """

    def _build(self, obstacles: Sequence[Shape], arena: Arena) -> None:
        # The order of loading is part of the trajectory: ground, obstacles, walls, faces, movers,
        # robot.
        ground = self._build_ground()
        urdf = obstacles_urdf(obstacles) if obstacles else None
        self.obstacle_body = self.engine.load_text(*urdf) if urdf else None
        self.walls = self.engine.load_text(walls_urdf(arena)) if arena.walls else None
        super()._build(obstacles, arena)
        for one in self.movers.members:
            one.solid = self.engine.load_text(*mover_urdf(one.shape))
            self._group(one.solid, -1, Group.OBSTACLES, Group.BODY)
        self._moving = {one.solid: one for one in self.movers.members}
        self.robot = Robot(self.engine, self.model)

        self._group(ground, -1, Group.GROUND, Group.WHEELS)
        self._ground = ground
        self._any_link = bool(self.model.corners)
        if self._any_link:  # a user's URDF, whose body may be any of its links
            parts = Group.BODY | Group.WHEELS
            for link in (-1, *self.robot.links):
                everything = Group.GROUND | Group.OBSTACLES | Group.WALLS
                self._group(self.robot.body, link, parts, everything)
        else:
            self._group(self.robot.body, -1, Group.BODY, Group.OBSTACLES | Group.WALLS)
            for link in self.robot.links:
                self._group(self.robot.body, link, Group.WHEELS, Group.GROUND)
        if self.obstacle_body is not None:
            self._group(self.obstacle_body, -1, Group.OBSTACLES, Group.BODY)
        if self.walls is not None:
            self._group(self.walls, -1, Group.WALLS, Group.BODY)

    def advance(self, steps: int) -> tuple[int, Contact | None]:
        """Advance the physics, looking for contact after every step.

        A contact counts when it carries a force; of several the strongest is returned. What moves
        by itself may press into a robot without one: there, to overlap counts, too.

        Args:
            steps: Physics steps to take.

        Returns:
            Steps taken, fewer than asked when the robot's body touched something, and the contact.
        """
        # Arguments by position: this is the innermost loop, and keywords cost a microsecond.
        step, touching = self._api.stepSimulation, self._api.getContactPoints
        body, client = self.robot.body, self.engine.client
        link = -2 if self._any_link else -1
        movers = self.movers
        near = self._near() if movers.members else ()
        for taken in range(1, steps + 1):
            if movers.members:
                movers.step(near, TIME_STEP)
            step(client)
            points = touching(body, -1, link, -2, client)
            if self._any_link:
                points = [point for point in points if point[2] not in (self._ground, body)]
            if points:
                strongest = max(points, key=lambda point: point[9])
                if near and strongest[9] <= 0.0:
                    strongest = min(points, key=lambda point: point[8])
                if strongest[9] > 0.0 or (strongest[2] in self._moving and strongest[8] <= 0.0):
                    return taken, Contact(strongest[2], strongest[6], strongest[9])
        return steps, None

    def touched(self, contact: Contact) -> int:
        """Return the index of the obstacle of a contact; −1 for a wall."""
        if contact.body == self.walls:
            return -1
        if (mover := self._moving.get(contact.body)) is not None:
            return mover.index
        x, y, _ = contact.point
        return self.index_of(int(self.field.distances((x, y)).argmin()))

    def _near(self) -> list[tuple[Mover, bool]]:
        """Return the moving obstacles near the robot."""
        if not self.movers.is_due():
            return []
        state = self.robot.state()
        return self.movers.watch((state.x, state.y), self.model.radius)

    def _build_ground(self) -> int:
        client = self.engine.client
        plane = self._api.createCollisionShape(self._api.GEOM_PLANE, physicsClientId=client)
        ground: int = self._api.createMultiBody(0.0, plane, physicsClientId=client)
        self._api.changeDynamics(ground, -1, lateralFriction=1.0, physicsClientId=client)
        return ground
