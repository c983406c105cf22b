"""The physical robot: decisions become wheel speeds, and the physics moves it."""

from __future__ import annotations

import math
from collections.abc import Callable

from fuzzyq_bullet.drives.base import Tick
from fuzzyq_bullet.drives.foresight import Foresight
from fuzzyq_bullet.drives.pilot import STILL, Pilot, Twist, ramp
from fuzzyq_bullet.drives.sensor import CastOnce
from fuzzyq_bullet.physics.engine import TIME_STEP, Contact
from fuzzyq_bullet.physics.world import SENSOR_MARGIN, World
from fuzzyq_bullet.planning.base import Decision, Motion, Observation
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.trajectory import Collision

COMMAND_STEPS = 3
"""Physics steps between two wheel commands: 80 a second, so that the ramp of the acceleration
limit never asks the tyres for a jump they cannot hold."""
TICK_STEPS = 36
"""Physics steps between two ticks: one every 0.15 s."""
TICK_TIME = TICK_STEPS * TIME_STEP
DECISION_TICKS = 2
"""Ticks between two decisions: one every 0.3 s."""

RESTING_SPEED = 0.01
RESTING_TURN_RATE = 0.05


class WheelsDriver:
    """Drives a world's robot by its wheels, watching for contact after every physics step."""

    def __init__(self, world: World, scenario: Scenario) -> None:
        self._world = world
        self._goal = scenario.goal
        self._limits = scenario.robot
        self._motion = Motion(
            max_speed=scenario.robot.max_speed,
            max_turn_rate=scenario.robot.max_turn_rate,
            acceleration=scenario.robot.acceleration,
            turn_acceleration=scenario.robot.turn_acceleration,
            period=DECISION_TICKS * TICK_TIME,
            radius=scenario.robot.radius,
            margin=SENSOR_MARGIN,
        )
        self._pilot = Pilot(scenario.robot, TICK_TIME)
        self._foresight = Foresight(world.field, scenario.robot)
        self._twist = STILL
        self.steps = 0
        self.collision: Collision | None = None
        self.arrived = False
        self.slowness = self._motion.slowness
        self.ticks: list[Tick] = []
        world.robot.place(*scenario.start.position, scenario.start_heading())
        self._record()

    def observe(self) -> Observation:
        """Return the observation at the latest tick."""
        now = self.ticks[-1]
        position = (now.x, now.y)
        sensor = CastOnce(self._world, position, self._foresight.apart(now, TICK_STEPS))
        return Observation(
            time=now.time,
            position=position,
            heading=now.heading,
            speed=now.speed,
            turn_rate=now.turn_rate,
            goal=self._goal.position,
            goal_radius=self._goal.radius,
            range=self._world.model.sensor_range,
            radius=self._limits.radius + SENSOR_MARGIN,
            sense=sensor,
            look=sensor.look,
            motion=self._motion,
            unit=self._limits.radius,
        )

    def advance(self, decision: Decision) -> None:
        """Follow the decision for one decision period."""
        self._aim(lambda heading, travelled: self._pilot.twist(decision, heading, travelled))

    def steer(self, twist: Twist) -> None:
        """Hold a twist for one decision period; in the goal the robot stops by itself.

        The wheels come to it within the robot's acceleration, and never beyond its greatest speed
        and turn rate.
        """
        fastest, quickest = self._limits.max_speed, self._limits.max_turn_rate
        within = Twist(
            max(-fastest, min(twist.speed, fastest)),
            max(-quickest, min(twist.turn_rate, quickest)),
        )
        self._aim(lambda heading, travelled: within)

    def _aim(self, twist_at: Callable[[float, float], Twist]) -> None:
        """Drive for one decision period, or until a contact or the arrival.

        Args:
            twist_at: The twist to aim for, from the heading (rad) and the path driven since the
                decision (m).
        """
        travelled = 0.0
        for _ in range(DECISION_TICKS):
            before = self.ticks[-1]
            wanted = STILL if self._in_goal(before) else twist_at(before.heading, travelled)
            contact = self._drive(wanted)
            self._record()
            now = self.ticks[-1]
            travelled += math.dist((before.x, before.y), (now.x, now.y))
            if contact is not None:
                self.collision = self._collision(contact)
                return
            if self._in_goal(now) and _at_rest(now):
                self.arrived = True
                return

    def _drive(self, wanted: Twist) -> Contact | None:
        """Drive for one tick; return at once on contact."""
        world, limits, now, left = self._world, self._limits, self._twist, TICK_STEPS
        apart = self._foresight.free_steps(self.ticks[-1], TICK_STEPS)
        while left:
            stride = left
            if now != wanted:
                stride = min(COMMAND_STEPS, left)
                self._twist = now = ramp(now, wanted, limits, stride * TIME_STEP)
                world.robot.command(*world.model.wheel_commands(*now))
            taken, contact = world.advance(stride, apart=apart)
            self.steps += taken
            if contact is not None:
                return contact
            left -= stride
            apart -= stride
        return None

    def _collision(self, contact: Contact) -> Collision:
        x, y, _ = contact.point
        wall = contact.body == self._world.walls
        return Collision(
            time=self.steps * TIME_STEP,
            point=(x, y),
            obstacle=-1 if wall else int(self._world.field.distances((x, y)).argmin()),
            normal_force=contact.force,
        )

    def _in_goal(self, tick: Tick) -> bool:
        return math.dist((tick.x, tick.y), self._goal.position) <= self._goal.radius

    def _record(self) -> None:
        robot = self._world.robot
        self.ticks.append(Tick(self.steps * TIME_STEP, *robot.state(), *robot.wheel_speeds()))


def _at_rest(tick: Tick) -> bool:
    return abs(tick.speed) < RESTING_SPEED and abs(tick.turn_rate) < RESTING_TURN_RATE
