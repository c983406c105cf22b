"""What both drives share: where the robot was, and what it observes."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np

from fuzzyq_bullet.drives.disturbances import SURE, Localiser, stream
from fuzzyq_bullet.physics.movers import Floats
from fuzzyq_bullet.physics.robot import RobotState
from fuzzyq_bullet.physics.sensor_world import SensorWorld
from fuzzyq_bullet.planning.base import LONGEST_STRIDE, Motion, Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.settings import GuardedSettings
from fuzzyq_bullet.recording.trajectory import Collision
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.passing import Passing
from fuzzyq_bullet.scenario.robot import Robot
from fuzzyq_bullet.sensors import CorridorSensor
from fuzzyq_bullet.sensors.noise import RayNoise
from fuzzyq_bullet.shapes import thinnest


class Driver(ABC):
    """Moves the robot by one decision at a time and records where it was.

    Args:
        world: The world of the scenario.
        scenario: A realised scenario.
        motion: Limits of the robot's body, or None for a point that has no inertia.

    Attributes:
        ticks: Its state at every tick so far; the first is the start.
        poses: Where the moving obstacles were at every tick, shape (M, 3): x, y (m), turn (rad).
        steps: Steps of the simulation so far.
        collision: The first contact, after which the run is over.
        arrived: Whether the robot is where it should be.
        slowness: How many times as long as usual the robot is to be waited for, at least 1.
    """

    def __init__(self, world: SensorWorld, scenario: Scenario, motion: Motion | None) -> None:
        # The seed's third stream: the first places the obstacles, the second is the planner's.
        seed, told = scenario.seed, scenario.sensor
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(2,)))
        noise = RayNoise(told, stream(seed, "noise"), stream(seed, "dropout"))
        self._sensor = CorridorSensor(
            told,
            world.cast,
            scenario.robot.spec,
            rng,
            thinnest(scenario.obstacles),
            noise if told.is_disturbed else None,
        )
        self._localiser = Localiser(told.pose_noise, told.heading_noise, stream(seed, "pose"))
        self._uncertainty = SURE * told.noise
        self._reading_lasts = 0.0 if told.rate is None else 1.0 / told.rate
        self._read_at, self._read_from = -math.inf, (0.0, 0.0)
        self._field, self._radius = world.field, scenario.robot.radius
        world.movers.start(scenario.seed)
        self._movers = world.movers
        self._closing_speed = self._movers.fastest(scenario.limits.time)
        if isinstance(scenario.planner, GuardedSettings):
            self._closing_speed = scenario.planner.closing_speed_among(self._closing_speed)
        self._goal = scenario.goal
        self._targets = scenario.targets
        self._passing = Passing(scenario.via, scenario.start.position)
        self._motion = motion
        self.ticks: list[RobotState] = []
        self.poses: list[Floats] = []
        self.steps = 0
        self.collision: Collision | None = None
        self.arrived = False
        self.slowness = 1.0 if motion is None else motion.slowness

    def observe(self) -> Observation:
        """Return what the planner may know at the latest tick."""
        now = self.ticks[-1]
        target = self._targets[self.passed]
        error = self._localiser.error(now.time)
        if now.time >= self._read_at + self._reading_lasts - 1e-9:
            self._read_at, self._read_from = now.time, (now.x, now.y)
        still = self._motion is None  # what has no inertia has no speed that matters
        # It jumps: rays from where it was before tell nothing sure of the way from here.
        jumped = still and self._read_from != (now.x, now.y)
        return Observation(
            time=now.time,
            position=(now.x + error.x, now.y + error.y),
            heading=now.heading + error.heading,
            speed=0.0 if still else now.speed,
            turn_rate=0.0 if still else now.turn_rate,
            goal=target.position,
            goal_radius=target.radius,
            range=self._sensor.range,
            radius=self._sensor.radius,
            sensor=self._sensor.at(self._read_from, error.heading),
            motion=self._motion,
            unit=self._radius,
            uncertainty=self._uncertainty + (self._sensor.range if jumped else 0.0),
            closing_speed=self._closing_speed,
        )

    def _note(self, state: RobotState) -> None:
        """Keep the state of the robot, and of all that moves, at a tick."""
        self.ticks.append(state)
        self.poses.append(self._movers.poses())

    @abstractmethod
    def advance(self, decision: Decision) -> None:
        """Carry out one decision until the next one is due, a contact, or the arrival."""

    @property
    def passed(self) -> int:
        """How many via points were passed so far."""
        return self._passing.passed

    def _in_goal(self, state: RobotState) -> bool:
        """Return whether the robot is in the goal, and every via point was passed."""
        if self.passed < len(self._targets) - 1:
            return False
        return math.dist((state.x, state.y), self._goal.position) <= self._goal.radius


def longest_step_time(robot: Robot) -> float:
    """Return how long the longest step of the controller lasts at full speed (s).

    It ties the paper's steps to time: a decision's step is driven at ``step / longest_step_time``,
    so the longest one is driven at ``max_speed``.
    """
    return LONGEST_STRIDE * robot.radius / robot.max_speed
