"""The paper's own point robot: each decision is one jump of Eq. 17, exactly."""

from __future__ import annotations

import math

from fuzzyq_bullet.drives.base import Driver, longest_step_time
from fuzzyq_bullet.geometry import wrap_angle
from fuzzyq_bullet.physics.movers import Mover
from fuzzyq_bullet.physics.robot import RobotState
from fuzzyq_bullet.physics.sensor_world import SensorWorld
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.recording.trajectory import Collision
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.robot import Robot

_PARTS = 10
"""How often within a step it is asked whether a moving obstacle touches the disc."""
STEP_TIME = longest_step_time(Robot())
"""How long every step lasts (s), whatever the robot's limits: a point that jumps has no speed, so
no limit of it may decide how a run ends."""


class KinematicDriver(Driver):
    """Moves by Eq. 17 in the physical world's geometry, sensing with the same rays.

    The robot turns and stops at once. Contact is exact and swept: the disc touches whatever it
    would meet on the straight line of the step, not only at its end. What moves is looked for at
    ten places of the line.
    """

    def __init__(self, world: SensorWorld, scenario: Scenario) -> None:
        super().__init__(world, scenario, motion=None)
        self._world = world
        self._record(*scenario.start.position, scenario.start_heading(), 0.0)

    def advance(self, decision: Decision) -> None:
        """Move by one step (Eq. 17); stop at the first thing the disc would touch."""
        now, step = self.ticks[-1], decision.step
        heading = decision.heading - self._localiser.error(now.time).heading
        [free] = self._field.free_distance((now.x, now.y), heading, self._radius, step).tolist()
        hit = free < step
        moved, mover = self._meet(heading, min(step, free))
        x = now.x + moved * math.cos(heading)
        y = now.y + moved * math.sin(heading)
        self.steps += 1
        self._record(x, y, heading, moved / STEP_TIME)
        hit = hit or mover is not None
        if hit:
            index, touched = (
                mover.touching((x, y), self._movers.time)
                if mover is not None
                else self._touching((x, y))
            )
            self.collision = Collision(
                time=self.ticks[-1].time, point=touched, obstacle=index, normal_force=0.0
            )
        self._passing.move((x, y))
        self.arrived = self._in_goal(self.ticks[-1])
        if self.arrived and not hit and self._goal.heading is not None:
            # The point faces any way at once: one more move, that only turns it.
            self.steps += 1
            self._movers.step((), STEP_TIME)
            self._record(x, y, wrap_angle(self._goal.heading), 0.0)

    def _meet(self, heading: float, step: float) -> tuple[float, Mover | None]:
        """Let the time of a step pass; return how far it leads (m), and what ends it by moving."""
        movers, now = self._movers, self.ticks[-1]
        if not movers.members:
            return step, None
        begin, moved = movers.time, 0.0
        for k in range(1, _PARTS + 1):
            moved = step * k / _PARTS
            x, y = now.x + moved * math.cos(heading), now.y + moved * math.sin(heading)
            movers.step(movers.watch((x, y), self._radius), STEP_TIME / _PARTS)
            met = movers.touching((x, y), self._radius)
            if met is not None:
                # A tick is a whole step: what is left of it stands.
                movers.time = begin + STEP_TIME
                met.halt(STEP_TIME * (_PARTS - k) / _PARTS)
                return moved, met
        return moved, None

    def _touching(self, point: tuple[float, float]) -> tuple[int, tuple[float, float]]:
        nearest, touched = self._field.touching(point)
        return self._world.index_of(nearest), touched

    def _record(self, x: float, y: float, heading: float, speed: float) -> None:
        self._note(
            RobotState(
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
