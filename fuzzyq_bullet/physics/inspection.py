"""A world that can be looked into: what rays see, what solids are there, what the body touches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fuzzyq_bullet.geometry import Floats
from fuzzyq_bullet.physics.sensor_world import Group
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Shape

_SOLIDS = Group.OBSTACLES | Group.WALLS


class Inspection(World):
    """A world whose solids can be met by rays too; nothing is driven in it."""

    def _build(self, obstacles: Sequence[Shape], arena: Arena) -> None:
        super()._build(obstacles, arena)
        if self.obstacle_body is not None:
            self._group(self.obstacle_body, -1, Group.OBSTACLES, Group.BODY | Group.RAYS)
        if self.walls is not None:
            self._group(self.walls, -1, Group.WALLS, Group.BODY | Group.RAYS)

    def seen(self, starts: Floats, ends: Floats) -> Floats:
        """Return how far (m) rays get before they meet a face, shape (K,); their length at most.

        Args:
            starts: Where they start (m), shape (K, 2).
            ends: Where they end at the latest (m), likewise.
        """
        return self._reach(starts, ends, self.model.sensor_height, Group.FACES)

    def solid(self, starts: Floats, ends: Floats) -> Floats:
        """Return how far (m) rays get before they meet a solid, at any height of the body.

        Args:
            starts: As in ``seen``.
            ends: Likewise.
        """
        low, middle, high = 0.025, self.model.sensor_height, self.model.height - 0.005
        reaches = [self._reach(starts, ends, z, _SOLIDS) for z in (low, middle, high)]
        least: Floats = np.min(reaches, axis=0)
        return least

    def gap(self, x: float, y: float, heading: float) -> float:
        """Return the least distance (m) of the body, put there, to any solid; negative inside it.

        What is farther than 0.1 m is told as infinite.
        """
        self.robot.place(x, y, heading)
        client = self.engine.client
        gaps = [
            point[8]
            for body in (self.obstacle_body, self.walls)
            if body is not None
            for point in self._api.getClosestPoints(
                self.robot.body, body, 0.1, linkIndexA=-1, physicsClientId=client
            )
        ]
        return min(gaps, default=float("inf"))

    def _reach(self, starts: Floats, ends: Floats, z: float, group: Group) -> Floats:
        level = np.full((len(starts), 1), z)
        hits = self._api.rayTestBatch(
            np.hstack([starts, level]).tolist(),
            np.hstack([ends, level]).tolist(),
            collisionFilterMask=int(group),
            physicsClientId=self.engine.client,
        )
        lengths: Floats = np.hypot(*(ends - starts).T)
        reached: Floats = lengths * np.array([hit[2] for hit in hits])
        return reached
