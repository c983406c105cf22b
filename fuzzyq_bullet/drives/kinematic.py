"""The paper's own point robot: each decision is one jump of Eq. 17, exactly."""

from __future__ import annotations

import math

from fuzzyq_bullet.drives.apart import Apart
from fuzzyq_bullet.drives.base import Tick, longest_step_time
from fuzzyq_bullet.drives.nearby import Nearby
from fuzzyq_bullet.drives.sensor import CastOnce
from fuzzyq_bullet.physics.sight import SENSOR_MARGIN, Sight
from fuzzyq_bullet.planning.base import Decision, Observation
from fuzzyq_bullet.scenario.models import Robot, Scenario
from fuzzyq_bullet.trajectory import Collision

STEP_TIME = longest_step_time(Robot())
"""How long every step lasts (s), whatever the robot's limits: a point that jumps has no speed, so
no limit of it may decide how a run ends."""
ROUNDING = 1e-9
"""More than a clearance may be told too long by rounding (m)."""


class KinematicDriver:
    """Moves by Eq. 17 in the physical world's geometry, sensing with the same rays.

    The robot turns and stops at once. Contact is exact and swept: the disc touches whatever it
    would meet on the straight line of the step, not only at its end.
    """

    def __init__(self, world: Sight, scenario: Scenario) -> None:
        self._world = world
        self._field = field = world.field
        self._goal = scenario.goal
        near = Nearby(field)
        self._radius = radius = scenario.robot.radius
        self._apart = Apart(lambda x, y: near.clearance(x, y) - radius)
        self.steps = 0
        self.collision: Collision | None = None
        self.arrived = False
        self.slowness = 1.0
        self.ticks: list[Tick] = []
        self._record(*scenario.start.position, scenario.start_heading(), 0.0)

    def observe(self) -> Observation:
        """Return the observation of a robot without inertia."""
        now = self.ticks[-1]
        position = (now.x, now.y)
        sensor = CastOnce(self._world, position, self._apart.by(*position, self._world.beside))
        return Observation(
            time=now.time,
            position=position,
            heading=now.heading,
            speed=0.0,
            turn_rate=0.0,
            goal=self._goal.position,
            goal_radius=self._goal.radius,
            range=self._world.model.sensor_range,
            radius=self._radius + SENSOR_MARGIN,
            sense=sensor,
            look=sensor.look,
            unit=self._radius,
        )

    def advance(self, decision: Decision) -> None:
        """Move by one step (Eq. 17); stop at the first thing the disc would touch."""
        now = self.ticks[-1]
        step = decision.step
        free = step
        # What is farther away cannot stop the robot.
        if step >= self._apart.by(now.x, now.y, step + ROUNDING) - ROUNDING:
            [free] = self._field.free_distance(
                (now.x, now.y), decision.heading, self._radius, step
            ).tolist()
        hit = free < step
        moved = min(step, free)
        x = now.x + moved * math.cos(decision.heading)
        y = now.y + moved * math.sin(decision.heading)
        self.steps += 1
        self._record(x, y, decision.heading, moved / STEP_TIME)
        if hit:
            index, touched = self._field.touching((x, y))
            self.collision = Collision(
                time=self.ticks[-1].time, point=touched, obstacle=index, normal_force=0.0
            )
        self.arrived = math.dist((x, y), self._goal.position) <= self._goal.radius

    def _record(self, x: float, y: float, heading: float, speed: float) -> None:
        self.ticks.append(
            Tick(
                time=self.steps * STEP_TIME,
                x=x,
                y=y,
                heading=heading,
                speed=speed,
                turn_rate=0.0,
                left_wheel=0.0,
                right_wheel=0.0,
            )
        )
