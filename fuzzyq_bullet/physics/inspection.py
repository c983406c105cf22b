"""A world that can be looked into: what rays see, what solids are there, what the body touches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from fuzzyq_bullet.geometry import Floats
from fuzzyq_bullet.physics.sensor_world import Group
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.robots.made_urdf import GROUND_CLEARANCE
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Shape

_ROD = 0.01
"""Radius of the rod (m)."""
_SOLIDS = Group.OBSTACLES | Group.WALLS


class Inspection(World):
    """A world whose solids can be met by rays too; nothing is driven in it."""

    FAR: ClassVar[float] = 0.1
    """Distance (m) up to which ``gap`` and ``rod_gap`` look."""

    def _build(self, obstacles: Sequence[Shape], arena: Arena) -> None:
        super()._build(obstacles, arena)
        self._rod = self._build_rod()
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

        What is farther than ``FAR`` is told as infinite.
        """
        self.robot.place(x, y, heading)
        return self._gap(self.robot.body, None if self._any_link else -1)

    def rod_gap(self, x: float, y: float) -> float:
        """Return the distance (m) from a point to the nearest solid at any height of the body.

        It is that of the axis of a thin upright rod that stands there, 0 within half its thickness;
        infinite if it is farther than ``FAR``.
        """
        z = (GROUND_CLEARANCE + self.model.height) / 2
        self._api.resetBasePositionAndOrientation(
            self._rod, (x, y, z), (0, 0, 0, 1), physicsClientId=self.engine.client
        )
        return max(0.0, self._gap(self._rod, -1) + _ROD)

    def _gap(self, body: int, link: int | None) -> float:
        """Return the least distance (m) of a link, or a whole body, to any solid."""
        only = {} if link is None else {"linkIndexA": link}
        gaps = [
            point[8]
            for other in (self.obstacle_body, self.walls)
            if other is not None
            for point in self._api.getClosestPoints(
                body, other, self.FAR, physicsClientId=self.engine.client, **only
            )
        ]
        return min(gaps, default=math.inf)

    def _build_rod(self) -> int:
        client = self.engine.client
        shape = self._api.createCollisionShape(
            self._api.GEOM_CYLINDER,
            radius=_ROD,
            height=self.model.height - GROUND_CLEARANCE,
            physicsClientId=client,
        )
        rod: int = self._api.createMultiBody(0.0, shape, physicsClientId=client)
        return rod

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
