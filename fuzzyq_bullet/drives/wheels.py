"""The physical robot: decisions become wheel speeds, and the physics moves it."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable

import numpy as np

from fuzzyq_bullet.drives.base import Driver
from fuzzyq_bullet.drives.disturbances import SURE, stream
from fuzzyq_bullet.drives.velocity_controller import (
    STILL,
    Twist,
    VelocityController,
    limit_acceleration,
)
from fuzzyq_bullet.geometry import wrap_angle
from fuzzyq_bullet.physics.engine import TIME_STEP, Contact
from fuzzyq_bullet.physics.robot import RobotState
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.planning.base import Motion
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.recording.trajectory import Collision
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.sensors import SENSOR_MARGIN

COMMAND_STEPS = 3
"""Physics steps between two wheel commands: 80 a second, so that the ramp of the acceleration
limit never asks the tyres for a jump they cannot hold."""
TICK_STEPS = 12
"""Physics steps between two ticks: one every 0.05 s, or one for every decision if these do not last
a whole number of such ticks."""
DECISIONS_A_SECOND = 20.0
"""How often the planner decides, like that of a real robot."""

RESTING_SPEED = 0.01
RESTING_TURN_RATE = 0.05
RESTING_ERROR = 0.01
"""An error of the heading (rad) in the goal that is not turned away any more."""


class WheelsDriver(Driver):
    """Drives a world's robot by its wheels, watching for contact after every physics step.

    Args:
        world: The world of the scenario.
        scenario: A realised scenario.
        rate: Decisions a second.

    Raises:
        ValueError: If a decision does not last a whole number of physics steps, or there are more
            than 80 a second.
    """

    def __init__(self, world: World, scenario: Scenario, rate: float = DECISIONS_A_SECOND) -> None:
        steps = round(1.0 / TIME_STEP / rate) if rate > 0.0 else 0
        if steps < COMMAND_STEPS or abs(steps * TIME_STEP * rate - 1.0) > 1e-9:
            raise ValueError(f"{rate} decisions a second are no whole number of physics steps")
        self._tick_steps = steps if steps % TICK_STEPS else TICK_STEPS
        self._decision_ticks = steps // self._tick_steps
        tick_time = self._tick_steps * TIME_STEP
        limits = scenario.robot
        delay = math.ceil(limits.latency / tick_time - 1e-9)
        motion = Motion(
            max_speed=limits.max_speed,
            max_turn_rate=limits.max_turn_rate,
            acceleration=limits.acceleration,
            turn_acceleration=limits.turn_acceleration,
            period=self._decision_ticks * tick_time,
            radius=limits.radius,
            margin=SENSOR_MARGIN,
            wheel_radius=limits.spec.wheel_radius,
            track=limits.spec.track,
            latency=delay * tick_time,
        )
        super().__init__(world, scenario, motion)
        self._world = world
        self._limits = limits
        self._latency = motion.latency
        self._controller = VelocityController(limits, tick_time + self._latency)
        self._twist = STILL
        self._on_their_way = deque([STILL] * delay)
        self._uncertainty += _motion_uncertainty(scenario, motion.period)
        self._slips = stream(scenario.seed, "slip")
        self._grip = np.ones(2)
        world.robot.place(*scenario.start.position, scenario.start_heading())
        self._record()

    def advance(self, decision: Decision) -> None:
        """Follow the decision for one decision period."""
        self._aim(lambda heading, travelled: self._controller.twist(decision, heading, travelled))

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
        for _ in range(self._decision_ticks):
            before = self.ticks[-1]
            believed = before.heading + self._localiser.error(before.time).heading
            turning, ahead = before.turn_rate * self._latency, abs(before.speed) * self._latency
            wanted = (
                self._in_the_end(before)
                if self._in_goal(before)
                else twist_at(believed + turning, travelled + ahead)
            )
            self._on_their_way.append(wanted)
            contact = self._drive(self._on_their_way.popleft())
            self._record()
            now = self.ticks[-1]
            self._passing.move((now.x, now.y))
            travelled += math.dist((before.x, before.y), (now.x, now.y))
            if contact is not None:
                self.collision = self._collision(contact)
                return
            if self._in_goal(now) and self._is_done(now):
                self.arrived = True
                return

    def _in_the_end(self, state: RobotState) -> Twist:
        """Return the twist to aim for in the goal: to stop, and to turn to its heading."""
        off = self._off_heading(state)
        return STILL if abs(off) < RESTING_ERROR else Twist(0.0, self._controller.turn_rate(off))

    def _is_done(self, state: RobotState) -> bool:
        """Return whether the robot, in the goal, is as it is asked to be."""
        if not self._goal.stop:
            return True
        return _at_rest(state) and abs(self._off_heading(state)) <= self._goal.tolerance

    def _off_heading(self, state: RobotState) -> float:
        """Return the turn (rad) that is left to the goal's heading; 0 if it asks for none."""
        heading = self._goal.heading
        return 0.0 if heading is None else wrap_angle(heading - state.heading)

    def _drive(self, wanted: Twist) -> Contact | None:
        """Drive for one tick; return at once on contact."""
        world, limits, now, left = self._world, self._limits, self._twist, self._tick_steps
        if limits.slip > 0.0:
            self._grip = self._slips.normal(1.0, limits.slip, 2)
            self._command(now)
        while left:
            stride = left
            if now != wanted:
                stride = min(COMMAND_STEPS, left)
                self._twist = now = limit_acceleration(now, wanted, limits, stride * TIME_STEP)
                self._command(now)
            taken, contact = world.advance(stride)
            self.steps += taken
            if contact is not None:
                return contact
            left -= stride
        return None

    def _command(self, twist: Twist) -> None:
        """Let the wheels turn for a twist, each as well as it grips."""
        left, right = self._world.model.wheel_commands(*twist)
        self._world.robot.command(left * self._grip[0], right * self._grip[1])

    def _collision(self, contact: Contact) -> Collision:
        x, y, _ = contact.point
        return Collision(
            time=self.steps * TIME_STEP,
            point=(x, y),
            obstacle=self._world.touched(contact),
            normal_force=contact.force,
        )

    def _record(self) -> None:
        self._note(self._world.robot.state(self.steps * TIME_STEP))


def _motion_uncertainty(scenario: Scenario, period: float) -> float:
    """Return how much farther than it should a disturbed robot may drive (m).

    Readings are as old as the time between two; a lost one is noticed one decision later; slipping
    wheels brake later.
    """
    sensor, robot = scenario.sensor, scenario.robot
    late = 0.0 if sensor.rate is None else 1.0 / sensor.rate
    lost = period if sensor.dropout > 0.0 else 0.0
    braking = robot.max_speed**2 / (2.0 * robot.acceleration)
    return SURE * robot.slip * braking + robot.max_speed * (late + lost)


def _at_rest(state: RobotState) -> bool:
    return abs(state.speed) < RESTING_SPEED and abs(state.turn_rate) < RESTING_TURN_RATE
